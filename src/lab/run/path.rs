//! A path of equilibria that is followed, and the output for its points.

use rodlab_engine::mechanics::dynamics::Energies;
use rodlab_engine::mechanics::statics::{EndedEarly, PathPoint, PointKind, Tracer};
use rodlab_files::results::{
    BRANCH, BranchKind, BranchRow, CsvStream, FileMark, ResultsDirectory, ResultsError,
};
use serde::{Deserialize, Serialize};

const STILL: &str = "nothing moved along the path: give a load a `schedule`, or let a clamp move or turn, over the parameter";

/// A path in progress.
pub struct PathAtWork {
    /// Finds the points.
    pub tracer: Tracer,
    branches: CsvStream,
    /// Parameters of the points so far.
    pub parameters: Vec<f64>,
    /// Least and largest displacement at these points, m.
    displacements: [f64; 2],
}

/// Part of a checkpoint that belongs to a path of equilibria.
#[derive(Serialize, Deserialize)]
pub struct PathCheckpoint {
    tracer: Tracer,
    parameters: Vec<f64>,
    displacements: [f64; 2],
    /// Progress of `branch.csv`.
    branches: FileMark,
}

impl PathAtWork {
    /// Begins at the start of a path.
    pub fn begin(tracer: Tracer, directory: &ResultsDirectory) -> Result<Self, ResultsError> {
        Ok(Self {
            tracer,
            branches: CsvStream::create(&directory.file(BRANCH))?,
            parameters: Vec::new(),
            displacements: [f64::INFINITY, f64::NEG_INFINITY],
        })
    }

    /// Resumes from a checkpoint.
    pub fn resume(
        checkpoint: PathCheckpoint,
        directory: &ResultsDirectory,
    ) -> Result<Self, ResultsError> {
        Ok(Self {
            tracer: checkpoint.tracer,
            branches: CsvStream::continue_at(&directory.file(BRANCH), &checkpoint.branches)?,
            parameters: checkpoint.parameters,
            displacements: checkpoint.displacements,
        })
    }

    /// Syncs `branch.csv` to disk and returns the data for a checkpoint.
    pub fn checkpoint(&mut self) -> Result<PathCheckpoint, ResultsError> {
        Ok(PathCheckpoint {
            tracer: self.tracer.clone(),
            parameters: self.parameters.clone(),
            displacements: self.displacements,
            branches: self.branches.sync()?,
        })
    }

    /// Writes the row of a point; its nodes have moved by `displacement_rms`, m.
    pub fn add(
        &mut self,
        point: &PathPoint,
        displacement_rms: f64,
        energies: &Energies,
    ) -> Result<(), ResultsError> {
        self.branches
            .write(&row(point, displacement_rms, energies))?;
        self.branches.flush()?;
        self.parameters.push(point.parameter);
        let [least, largest] = self.displacements;
        self.displacements = [least.min(displacement_rms), largest.max(displacement_rms)];
        Ok(())
    }

    /// Syncs `branch.csv` to disk and records its hash.
    pub fn sync(&mut self) -> Result<FileMark, ResultsError> {
        self.branches.sync()
    }

    /// Remarks at the end of the path.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = remarks(self.tracer.ended_early());
        let [least, largest] = self.displacements;
        if self.parameters.len() > 1 && least == largest {
            remarks.push(STILL.to_owned());
        }
        remarks
    }
}

/// Remarks on a path at its end.
fn remarks(ended_early: EndedEarly) -> Vec<String> {
    let EndedEarly { long, lost } = ended_early;
    let mut remarks = Vec::new();
    if long > 0 {
        remarks.push(format!(
            "{long} of the branches ended within the range, because they reached continuation.most_points"
        ));
    }
    if lost > 0 {
        remarks.push(format!("{lost} of the branches that bifurcate from the first could not be followed to an end of the range"));
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
        lowest_eigenvalue_n_per_m: Some(point.lowest_eigenvalue).filter(|value| value.is_finite()),
        growth_rate_per_s: point.motions.map(|motions| motions.growth_rate),
        frequency_hz: point.motions.map(|motions| motions.frequency),
        kind: match point.kind {
            PointKind::Regular => BranchKind::Regular,
            PointKind::Fold => BranchKind::Fold,
            PointKind::Bifurcation => BranchKind::Bifurcation,
            PointKind::Flutter => BranchKind::Flutter,
        },
        newton_iterations: point.iterations,
    }
}
