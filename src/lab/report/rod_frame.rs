//! Frames that ride on rods, for pictures.
//!
//! Results hold positions of nodes but not the rotation about the rod. A frame turns from its
//! initial pose by the smallest rotation that follows the rod.

use rodlab_engine::mechanics::rod::transport::{any_normal, normal_part, parallel_transport};
use rodlab_engine::mechanics::rotation::Pose;
use rodlab_engine::mechanics::{Matrix3, UnitQuaternion, Vector3};
use std::ops::RangeInclusive;

/// A frame at a node of a rod: its axes are the two material directors and the tangent.
#[derive(Clone, Copy, Debug)]
pub struct RodFrame {
    node: usize,
    /// The nodes before and after it along the rod, where they exist, among all nodes.
    between: [usize; 2],
    /// Initial tangent and first director.
    placed: [Vector3; 2],
}

impl RodFrame {
    /// The frame at one of the `nodes` of a rod, which starts with a first director at initial
    /// positions. `None` where nodes coincide.
    pub fn new(
        node: usize,
        nodes: &RangeInclusive<usize>,
        director: Option<Vector3>,
        start: &[Vector3],
    ) -> Option<Self> {
        let between = |node: usize| {
            [
                node.saturating_sub(1).max(*nodes.start()),
                (node + 1).min(*nodes.end()),
            ]
        };
        let tangent =
            |[from, to]: [usize; 2]| (start.get(to)? - start.get(from)?).try_normalize(0.0);
        let mut along = tangent(between(*nodes.start()))?;
        let director = director.and_then(|director| normal_part(&director, &along));
        let mut director = director.unwrap_or_else(|| any_normal(&along));
        for node in *nodes.start()..=node {
            let next = tangent(between(node))?;
            director = parallel_transport(&director, &along, &next);
            along = next;
        }
        Some(Self {
            node,
            between: between(node),
            placed: [along, director],
        })
    }

    /// Pose of the frame with the nodes at these positions.
    pub fn pose(&self, positions: &[Vector3]) -> Pose {
        let along = positions[self.between[1]] - positions[self.between[0]];
        let [from, director] = self.placed;
        let tangent = along.try_normalize(0.0).unwrap_or(from);
        let first = parallel_transport(&director, &from, &tangent);
        let axes = Matrix3::from_columns(&[first, tangent.cross(&first), tangent]);
        Pose {
            rotation: UnitQuaternion::from_matrix(&axes),
            translation: positions[self.node],
        }
    }
}
