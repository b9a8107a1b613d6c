//! Runs that follow a path of equilibria.

use super::Stop;
use super::advance::Advance;
use super::session::Session;
use super::stop::StopRequest;
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::{Energies, StepReport};
use crate::mechanics::statics::{EndedEarly, PathPlan, PathPoint, PointKind, Tracer};
use crate::results::{BRANCH, BranchKind, BranchRow, CsvStream, ResultsDirectory, ResultsError};
use serde::{Deserialize, Serialize};

/// A path at work.
pub(crate) struct PathAtWork {
    tracer: Tracer,
    branches: CsvStream,
    /// Parameters of the points so far.
    pub parameters: Vec<f64>,
}

/// What a checkpoint holds of it.
#[derive(Serialize, Deserialize)]
pub(crate) struct PathCheckpoint {
    tracer: Tracer,
    parameters: Vec<f64>,
    /// Bytes of `branch.csv`.
    length: u64,
}

impl PathAtWork {
    /// Goes on from a checkpoint.
    pub fn resume(
        checkpoint: PathCheckpoint,
        directory: &ResultsDirectory,
    ) -> Result<Self, ResultsError> {
        Ok(Self {
            tracer: checkpoint.tracer,
            branches: CsvStream::continue_at(&directory.file(BRANCH), checkpoint.length)?,
            parameters: checkpoint.parameters,
        })
    }

    /// Puts `branch.csv` on the disk; what a checkpoint must hold.
    pub fn checkpoint(&mut self) -> Result<PathCheckpoint, ResultsError> {
        Ok(PathCheckpoint {
            tracer: self.tracer.clone(),
            parameters: self.parameters.clone(),
            length: self.branches.sync()?,
        })
    }
}

impl Session {
    /// Follows the path to its ends, a row per point.
    pub(crate) fn follow<S: Advance>(
        &mut self,
        simulation: &mut S,
        plan: PathPlan,
        stop_requested: &dyn Fn() -> Option<StopRequest>,
    ) -> Result<(), Stop> {
        let mut path = match self.path.take() {
            Some(path) => path,
            None => PathAtWork {
                tracer: simulation.path(plan)?,
                branches: CsvStream::create(&self.file(BRANCH))?,
                parameters: Vec::new(),
            },
        };
        // A path that cannot be followed is lost here, so that no checkpoint is made of it.
        while let Some(point) = simulation.next_point(&mut path.tracer)? {
            let moved = root_mean_square(&self.placed, &simulation.frame(false).positions);
            let row = row(&point, moved, &simulation.energies());
            path.branches.write(&row)?;
            path.branches.flush()?;
            path.parameters.push(point.parameter);
            let report = StepReport {
                time: point.parameter,
                newton_iterations: point.iterations,
                ..StepReport::default()
            };
            self.progress.update_path(&point, path.parameters.len());
            self.path = Some(path);
            self.record_point(simulation, &report, point.kind != PointKind::Regular)?;
            self.ask_to_stop(stop_requested)?;
            self.write_checkpoint_if_due(simulation)?;
            path = self.path.take().expect("kept above");
            if self.has_ended() {
                break;
            }
        }
        path.branches.sync()?;
        self.remarks.extend(remarks(path.tracer.ended_early()));
        self.path = Some(path);
        Ok(())
    }
}

/// What is to be told of a path at its end.
fn remarks(ended_early: EndedEarly) -> Vec<String> {
    let EndedEarly { long, lost } = ended_early;
    let mut remarks = Vec::new();
    if long > 0 {
        remarks.push(format!(
            "{long} of the branches ended within the range, at continuation.most_points"
        ));
    }
    if lost > 0 {
        remarks.push(format!("{lost} of the branches that leave the first could not be followed to an end of the range"));
    }
    remarks
}

