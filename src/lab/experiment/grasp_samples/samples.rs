//! All samples of an experiment, each solved independently.

use super::figure::figure;
use super::keys::GraspSamples;
use super::row::{Outcome, Sample};
use crate::experiment::data_set::{SAMPLES, SAMPLES_FIGURE};
use crate::run::TableJob;
use rodlab_engine::mechanics::rotation;
use rodlab_files::figure::Paper;
use rodlab_files::results::{ResultsError, write_whole};
use rodlab_planning::plan::grasp::{
    Grasp, GraspMethod, GraspProblem, GraspSolver, hanging_height, log_length,
};
use std::path::Path;

/// Least |κ̄| by which quantities are divided.
const LEAST_CURVATURE: f64 = 1e-4;

/// Grasps at the points of an experiment.
#[derive(Debug)]
pub struct Samples {
    /// The points.
    pub plan: GraspSamples,
}

impl Samples {
    /// No other sample is used, so that rows do not depend on the order in which they are
    /// computed.
    fn sample(&self, index: usize) -> Sample {
        let [suspended_length, curvature, stretch_compliance] = self.plan.point(index);
        let grasp_of = |curvature: f64| -> Option<Grasp> {
            let stiffness = 1.0 / stretch_compliance;
            let problem = GraspProblem::new(suspended_length, curvature, stiffness).ok()?;
            let grasp = GraspSolver::new().solve(&problem, GraspMethod::Theory);
            grasp.ok()
        };
        let found = grasp_of(curvature);
        // Quantities that are odd in κ̄ are divided by it: the ratio is nearly constant for small
        // κ̄.
        let bent = curvature.abs().max(LEAST_CURVATURE).copysign(curvature);
        let bent_grasp = if bent == curvature {
            found.clone()
        } else {
            grasp_of(bent)
        };
        let per_curvature =
            |value: fn(&Grasp) -> f64| bent_grasp.as_ref().map(|grasp| value(grasp) / bent);
        let position = found.as_ref().map(|grasp| grasp.position);
        let vector = found
            .as_ref()
            .map(|grasp| rotation::to_vector(&grasp.rotation));
        let force = found.as_ref().map(|grasp| grasp.contact_force);
        Sample {
            suspended_length,
            curvature,
            stretch_compliance,
            log_length: log_length(suspended_length),
            outcome: match found {
                Some(_) => Outcome::Found,
                None => Outcome::NoConvergence,
            },
            x: position.map(|place| place.x),
            y: position.map(|place| place.y),
            z: position.map(|place| place.z),
            drop: position
                .map(|place| hanging_height(suspended_length, stretch_compliance) - place.z),
            y_per_curvature: per_curvature(|grasp| grasp.position.y),
            rotation_x: vector.map(|vector| vector.x),
            rotation_y: vector.map(|vector| vector.y),
            rotation_z: vector.map(|vector| vector.z),
            rotation_x_per_curvature: per_curvature(|grasp| rotation::to_vector(&grasp.rotation).x),
            rotation_z_per_curvature: per_curvature(|grasp| rotation::to_vector(&grasp.rotation).z),
            force_y: force.map(|force| force.y),
            force_z: force.map(|force| force.z),
            stable: found.as_ref().map(|grasp| grasp.is_stable()),
            residual: found.as_ref().map(|grasp| grasp.residual),
        }
    }
}

impl TableJob for Samples {
    type Row = Sample;

    const TABLE: &'static str = SAMPLES;
    const ROWS: &'static str = "samples";

    fn count(&self) -> usize {
        self.plan.count()
    }

    fn row(&self, index: usize, goes_on: &(dyn Fn() -> bool + Sync)) -> Option<Sample> {
        goes_on().then(|| self.sample(index))
    }

    fn conclude(&self, rows: &[Sample], directory: &Path) -> Result<Vec<String>, ResultsError> {
        let svg = figure(rows).svg(&Paper::default());
        write_whole(&directory.join(SAMPLES_FIGURE), svg.as_bytes())?;
        let missing = rows
            .iter()
            .filter(|row| row.outcome == Outcome::NoConvergence)
            .count();
        let unstable = rows.iter().filter(|row| row.stable == Some(false)).count();
        Ok(vec![format!(
            "{} grasps, {unstable} of them unstable; {missing} points without one",
            rows.len() - missing
        )])
    }
}
