//! Nodes of rods in the fluid, and their connections.

use std::ops::Range;

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
    pub(super) fn range(&self) -> Range<usize> {
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

/// Connections of the nodes of filaments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Connections {
    /// Pairs of nodes that share one position, at least until a joint breaks.
    pub joined: Vec<[usize; 2]>,
    /// Nodes that slide along filaments.
    pub sliding: Vec<Sliding>,
}

/// A node that slides along a filament.
#[derive(Clone, Debug, PartialEq)]
pub struct Sliding {
    /// The node.
    pub node: usize,
    /// Nodes of one filament along which it slides.
    pub rail: Range<usize>,
    /// Whether the last of them is joined to the first.
    pub closed: bool,
}

/// Index of a node in the sequence of the nodes of all filaments; `None` if it belongs to none.
pub(super) fn station_of(filaments: &[Filament], node: usize) -> Option<usize> {
    let mut first = 0;
    for filament in filaments {
        if filament.range().contains(&node) {
            return Some(first + node - filament.first_node);
        }
        first += filament.nodes;
    }
    None
}