fn row(point: &PathPoint, displacement_rms_m: f64, energies: &Energies) -> BranchRow {
    let elastic = energies.elastic();
    BranchRow {
        branch: point.branch,
        parameter: point.parameter,
        parameter_error: point.parameter_error,
        displacement_rms_m,
        elastic_energy_j: elastic,
        energy_j: elastic + energies.contact + energies.gravitational,
        negative_pivots: point.negative,
        stable: point.negative == 0,
        lowest_eigenvalue_n_per_m: point.lowest_eigenvalue,
        kind: match point.kind {
            PointKind::Regular => BranchKind::Regular,
            PointKind::Fold => BranchKind::Fold,
            PointKind::Bifurcation => BranchKind::Bifurcation,
        },
        newton_iterations: point.iterations,
    }
}

fn root_mean_square(from: &[Vector3], to: &[Vector3]) -> f64 {
    let sum: f64 = (from.iter().zip(to))
        .map(|(from, to)| (to - from).norm_squared())
        .sum();
    (sum / from.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use crate::experiment;
    use crate::results::{BRANCH, NODES, SERIES, SUMMARY};
    use crate::run::PreparedRun;
    use crate::run::{Reached, RunError, RunOptions, StopRequest, run_until};
    use std::cell::Cell;
    use std::fs;
    use std::path::Path;

    fn column(most_points: usize) -> PreparedRun {
        let text = include_str!("../../scenarios/euler_column.toml")
            .replace("edges = 100", "edges = 20")
            .replace("step = 0.05", "step = 0.3")
            + &format!("largest_step = 0.3\nmost_points = {most_points}\n");
        let loaded = experiment::from_text("column.toml", &text, Path::new("."), &[]).unwrap();
        experiment::prepare(&loaded.scenario).unwrap()
    }

    fn options(directory: &Path) -> RunOptions {
        RunOptions {
            progress: false,
            ..RunOptions::new(directory)
        }
    }

    #[test]
    fn a_path_that_is_interrupted_again_and_again_ends_with_the_same_bytes() {
        let (whole, pieces) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let prepared = column(1000);
        run_until(&prepared, &options(whole.path()), &|| None).unwrap();
        let mut interruptions = 0;
        let outcome = loop {
            let points = Cell::new(0);
            let stop = || (points.replace(points.get() + 1) == 6).then_some(StopRequest::Interrupt);
            match run_until(&prepared, &options(pieces.path()), &stop) {
                Ok(outcome) => break outcome,
                Err(RunError::Interrupted { reached, .. }) => {
                    assert!(
                        matches!(reached, Reached::Parameter(at) if at > 0.0),
                        "{reached}"
                    );
                    interruptions += 1;
                }
                Err(error) => panic!("{error}"),
            }
        };
        assert!(interruptions > 3 && outcome.remarks.is_empty());
        for name in [BRANCH, SERIES, NODES, SUMMARY] {
            let read = |directory: &tempfile::TempDir| fs::read(directory.path().join(name)).ok();
            assert!(read(&whole) == read(&pieces), "{name}");
        }
    }

    #[test]
    fn branches_that_end_for_want_of_points_are_told() {
        let directory = tempfile::tempdir().unwrap();
        let outcome = run_until(&column(5), &options(directory.path()), &|| None).unwrap();
        assert!(
            outcome.remarks[0].contains("most_points"),
            "{:?}",
            outcome.remarks
        );
    }

    #[test]
    fn an_interrupted_search_for_an_equilibrium_starts_again() {
        let directory = tempfile::tempdir().unwrap();
        let text = include_str!("../../scenarios/heavy_cantilever.toml");
        let loaded = experiment::from_text("beam.toml", text, Path::new("."), &[]).unwrap();
        let prepared = experiment::prepare(&loaded.scenario).unwrap();
        let asked = Cell::new(0);
        let stop = || (asked.replace(asked.get() + 1) >= 3).then_some(StopRequest::Interrupt);
        let error = run_until(&prepared, &options(directory.path()), &stop).unwrap_err();
        assert_eq!(error.exit_code(), 130);
        assert!(
            error.to_string().contains("interrupted at the start"),
            "{error}"
        );
        let outcome = run_until(&prepared, &options(directory.path()), &|| None).unwrap();
        assert!(outcome.case.newton_iterations > 5);
    }
}
