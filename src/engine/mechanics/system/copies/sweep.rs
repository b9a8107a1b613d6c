//! The order in which Jacobians are filled and eliminated, node by node.
//!
//! A column is complete when all vertices and edges that reach it are added. Terms of one entry
//! are added in the order of the rods' lists, vertices before edges, so that every entry is the
//! same sum as if all vertices and then all edges were added.

use crate::mechanics::rod::{RodCopies, STRIDE};

/// Part of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Piece {
    /// Set the columns of a node to zero.
    Begin(usize),
    /// Add a vertex, given by its index.
    Vertex(usize),
    /// Add an edge, given by its index.
    Edge(usize),
    /// Complete and eliminate the columns of a node; the flag is set if an unknown that they reach
    /// is held.
    Node { node: usize, holds: bool },
}

/// Number of unknowns that a column reaches, its own included.
const REACH: usize = crate::linalg::HALF_BANDWIDTH + 1;

/// The order for rods with the given held unknowns.
pub(super) fn plan(rods: &RodCopies, held: &[bool]) -> Vec<Piece> {
    let nodes = held.len() / STRIDE;
    let reached: Vec<_> = (rods.unknowns_of_vertices())
        .map(|unknowns| unknowns.start / STRIDE..unknowns.end.div_ceil(STRIDE))
        .collect();
    let mut at_nodes = vec![Vec::new(); nodes];
    for (vertex, reached) in reached.iter().enumerate() {
        at_nodes[reached.clone()]
            .iter_mut()
            .for_each(|node| node.push(vertex));
    }
    let mut plan = Plan {
        is_added: vec![false; reached.len()],
        reached,
        at_nodes,
        begun: 0,
        pieces: Vec::new(),
    };
    for node in 0..nodes {
        plan.begin(node + 1);
        plan.add_vertices(node, usize::MAX);
        if let Some(edge) = rods.edge_from(node) {
            plan.add_vertices(node + 1, usize::MAX);
            plan.begin(node + 2);
            plan.pieces.push(Piece::Edge(edge));
        }
        let columns = STRIDE * node..held.len().min(STRIDE * (node + 1) - 1 + REACH);
        let holds = held[columns].contains(&true);
        plan.pieces.push(Piece::Node { node, holds });
    }
    plan.pieces
}

struct Plan {
    /// Nodes that each vertex reaches.
    reached: Vec<std::ops::Range<usize>>,
    /// Vertices that reach each node, in their order.
    at_nodes: Vec<Vec<usize>>,
    is_added: Vec<bool>,
    /// Number of nodes whose columns have been started.
    begun: usize,
    pieces: Vec<Piece>,
}

impl Plan {
    /// Starts the columns of the nodes before `end`.
    fn begin(&mut self, end: usize) {
        for node in self.begun..end {
            self.pieces.push(Piece::Begin(node));
        }
        self.begun = self.begun.max(end);
    }

    /// Adds the vertices below `end` that reach a node. Before each one, all earlier vertices that
    /// reach one of its nodes are added.
    fn add_vertices(&mut self, node: usize, end: usize) {
        for place in 0..self.at_nodes[node].len() {
            let vertex = self.at_nodes[node][place];
            if vertex >= end || self.is_added[vertex] {
                continue;
            }
            let reached = self.reached[vertex].clone();
            for node in reached.clone() {
                self.add_vertices(node, vertex);
            }
            self.begin(reached.end);
            self.is_added[vertex] = true;
            self.pieces.push(Piece::Vertex(vertex));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Vector3;
    use crate::mechanics::scene::{RodDescription, Scene};
    use crate::mechanics::system::System;
    use crate::mechanics::test_support::{clamp, line, section};

    /// Two rods; the first has clamps at both ends and inside.
    fn system() -> System {
        let rod = |name: &str, y: f64| {
            let nodes = line(Vector3::y() * y, Vector3::new(1.0, y, 0.0), 6);
            RodDescription::uniform(name, nodes, section(30.0, [0.02; 2], 0.03), 4e-3, 0.02)
        };
        let scene = Scene {
            rods: vec![rod("one", 0.0), rod("other", 1.0)],
            clamps: [0, 3, 6].map(|node| clamp(0, node)).to_vec(),
            ..Scene::default()
        };
        System::new(&scene).unwrap()
    }

    #[test]
    fn columns_are_complete_before_they_are_eliminated_and_sums_keep_their_order() {
        let system = system();
        let rods = RodCopies::new(&system.assembly.rods).unwrap();
        let pieces = plan(&rods, &system.assembly.held);
        let place = |piece: Piece| {
            let mut places = (0..pieces.len()).filter(|place| pieces[*place] == piece);
            let found = places.next().expect("it is done");
            assert!(places.next().is_none(), "it is done once");
            found
        };
        let eliminated = |of: usize| {
            let is_own = |piece: &Piece| matches!(piece, Piece::Node { node, .. } if *node == of);
            pieces.iter().position(is_own).unwrap()
        };
        let reached: Vec<_> = rods.unknowns_of_vertices().collect();
        for (vertex, own) in reached.iter().enumerate() {
            let at = place(Piece::Vertex(vertex));
            for unknown in own.clone() {
                assert!(place(Piece::Begin(unknown / STRIDE)) < at);
                assert!(at < eliminated(unknown / STRIDE));
            }
            for (other, beside) in reached.iter().enumerate().skip(vertex + 1) {
                if own.start < beside.end && beside.start < own.end {
                    assert!(at < place(Piece::Vertex(other)), "{vertex} {other}");
                }
            }
        }
        for (edge, own) in system.assembly.rods.edges.iter().enumerate() {
            let at = place(Piece::Edge(edge));
            assert!(at < eliminated(own.start) && at < eliminated(own.end));
            for (vertex, beside) in reached.iter().enumerate() {
                let is_beside =
                    beside.start < STRIDE * (own.end + 1) && beside.end > STRIDE * own.start;
                assert!(!is_beside || place(Piece::Vertex(vertex)) < at);
            }
        }
        let holds = |of: usize| {
            let is_held =
                |piece: &Piece| matches!(piece, Piece::Node { node, holds: true } if *node == of);
            pieces.iter().any(is_held)
        };
        // The second rod is free, except for the angle after its last edge. A column reaches two
        // or three nodes beyond its own node.
        assert!((0..7).all(holds) && !(7..10).any(holds) && (11..14).all(holds));
    }
}
