//! Numbering of the nodes and edges of all rods.
//!
//! Nodes of all rods are numbered consecutively, rod after rod. Edge `k` starts at node `k`; no
//! edge starts at the last node of an open rod. Unknowns have stride four: the position of node
//! `k` is at 4k..4k+2 and the angle of edge `k` at 4k+3. So a rod of N edges has the 4N + 3
//! unknowns x₀, θ⁰, x₁, θ¹, …, x_N (thesis Eq. 1.1) and one that is held at zero; a vertex couples
//! eleven consecutive unknowns. Free rigid bodies follow the rods: their nodes are the centre of
//! mass and the vertices of the shape, and they have no edges.

use crate::mechanics::Vector3;

/// Unknowns per node.
pub const STRIDE: usize = 4;

/// Range of one rod in the numbering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RodRange {
    /// First node of the rod.
    pub first_node: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Whether the last node is joined to the first.
    pub closed: bool,
    /// Whether it is a rigid body, whose nodes are not joined by edges.
    pub rigid: bool,
}

impl RodRange {
    /// Number of edges.
    pub(crate) fn edges(&self) -> usize {
        match (self.rigid, self.closed) {
            (true, _) => 0,
            (false, true) => self.nodes,
            (false, false) => self.nodes - 1,
        }
    }

    /// Indices of the edges, which are those of their first nodes.
    pub fn edge_indices(&self) -> std::ops::Range<usize> {
        self.first_node..self.first_node + self.edges()
    }

    /// Indices of the nodes.
    pub fn node_indices(&self) -> std::ops::Range<usize> {
        self.first_node..self.first_node + self.nodes
    }

    /// The edges at a node, by their first and last nodes: one at an end, else two.
    pub(crate) fn edges_at(&self, node: usize) -> Vec<[usize; 2]> {
        let edges = self.edge_indices().map(|edge| [edge, self.end_of(edge)]);
        edges.filter(|ends| ends.contains(&node)).collect()
    }

    /// Node at the end of `edge`.
    pub fn end_of(&self, edge: usize) -> usize {
        if edge + 1 == self.first_node + self.nodes {
            self.first_node
        } else {
            edge + 1
        }
    }
}

/// Position of node `k` in the vector of unknowns.
#[inline(always)]
pub fn position(unknowns: &[f64], node: usize) -> Vector3 {
    Vector3::new(
        unknowns[STRIDE * node],
        unknowns[STRIDE * node + 1],
        unknowns[STRIDE * node + 2],
    )
}

/// Motion of node `k`; zero for vertices of obstacles, which are numbered after the nodes.
pub(crate) fn motion_of(motion: &[f64], node: usize) -> Vector3 {
    if STRIDE * node < motion.len() {
        position(motion, node)
    } else {
        Vector3::zeros()
    }
}

/// Adds `value` to the three entries of node `k`.
#[inline(always)]
pub(crate) fn add_to_node(entries: &mut [f64], node: usize, value: &Vector3) {
    for axis in 0..3 {
        entries[STRIDE * node + axis] += value[axis];
    }
}
