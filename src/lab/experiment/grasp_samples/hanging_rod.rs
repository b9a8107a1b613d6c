//! The scene that represents all samples: the hanging rod of the first sample.

use super::keys::GraspSamples;
use crate::experiment::data_set::hanging;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{NaturalShape, RodDescription, Scene, Stiffness};
use rodlab_planning::plan::grasp::{GraspError, GraspProblem, GraspSolver, TWIST_STIFFNESS};

/// Edges of the rod.
const EDGES: usize = 50;
/// Radius of the rod, L_gb: for display only.
const RADIUS: f64 = 0.05;
/// k̄_s of a rod that is stiffer than this engine's rods can be.
const STIFFEST: f64 = 1e6;

/// The rod of the first sample between contact node and gripper, with EI = 1 and weight 1/2 per
/// length, so that L_gb = 1.
///
/// # Errors
/// The first grasp was not found.
pub fn hanging_rod(plan: &GraspSamples) -> Result<Scene, GraspError> {
    let [length, curvature, compliance] = plan.point(0);
    let problem = GraspProblem::new(length, curvature, 1.0 / compliance)?;
    let centreline = GraspSolver::new().centreline(&problem, EDGES)?;
    let stiffness = Stiffness {
        stretching: (1.0 / compliance).min(STIFFEST),
        bending: [1.0; 2],
        twisting: TWIST_STIFFNESS,
    };
    let straight = (0..=EDGES).map(|node| Vector3::x() * (length * node as f64 / EDGES as f64));
    let rod = RodDescription {
        natural_shape: NaturalShape::Centreline(straight.collect()),
        ..RodDescription::uniform("hanging", centreline, stiffness, RADIUS, 0.5)
    };
    Ok(hanging(rod, true))
}
