//! Edges of rods that turn the surfaces at a contact, and the radii of these surfaces.
//!
//! A capsule around an edge turns with its edge. A node on a plane or a face, or in a tube, turns
//! with the mean of the edges that meet there. A ball turns with the edge behind it, or with the
//! edge before it at the end of a rod. At the rim of a tube the two edges of a piece are weighted
//! by the position of the contact along the piece.

use super::contacts::{CandidatePair, RIM_END, RIM_JOINT, RIM_JOINT_END, RIM_START};
use super::surface::ContactSurface;

/// Index of a missing node or edge.
pub(crate) const NONE: usize = usize::MAX;

/// An edge with which a surface turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lever {
    /// The node at which the edge starts, which numbers its angle.
    pub edge: usize,
    /// Nodes of the edge, as indices into the nodes of [`Levers`].
    pub ends: [usize; 2],
    /// Distance of the contact point from the centreline of the edge, m.
    pub arm: f64,
}

/// The unknowns that a contact moves and turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Levers {
    /// The nodes of rods; unused entries are [`NONE`].
    pub nodes: [usize; 4],
    /// For each of the four nodes of the contact, its index among these nodes; `None` if it does
    /// not belong to a rod.
    pub places: [Option<usize>; 4],
    /// The edges.
    pub edges: [Option<Lever>; 2],
}

/// The edges before and behind each node of a rod, identified by their nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgesAtNodes(Vec<[Option<[usize; 2]>; 2]>);

impl EdgesAtNodes {
    /// Collects the edges of the rods of a surface.
    pub(crate) fn of(surface: &ContactSurface) -> Self {
        let mut edges = vec![[None; 2]; surface.node_count()];
        for edge in surface.rod_edges() {
            let [start, end] = edge.nodes;
            if start != end {
                edges[start][1] = Some(edge.nodes);
                edges[end][0] = Some(edge.nodes);
            }
        }
        Self(edges)
    }

    /// Levers of a node with a sphere of a given radius, m.
    pub(crate) fn of_node(&self, node: usize, radius: f64) -> Levers {
        let [before, behind] = self.0[node];
        let share = match (before, behind) {
            (Some(_), Some(_)) => 0.5,
            _ => 1.0,
        };
        let lever = |edge: Option<[usize; 2]>, ends| {
            edge.map(|edge| Lever {
                edge: edge[0],
                ends,
                arm: share * radius,
            })
        };
        Levers {
            nodes: [
                node,
                before.map_or(NONE, |edge| edge[0]),
                behind.map_or(NONE, |edge| edge[1]),
                NONE,
            ],
            places: [Some(0), None, None, None],
            edges: [lever(before, [1, 0]), lever(behind, [0, 2])],
        }
    }

    /// Levers of an edge of a rod, or of a ball: its nodes, and the lever with indices counted
    /// from `first`.
    fn of_edge(&self, surface: &ContactSurface, edge: usize, first: usize) -> ([usize; 2], Lever) {
        let own = &surface.edges()[edge];
        let [start, end] = own.nodes;
        let lever = |edge: usize, ends: [usize; 2]| Lever {
            edge,
            ends: ends.map(|end| first + end),
            arm: own.radius,
        };
        if start != end {
            return (own.nodes, lever(start, [0, 1]));
        }
        match self.0[start] {
            [_, Some([_, next])] => ([start, next], lever(start, [0, 1])),
            [Some([before, _]), None] => ([start, before], lever(before, [1, 0])),
            [None, None] => unreachable!("a node of a rod has an edge"),
        }
    }

    /// Levers of an edge or a ball at an obstacle, without indices of nodes.
    pub(crate) fn at_obstacle(&self, surface: &ContactSurface, edge: usize) -> Levers {
        let ([a, b], lever) = self.of_edge(surface, edge, 0);
        Levers {
            nodes: [a, b, NONE, NONE],
            places: [None; 4],
            edges: [Some(lever), None],
        }
    }

    /// Levers of a pair. At a rim the radius is shared as for a contact in the middle of the
    /// piece.
    pub(crate) fn of_pair(&self, surface: &ContactSurface, pair: &CandidatePair) -> Levers {
        let [first, second] = pair.edges;
        let radius = surface.edges()[first].radius;
        if pair.is_of_piece() {
            let [a, b, c, _] = pair.nodes;
            let lever = |edge, ends| Lever {
                edge,
                ends,
                arm: 0.5 * radius,
            };
            return Levers {
                nodes: [a, b, c, NONE],
                places: [Some(0), Some(1), Some(2), None],
                edges: [Some(lever(a, [0, 1])), Some(lever(b, [1, 2]))],
            };
        }
        if pair.is_of_node() {
            return self.of_node(pair.nodes[0], radius);
        }
        let mut levers = self.at_obstacle(surface, first);
        let [a, b, ..] = levers.nodes;
        if surface.obstacle_of(second).is_none() {
            let ([c, d], lever) = self.of_edge(surface, second, 2);
            levers.nodes = [a, b, c, d];
            levers.edges[1] = Some(lever);
        }
        for (corner, place) in levers.places.iter_mut().enumerate() {
            // A rod may touch itself, but the two edges of a pair share no node.
            *place = (levers.nodes.iter()).position(|node| *node == pair.nodes[corner]);
        }
        levers
    }
}

impl Levers {
    /// Shares the radius at a rim between the two edges of a piece; `along` is the position of the
    /// contact on the piece, from 0 to 1, if it may be anywhere on the piece.
    pub(crate) fn share_at(&mut self, side: i8, along: Option<f64>, radius: f64) {
        let second = match side {
            RIM_END | RIM_JOINT_END => 1.0,
            RIM_START | RIM_JOINT => 0.0,
            _ => along.unwrap_or(0.5),
        };
        for (lever, share) in self.edges.iter_mut().flatten().zip([1.0 - second, second]) {
            lever.arm = share * radius;
        }
    }

    /// The nodes that are there.
    pub(crate) fn all_nodes(&self) -> impl Iterator<Item = (usize, usize)> {
        let nodes = self.nodes.into_iter().enumerate();
        nodes.filter(|(_, node)| *node != NONE)
    }
}
