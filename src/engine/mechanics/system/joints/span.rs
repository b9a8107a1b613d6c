//! Distance between nodes that joints and springs connect.

use crate::mechanics::scene::{RodNode, Scene};
use crate::mechanics::{JointError, Vector3};

/// Largest distance between the nodes of a joint, relative to the shorter of the edges there.
const SAME_POINT: f64 = 1e-6;

/// Distance of two nodes as placed.
pub(super) struct Span {
    /// m.
    pub distance: f64,
    /// The shorter of the edges of their rods, m.
    edge: f64,
}

impl Span {
    pub(crate) fn is_a_point(&self) -> bool {
        self.distance <= SAME_POINT * self.edge
    }
}

/// Distance between the nodes of a joint, if it has two existing nodes.
pub(super) fn span(scene: &Scene, nodes: &[RodNode; 2]) -> Result<Span, JointError> {
    if nodes[0] == nodes[1] {
        return Err(JointError::SameNode);
    }
    let mut places = [Vector3::zeros(); 2];
    let mut edge = f64::INFINITY;
    for (place, at) in places.iter_mut().zip(nodes) {
        let points = scene
            .rods
            .get(at.rod)
            .map_or(&[][..], |rod| &rod.centreline);
        let Some(point) = points.get(at.node) else {
            return Err(JointError::NoSuchNode {
                node: at.node,
                nodes: points.len(),
            });
        };
        *place = *point;
        let lengths = points.windows(2).map(|ends| (ends[1] - ends[0]).norm());
        edge = lengths.fold(edge, f64::min);
    }
    let distance = (places[1] - places[0]).norm();
    Ok(Span { distance, edge })
}
