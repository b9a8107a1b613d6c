//! Following a path of equilibria.

use super::Session;
use crate::run::advance::Advance;
use crate::run::path::PathAtWork;
use crate::run::stop::{Stop, StopRequests};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::statics::PathPlan;
use std::time::Instant;

impl Session {
    /// Follows the path to its ends, a row per point.
    pub(super) fn follow<S: Advance>(
        &mut self,
        simulation: &mut S,
        plan: PathPlan,
        stop_requested: StopRequests<'_>,
    ) -> Result<(), Stop> {
        let mut path = match self.path.take() {
            Some(path) => path,
            None => PathAtWork::begin(simulation.path(plan)?, &self.directory)?,
        };
        // After a failure the path is dropped here, so that no checkpoint contains it.
        let mut start = Instant::now();
        while let Some(point) = simulation.next_point(&mut path.tracer)? {
            self.last_step = start.elapsed();
            let moved = root_mean_square(&self.placed, &simulation.frame(false).positions);
            path.add(&point, moved, &simulation.energies())?;
            self.progress.update_path(&point, path.parameters.len());
            self.path = Some(path);
            self.run_state.counters.add_point(&point);
            self.record(simulation)?;
            self.ask_to_stop(stop_requested)?;
            self.write_checkpoint_if_due(simulation)?;
            path = self.path.take().expect("kept above");
            if self.has_ended() {
                break;
            }
            start = Instant::now();
        }
        self.remarks.extend(path.remarks());
        self.path = Some(path);
        Ok(())
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
    use crate::run::PreparedRun;
    use crate::run::{Reached, RunError, StopRequest, run_until};
    use crate::test_support::quiet;
    use rodlab_files::results::{BRANCH, NODES, SERIES, SUMMARY};
    use std::fs;
    use std::path::Path;
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    fn column(most_points: usize) -> PreparedRun {
        let text = include_str!("../../../../scenarios/euler_column.toml")
            .replace("edges = 100", "edges = 20")
            .replace("step = 0.05", "step = 0.3")
            + &format!("largest_step = 0.3\nmost_points = {most_points}\n");
        let loaded = experiment::from_text("column.toml", &text, Path::new("."), &[]).unwrap();
        experiment::prepare(&loaded.scenario).unwrap()
    }

    #[test]
    fn a_path_that_is_interrupted_again_and_again_ends_with_the_same_bytes() {
        let (whole, pieces) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let prepared = column(1000);
        run_until(&prepared, &quiet(whole.path()), &|| None).unwrap();
        let mut interruptions = 0;
        let outcome = loop {
            let points = AtomicUsize::new(0);
            let stop = || (points.fetch_add(1, Relaxed) == 6).then_some(StopRequest::Interrupt);
            match run_until(&prepared, &quiet(pieces.path()), &stop) {
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
        assert!(interruptions > 3 && outcome.case.remarks.is_empty());
        for name in [BRANCH, SERIES, NODES, SUMMARY] {
            let read = |directory: &tempfile::TempDir| fs::read(directory.path().join(name)).ok();
            assert!(read(&whole) == read(&pieces), "{name}");
        }
    }

    #[test]
    fn branches_with_too_many_points_are_reported() {
        let directory = tempfile::tempdir().unwrap();
        let outcome = run_until(&column(5), &quiet(directory.path()), &|| None).unwrap();
        assert!(
            outcome.case.remarks[0].contains("most_points"),
            "{:?}",
            outcome.case.remarks
        );
    }

    #[test]
    fn a_path_along_which_nothing_changes_is_reported() {
        let directory = tempfile::tempdir().unwrap();
        let mut prepared = column(1000);
        for load in &mut prepared.scene.loads {
            load.schedule.clear();
        }
        let outcome = run_until(&prepared, &quiet(directory.path()), &|| None).unwrap();
        let remarks = &outcome.case.remarks;
        assert!(remarks[0].contains("nothing moved"), "{remarks:?}");
    }

    #[test]
    fn an_interrupted_search_for_an_equilibrium_starts_again() {
        let directory = tempfile::tempdir().unwrap();
        let text = include_str!("../../../../scenarios/heavy_cantilever.toml");
        let loaded = experiment::from_text("beam.toml", text, Path::new("."), &[]).unwrap();
        let prepared = experiment::prepare(&loaded.scenario).unwrap();
        let asked = AtomicUsize::new(0);
        let stop = || (asked.fetch_add(1, Relaxed) >= 3).then_some(StopRequest::Interrupt);
        let error = run_until(&prepared, &quiet(directory.path()), &stop).unwrap_err();
        assert!(matches!(error, RunError::Interrupted { .. }));
        assert!(
            error.to_string().contains("interrupted at the start"),
            "{error}"
        );
        let outcome = run_until(&prepared, &quiet(directory.path()), &|| None).unwrap();
        assert!(outcome.case.newton_iterations > 5);
    }
}
