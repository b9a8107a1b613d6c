//! Roots: clamped nodes at which a rod leaves a body that it is set in.
//!
//! A stalk clamped in a floor, or a hair in a scalp, overlaps with the body around its root by
//! design, without relative motion there. Contact between that body and the edges and nodes of the
//! rod within the reach of the root is ignored; the rest of the rod can touch the body. With the
//! radius h of the rod and the length s along it over which it overlaps as placed, the reach is
//!
//! R = max(π h, 1.5 s), at most 20 h.

use std::f64::consts::PI;

/// Reach of a root in radii: within this length a rod bent as sharply as its own radius allows
/// turns back to its starting point.
const LEAST_REACH: f64 = PI;
/// Ratio of the reach to the length of the overlap.
const REACH: f64 = 1.5;
/// Largest reach in radii: a rod with a longer overlap is inside the body.
const FARTHEST_REACH: f64 = 20.0;

/// A body that a rod is rooted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RootBody {
    /// Index of a plane.
    Plane(usize),
    /// Index of an obstacle.
    Obstacle(usize),
    /// Index of a rod that is held.
    HeldRod(usize),
}

/// A root of a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Root {
    /// Index of the rod.
    pub rod: usize,
    /// Arc length of the clamped node along it, m.
    pub arc_length: f64,
    /// Length along the rod, on either side of that node, within which the body is ignored, m.
    pub reach: f64,
    /// The body.
    pub body: RootBody,
}

impl Root {
    /// Reach of a root of a rod of radius `radius` (m) that overlaps with the body within `overlap` (m) of the clamped node.
    pub(crate) fn reach_of(radius: f64, overlap: f64) -> f64 {
        (REACH * overlap).clamp(LEAST_REACH * radius, FARTHEST_REACH * radius)
    }
}

/// Pairs ignored at roots: pairs of indices, sorted.
#[derive(Clone, Debug, Default)]
pub(super) struct Roots {
    /// Edges of rods and obstacles.
    pub edges: Vec<[usize; 2]>,
    /// Nodes of rods and obstacles.
    pub nodes: Vec<[usize; 2]>,
    /// Nodes of rods and planes.
    pub planes: Vec<[usize; 2]>,
}

impl Roots {
    /// Whether contact of an edge of a rod with the edges of an obstacle is ignored.
    pub(crate) fn free_edge(&self, edge: usize, obstacle: usize) -> bool {
        self.edges.binary_search(&[edge, obstacle]).is_ok()
    }

    /// Whether contact of a node with the faces or the wall of an obstacle is ignored.
    pub(crate) fn free_node(&self, node: usize, obstacle: usize) -> bool {
        self.nodes.binary_search(&[node, obstacle]).is_ok()
    }

    /// Whether contact of a node with a plane is ignored.
    pub(crate) fn frees_from_plane(&self, node: usize, plane: usize) -> bool {
        self.planes.binary_search(&[node, plane]).is_ok()
    }
}
