//! Elements of contacts with friction at the surfaces, which couples angles of edges with
//! positions.
//!
//! Such a contact has up to 14 unknowns: the positions of four nodes and the angles of two edges.
//! A contact of four nodes has three elements: one for all positions, and for each of the two
//! bodies one that couples the positions of its nodes with both angles. A contact of one rod with a
//! plane or an obstacle moves at most three nodes and has one element.

use crate::linalg::{Element, ElementMatrix, UNUSED};
use crate::mechanics::contact::{
    ContactSystem, Levers, NONE, Row, TurnedBodies, TurnedContact, TurningEdges,
};
use crate::mechanics::rod::STRIDE;

/// Unknowns of a contact in each of its elements.
type Places = [usize; 12];

/// No unknown.
const NO: usize = UNUSED;
/// The elements of a contact of two rods.
const OF_TWO: [Places; 3] = [
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11],
    [0, 1, 2, 3, 4, 5, 12, 13, NO, NO, NO, NO],
    [6, 7, 8, 9, 10, 11, 12, 13, NO, NO, NO, NO],
];
/// That of a contact of one.
const OF_ONE: Places = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, NO];
/// Where the angles begin.
const ANGLES: usize = 12;

/// Indices of the first elements of contacts that turn edges among those of all contacts; empty if
/// friction acts on the centrelines.
#[derive(Default)]
pub(super) struct TurnedElements {
    of_pairs: Vec<Option<usize>>,
    of_nodes: Vec<Option<usize>>,
}

impl TurnedElements {
    /// Adds to `elements` those of the coupled pairs of rods. With friction on planes and
    /// obstacles it also adds those of all edges, of all nodes, and of pieces of rods at rims.
    pub(crate) fn list(
        elements: &mut Vec<Element>,
        contact: &ContactSystem,
        turning: &TurningEdges,
        nodes: Option<usize>,
    ) -> Self {
        let mut add = |levers: &Levers| {
            let first = elements.len();
            elements.extend(elements_of(levers));
            first
        };
        let mut of_nodes = vec![None; nodes.unwrap_or(0)];
        let mut of_edges = Vec::new();
        if nodes.is_some() {
            for (node, levers) in turning.over_planes() {
                of_nodes[node] = Some(add(&levers));
            }
            if !contact.surface().obstacles().is_empty() {
                of_edges.extend(turning.at_obstacles().map(|levers| add(&levers)));
            }
        }
        let coupled = contact.coupled_pairs();
        let candidates = contact.candidates().iter().enumerate();
        let of_pairs = candidates.map(|(candidate, pair)| {
            if contact.is_of_rod(pair.nodes[3]) {
                let is_coupled = coupled.binary_search(&candidate).is_ok();
                return is_coupled.then(|| add(&turning.of_pair(pair)));
            }
            if pair.is_of_node() {
                return of_nodes.get(pair.nodes[0]).copied().flatten();
            }
            if pair.is_of_piece() && nodes.is_some() {
                return Some(add(&turning.of_pair(pair)));
            }
            of_edges.get(pair.edges[0]).copied()
        });
        let of_pairs = of_pairs.collect();
        Self { of_pairs, of_nodes }
    }

    /// The first element of a contact.
    pub(crate) fn of(&self, bodies: TurnedBodies) -> usize {
        let element = match bodies {
            TurnedBodies::Pair(candidate) => self.of_pairs[candidate],
            TurnedBodies::Plane { node, .. } => self.of_nodes[node],
        };
        element.expect("contacts that rub have elements")
    }
}

/// The elements of a contact.
fn elements_of(levers: &Levers) -> Vec<Element> {
    let unknown = |place: usize| match place {
        NO => UNUSED,
        ANGLES.. => {
            let lever = levers.edges[place - ANGLES];
            lever.map_or(UNUSED, |lever| STRIDE * lever.edge + 3)
        }
        _ => match levers.nodes[place / 3] {
            NONE => UNUSED,
            node => STRIDE * node + place % 3,
        },
    };
    let places = places_of(levers).iter();
    places.map(|places| places.map(unknown)).collect()
}

/// Contribution of a contact to the matrices of its elements; each entry of its Jacobian occurs
/// once.
pub(super) fn matrices_of(contact: &TurnedContact) -> Vec<ElementMatrix> {
    let Some(jacobian) = &contact.jacobian else {
        return Vec::new();
    };
    let all = places_of(&contact.levers);
    let entry = |number: usize, row: usize, column: usize| {
        let (row, column) = (all[number][row], all[number][column]);
        let both = |are: fn(&usize) -> bool| are(&row) && are(&column);
        let is_elsewhere = (number > 0 && both(|place| *place < ANGLES))
            || (number > 1 && both(|place| *place >= ANGLES));
        if row == NO || column == NO || is_elsewhere {
            0.0
        } else {
            -jacobian[(row, column)]
        }
    };
    let matrices = (0..all.len()).map(|number| {
        std::array::from_fn(|row| std::array::from_fn(|column| entry(number, row, column)))
    });
    matrices.collect()
}

fn places_of(levers: &Levers) -> &'static [Places] {
    if levers.nodes[3] == NONE {
        std::slice::from_ref(&OF_ONE)
    } else {
        &OF_TWO
    }
}

/// Moments of friction at the surfaces in the last evaluation, by the unknowns on which they act:
/// moments on the angles of edges (N m), and couples of forces on nodes (N).
pub(crate) fn moments(contact: &ContactSystem) -> impl Iterator<Item = (usize, f64)> {
    let turned = contact.turned().iter();
    turned.flat_map(|one| over_unknowns(one, &one.moments))
}

/// Entries of a vector over the unknowns of a contact, with their indices among all unknowns.
pub(crate) fn over_unknowns(
    contact: &TurnedContact,
    entries: &Row,
) -> impl Iterator<Item = (usize, f64)> {
    let nodes = contact
        .nodes()
        .flat_map(|(place, node)| (0..3).map(move |axis| (3 * place + axis, STRIDE * node + axis)));
    let edges = (contact.edges()).map(|(place, edge)| (place, STRIDE * edge + 3));
    (nodes.chain(edges)).map(|(place, unknown)| (unknown, entries[place]))
}

#[cfg(test)]
#[path = "turned_elements_tests.rs"]
mod tests;
