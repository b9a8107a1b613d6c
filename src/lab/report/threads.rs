//! Springs between nodes, for pictures: thin straight threads.
//!
//! Results do not record when a spring broke, so springs that may break are not drawn. Springs
//! that only apply torques are not drawn either.

use super::rod_places::{node_at, nodes_of};
use crate::scenario::{JointKind, Scenario};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::rod::transport::any_normal;
use rodlab_files::figure::{Body, MovieObstacle};
use rodlab_files::results::RodRecord;
use std::f64::consts::TAU;

/// Sides of a thread.
const AROUND: usize = 6;
/// Radius of the thread, over the radius of the thinner rod that it ties.
const THINNESS: f64 = 0.4;

/// A spring between two nodes.
#[derive(Clone, Debug)]
pub struct DrawnSpring {
    /// Nodes of the spring, among all.
    nodes: [usize; 2],
    /// Radius of the spring, m.
    radius: f64,
}

/// The drawn springs of a scenario.
pub fn drawn_springs(scenario: Option<&Scenario>, rods: &[RodRecord]) -> Vec<DrawnSpring> {
    let Some(scenario) = scenario else {
        return Vec::new();
    };
    let pulls = |kind: &JointKind| matches!(kind, JointKind::Spring { stiffness, .. } if stiffness.is_some());
    let joints = scenario.joints.iter();
    let springs = joints.filter(|joint| pulls(&joint.kind) && !joint.may_break());
    let drawn = springs.filter_map(|joint| {
        let node = |end: usize| Some(node_at(&nodes_of(rods, &joint.rods[end])?, joint.at[end]));
        let tied = (scenario.rods.iter()).filter(|rod| joint.rods.contains(&rod.name));
        let radius = tied.map(|rod| rod.radius).reduce(f64::min)?;
        Some(DrawnSpring {
            nodes: [node(0)?, node(1)?],
            radius: THINNESS * radius,
        })
    });
    drawn.collect()
}

impl DrawnSpring {
    /// The axes of the thread and its first end, with the nodes at these positions. The third axis
    /// has the length of the thread.
    fn placed(&self, positions: &[Vector3]) -> [Vector3; 4] {
        let [from, to] = self.nodes.map(|node| positions[node]);
        let along = to - from;
        let tangent = along.try_normalize(0.0).unwrap_or_else(Vector3::z);
        let across = any_normal(&tangent);
        [across, tangent.cross(&across), along, from]
    }

    /// The spring as figures show it, with the nodes at these positions.
    pub fn at(&self, positions: &[Vector3]) -> Body {
        let [first, second, along, from] = self.placed(positions);
        let placed =
            |corner: Vector3| from + first * corner.x + second * corner.y + along * corner.z;
        let triangles = self.triangles();
        Body {
            triangles: (triangles.into_iter())
                .map(|corners| corners.map(placed))
                .collect(),
            hollow: false,
        }
    }

    /// The spring for the 3-D page, with the nodes at the positions of each output.
    pub fn in_motion<'a>(&self, outputs: impl Iterator<Item = &'a [Vector3]>) -> MovieObstacle {
        let matrix = |positions: &[Vector3]| {
            let mut matrix = [0.0; 16];
            for (column, axis) in self.placed(positions).iter().enumerate() {
                matrix[4 * column..4 * column + 3].copy_from_slice(axis.as_slice());
            }
            matrix[15] = 1.0;
            matrix
        };
        MovieObstacle {
            triangles: self.triangles(),
            poses: outputs.map(matrix).collect(),
            hollow: false,
            is_carried: true,
        }
    }

    /// Surface of the spring from the origin to a unit of length along z.
    fn triangles(&self) -> Vec<[Vector3; 3]> {
        let corner = |k: usize, z: f64| {
            let (sine, cosine) = libm::sincos(TAU * (k % AROUND) as f64 / AROUND as f64);
            Vector3::new(self.radius * cosine, self.radius * sine, z)
        };
        let side = |k: usize| {
            let [a, b] = [k, k + 1].map(|k| corner(k, 0.0));
            let [c, d] = [k, k + 1].map(|k| corner(k, 1.0));
            [[a, b, d], [a, d, c]]
        };
        (0..AROUND).flat_map(side).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_runs_from_node_to_node() {
        let spring = DrawnSpring {
            nodes: [2, 0],
            radius: 0.1,
        };
        let positions = [
            Vector3::new(1.0, 2.0, 3.0),
            Vector3::zeros(),
            Vector3::new(-1.0, 0.5, 3.0),
        ];
        let body = spring.at(&positions);
        let axis = positions[0] - positions[2];
        for corner in body.triangles.iter().flatten() {
            let seen = corner - positions[2];
            let along = seen.dot(&axis) / axis.norm_squared();
            assert!(
                along.abs() < 1e-12 || (along - 1.0).abs() < 1e-12,
                "{along}"
            );
            assert!(((seen - axis * along).norm() - 0.1).abs() < 1e-12);
        }
        // The page shows the same.
        let outputs = [&positions[..]];
        let shown = spring.in_motion(outputs.into_iter());
        let matrix = nalgebra::Matrix4::from_column_slice(&shown.poses[0]);
        for (one, other) in shown.triangles.iter().zip(&body.triangles) {
            for (one, other) in one.iter().zip(other) {
                let carried = matrix.transform_point(&(*one).into());
                assert!((carried.coords - other).norm() < 1e-12);
            }
        }
    }
}
