//! Where the rod hangs before it is laid down: the start of a simulation.

use super::{DeployedRod, DeploymentError};
use crate::mechanics::{Vector3, rotation};
use crate::plan::grasp::{GraspProblem, GraspSolver};
use crate::plan::pattern::PatternPoint;

/// Nodes of the whole rod as it hangs from the optimal grasp, its free end on the table at the first point of the
/// pattern, m.
///
/// # Errors
/// There is no grasp.
pub fn hanging_rod(
    first: &PatternPoint,
    rod: &DeployedRod,
    edges: usize,
) -> Result<Vec<Vector3>, DeploymentError> {
    let contact = Vector3::new(first.position.x, first.position.y, rod.radius);
    let unit = rod.gravito_bending_length;
    let stiffness = rod.stretch_stiffness();
    let nodes = GraspProblem::new(rod.length / unit, first.curvature * unit, stiffness)
        .and_then(|problem| GraspSolver::new().centreline(&problem, edges))
        .map_err(|error| DeploymentError::Grasp {
            s_m: first.s,
            error,
        })?;
    let turn = rotation::from_vector(first.angle * Vector3::z());
    let placed = nodes.iter().map(|node| contact + unit * (turn * node));
    Ok(placed.collect())
}

#[cfg(test)]
mod tests {
    use super::super::{Scheme, trajectory};
    use super::*;
    use crate::plan::pattern::{Circle, Pattern};

    #[test]
    fn the_rod_hangs_from_the_first_pose_to_the_first_point() {
        let rod = DeployedRod {
            gravito_bending_length: 0.034,
            radius: 0.002,
            length: 0.89,
        };
        let circle = Pattern::new(Box::new(Circle { radius: -0.2 }), 0.0).unwrap();
        let points = circle.sampled(0.5);
        let nodes = hanging_rod(&points[0], &rod, 200).unwrap();
        let pose = &trajectory(&points[..1], &rod, Scheme::Optimal).unwrap()[0];
        assert!((nodes[200] - pose.position).norm() < 1e-7);
        let start = Vector3::new(0.0, 0.0, rod.radius);
        assert!((nodes[0] - start).norm() < 1e-12);
        let last = (nodes[200] - nodes[199]).normalize();
        assert!((last - pose.rotation * Vector3::x()).norm() < 1e-2);
    }
}
