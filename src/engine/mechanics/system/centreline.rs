//! Geometry of a rod as placed.

use crate::mechanics::Vector3;

/// Arc length along a rod to a node, m.
pub(super) fn arc_length(nodes: &[Vector3], node: usize) -> f64 {
    let edges = nodes[..=node].windows(2);
    edges.map(|ends| (ends[1] - ends[0]).norm()).sum()
}

/// Unit vectors from a node to its neighbours along a rod.
pub(super) fn directions(nodes: &[Vector3], node: usize) -> Vec<Vector3> {
    let neighbours = [node.checked_sub(1), Some(node + 1)];
    let there = neighbours
        .into_iter()
        .flatten()
        .filter_map(|other| nodes.get(other));
    there
        .map(|other| (other - nodes[node]).normalize())
        .collect()
}
