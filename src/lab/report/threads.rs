//! Springs between nodes and tendons, for pictures: thin straight threads.
//!
//! Results do not record when a spring broke, so springs that may break are not drawn. Springs
//! that only apply torques are not drawn either. An eyelet beside a rod turns with it
//! ([`super::rod_frame`]).

use super::rod_frame::RodFrame;
use super::rod_places::{node_at, nodes_of};
use crate::experiment::{Eyelets, Tendon};
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

/// A straight thread.
#[derive(Clone, Debug)]
pub struct Thread {
    ends: [End; 2],
    /// Radius of the thread, m.
    radius: f64,
}

/// An end of a thread.
#[derive(Clone, Copy, Debug)]
enum End {
    /// A point that does not move, m.
    Fixed(Vector3),
    /// A node, among all.
    Node(usize),
    /// A point in a frame of a rod, with its components along the directors, m.
    Beside(RodFrame, [f64; 2]),
}

/// The drawn springs and tendons of a scenario. `start`: the initial positions of its nodes.
pub fn threads(scenario: Option<&Scenario>, rods: &[RodRecord], start: &[Vector3]) -> Vec<Thread> {
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
        Some(Thread {
            ends: [End::Node(node(0)?), End::Node(node(1)?)],
            radius: THINNESS * radius,
        })
    });
    let tendons = scenario.parts.all::<Tendon>().iter();
    let of_tendons = tendons.filter_map(|tendon| threads_of(tendon, scenario, rods, start));
    drawn.chain(of_tendons.flatten()).collect()
}

/// The straight parts of a tendon.
fn threads_of(
    tendon: &Tendon,
    scenario: &Scenario,
    rods: &[RodRecord],
    start: &[Vector3],
) -> Option<Vec<Thread>> {
    let mut ends = Vec::new();
    let mut radius = f64::INFINITY;
    for eyelets in &tendon.through {
        let row = match eyelets {
            Eyelets::Fixed { position } => {
                ends.push(End::Fixed(Vector3::from(*position)));
                continue;
            }
            Eyelets::OnRod(row) => row,
        };
        let nodes = nodes_of(rods, &row.rod)?;
        let first = node_at(&nodes, row.at);
        let last = row.to.map_or(first, |to| node_at(&nodes, to));
        let described = scenario.rods.iter().find(|rod| rod.name == row.rod)?;
        let director = described.director.map(Vector3::from);
        for (node, offset) in row.between(first, last) {
            ends.push(match offset == [0.0; 2] {
                true => End::Node(node),
                false => End::Beside(RodFrame::new(node, &nodes, director, start)?, offset),
            });
        }
        radius = radius.min(THINNESS * described.radius);
    }
    let thread = |ends: &[End]| Thread {
        ends: [ends[0], ends[1]],
        radius,
    };
    (radius.is_finite()).then(|| ends.windows(2).map(thread).collect())
}

impl End {
    /// The place of the end with the nodes at these positions.
    fn at(&self, positions: &[Vector3]) -> Vector3 {
        match *self {
            Self::Fixed(place) => place,
            Self::Node(node) => positions[node],
            Self::Beside(frame, [a, b]) => frame.pose(positions).of(&Vector3::new(a, b, 0.0)),
        }
    }
}

impl Thread {
    /// The axes of the thread and its first end, with the nodes at these positions. The third axis
    /// has the length of the thread.
    fn placed(&self, positions: &[Vector3]) -> [Vector3; 4] {
        let [from, to] = self.ends.map(|end| end.at(positions));
        let along = to - from;
        let tangent = along.try_normalize(0.0).unwrap_or_else(Vector3::z);
        let across = any_normal(&tangent);
        [across, tangent.cross(&across), along, from]
    }

    /// The thread as figures show it, with the nodes at these positions.
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
            convex: false,
        }
    }

    /// The thread for the 3-D page, with the nodes at the positions of each output.
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

    /// Surface of the thread from the origin to a unit of length along z.
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
        let thread = Thread {
            ends: [End::Node(2), End::Node(0)],
            radius: 0.1,
        };
        let positions = [
            Vector3::new(1.0, 2.0, 3.0),
            Vector3::zeros(),
            Vector3::new(-1.0, 0.5, 3.0),
        ];
        let body = thread.at(&positions);
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
        let shown = thread.in_motion(outputs.into_iter());
        let matrix = nalgebra::Matrix4::from_column_slice(&shown.poses[0]);
        for (one, other) in shown.triangles.iter().zip(&body.triangles) {
            for (one, other) in one.iter().zip(other) {
                let carried = matrix.transform_point(&(*one).into());
                assert!((carried.coords - other).norm() < 1e-12);
            }
        }
    }
}
