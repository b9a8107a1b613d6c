//! The hanging rod before it is laid: the start of a simulation.

use super::{DeployedRod, DeploymentError, Scheme};
use crate::plan::grasp::{GraspProblem, GraspSolver};
use crate::plan::pattern::PatternPoint;
use rodlab_engine::mechanics::{Vector3, rotation};

/// Nodes of the whole rod in equilibrium, m. The rod hangs from the first pose of the gripper, with
/// its free end on the table at the first point of the pattern. In the optimal scheme this is the
/// shape of the optimal grasp; in the intuitive scheme the rod hangs straight down, slightly
/// stretched by its own weight.
///
/// # Errors
/// No grasp was found.
pub fn hanging_rod(
    first: &PatternPoint,
    rod: &DeployedRod,
    scheme: Scheme,
    edges: usize,
) -> Result<Vec<Vector3>, DeploymentError> {
    let contact = Vector3::new(first.position.x, first.position.y, rod.radius);
    match scheme {
        Scheme::Optimal => grasped(first, rod, edges).map(|nodes| {
            let unit = rod.gravito_bending_length;
            let turn = rotation::from_vector(first.angle * Vector3::z());
            let placed = nodes.iter().map(|node| contact + unit * (turn * node));
            placed.collect()
        }),
        Scheme::Intuitive => Ok(upright(rod, edges)
            .map(|height| contact + height * Vector3::z())
            .collect()),
    }
}

/// The rod of the optimal grasp, dimensionless, in the frame of its contact node.
fn grasped(
    first: &PatternPoint,
    rod: &DeployedRod,
    edges: usize,
) -> Result<Vec<Vector3>, DeploymentError> {
    let unit = rod.gravito_bending_length;
    GraspProblem::new(
        rod.length / unit,
        first.curvature * unit,
        rod.stretch_stiffness(),
    )
    .and_then(|problem| GraspSolver::new().centreline(&problem, edges))
    .map_err(|error| DeploymentError::Grasp {
        s_m: first.s,
        error,
    })
}

/// Heights of the nodes of a freely hanging rod above its lowest node, m. The part at s carries
/// the weight below it, which stretches it to s (1 + s/(4 k̄_s L_gb)).
fn upright(rod: &DeployedRod, edges: usize) -> impl Iterator<Item = f64> {
    let stretch = 0.25 / (rod.stretch_stiffness() * rod.gravito_bending_length);
    let length = rod.length;
    (0..=edges)
        .map(move |node| length * node as f64 / edges as f64)
        .map(move |s| s * (1.0 + stretch * s))
}

#[cfg(test)]
mod tests {
    use super::super::{OptimalGrasps, trajectory};
    use super::*;
    use crate::plan::pattern::{Circle, Line, Pattern};

    #[test]
    fn the_rod_hangs_from_the_first_pose_to_the_first_point() {
        let rod = DeployedRod {
            gravito_bending_length: 0.034,
            radius: 0.002,
            length: 0.89,
        };
        let circle = Pattern::new(Box::new(Circle { radius: -0.2 }), 0.0).unwrap();
        let points = circle.sampled(0.5);
        let nodes = hanging_rod(&points[0], &rod, Scheme::Optimal, 200).unwrap();
        let pose =
            &trajectory(&points[..1], &rod, Scheme::Optimal, OptimalGrasps::Exact).unwrap()[0];
        assert!((nodes[200] - pose.position).norm() < 1e-7);
        let start = Vector3::new(0.0, 0.0, rod.radius);
        assert!((nodes[0] - start).norm() < 1e-12);
        let last = (nodes[200] - nodes[199]).normalize();
        assert!((last - pose.rotation * Vector3::x()).norm() < 1e-2);
    }
    #[test]
    fn the_rod_of_the_intuitive_scheme_hangs_straight_down() {
        let rod = DeployedRod {
            gravito_bending_length: 0.018,
            radius: 0.0016,
            length: 0.875,
        };
        let line = Pattern::new(Box::new(Line { length: 0.5 }), 0.0).unwrap();
        let points = line.sampled(0.5);
        let nodes = hanging_rod(&points[0], &rod, Scheme::Intuitive, 100).unwrap();
        let pose =
            &trajectory(&points[..1], &rod, Scheme::Intuitive, OptimalGrasps::Exact).unwrap()[0];
        assert!((nodes[100] - pose.position).norm() < 1e-12);
        assert!((nodes[0] - Vector3::new(0.0, 0.0, rod.radius)).norm() < 1e-15);
        // The strain between nodes k and k + 1 is due to the weight below their middle, ρ g s/E =
        // s/(2 k̄_s L_gb).
        for k in [0, 50, 99] {
            let edge = rod.length / 100.0;
            let strain = (nodes[k + 1].z - nodes[k].z) / edge - 1.0;
            let below = edge * (k as f64 + 0.5);
            let expected = below / (2.0 * rod.stretch_stiffness() * rod.gravito_bending_length);
            assert!(
                (strain - expected).abs() < 1e-10,
                "{k}: {strain} {expected}"
            );
        }
    }
}
