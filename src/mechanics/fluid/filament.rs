//! Which nodes form a rod in the fluid.

/// A run of consecutive nodes that forms one rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filament {
    /// Index of the first node among all nodes.
    pub first_node: usize,
    /// Number of nodes, at least 2.
    pub nodes: usize,
    /// Whether the last node is joined to the first.
    pub closed: bool,
    /// Radius of the rod, m.
    pub radius: f64,
}

impl Filament {
    /// Range of its nodes.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first_node..self.first_node + self.nodes
    }

    /// Number of edges.
    pub(super) fn edges(&self) -> usize {
        if self.closed {
            self.nodes
        } else {
            self.nodes - 1
        }
    }
}
