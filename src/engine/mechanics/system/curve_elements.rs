//! Elements of the Newton system for contact of smooth curves, whose contact points depend on
//! five nodes each.
//!
//! The derivative WᵀJW of the forces of a contact joins ten nodes. Nodes are grouped in
//! pairs, and every two groups that a contact joins share one element, to which all contacts add.
//! The places of the blocks of two nodes are found once for each pair of windows: successive
//! nodes on which the points of the two edges depend.

use super::node_element::element_of;
use crate::linalg::{Element, ElementMatrix};
use crate::mechanics::contact::{ContactSystem, CurvePoints, WINDOW, Window};
use std::collections::{BTreeMap, BTreeSet};

/// Nodes of a group.
const GROUP: usize = 2;
/// Entries of an element.
const ENTRIES: usize = 144;

type Block = [[f64; 3]; 3];

/// Places of the first entries of blocks. A block belongs to two nodes, given by their positions in
/// two windows.
#[derive(Clone)]
struct Places([[u32; WINDOW]; WINDOW]);

/// The elements, each of two groups of nodes, sorted.
#[derive(Default)]
pub(super) struct CurveElements {
    groups: Vec<[usize; 2]>,
    /// Places for pairs of windows, by their first nodes.
    places: BTreeMap<[usize; 2], Places>,
    /// The sums of the matrices of all contacts.
    matrices: Vec<f64>,
}

impl CurveElements {
    /// Elements of the coupled candidates; with planes or obstacles, also of all edges.
    pub(crate) fn of(contact: &ContactSystem) -> Self {
        let Some(curves) = contact.curves() else {
            return Self::default();
        };
        let mut pairs = BTreeSet::new();
        let mut add = |windows: &[&Window]| {
            for first in windows {
                pairs.extend(windows.iter().map(|second| [first.nodes, second.nodes]));
            }
        };
        let candidates = contact.candidates();
        let surface = contact.surface();
        let coupled = contact.coupled_pairs().iter();
        for pair in coupled.map(|candidate| &candidates[*candidate]) {
            if contact.is_of_rod(pair.nodes[3]) {
                add(&pair.edges.map(|chord| curves.window(chord)));
            }
        }
        if !contact.planes().is_empty() || !surface.obstacles().is_empty() {
            for edge in 0..surface.rod_edges().len() {
                add(&[curves.window(edge)]);
            }
        }
        let joined = pairs.iter().flat_map(|[first, second]| {
            let nodes = first.iter().flat_map(|a| second.iter().map(|b| [*a, *b]));
            nodes.map(groups_of)
        });
        let groups: BTreeSet<[usize; 2]> = joined.collect();
        let groups: Vec<[usize; 2]> = groups.into_iter().collect();
        let place = |a: usize, b: usize| {
            let element = groups.binary_search(&groups_of([a, b]));
            let element = element.expect("all pairs of nodes are listed");
            let row = 3 * (a % GROUP + if a / GROUP > b / GROUP { GROUP } else { 0 });
            let column = 3 * (b % GROUP + if b / GROUP > a / GROUP { GROUP } else { 0 });
            (ENTRIES * element + 12 * row + column) as u32
        };
        let places = pairs.iter().map(|pair| {
            let [first, second] = pair;
            let places = first.map(|a| second.map(|b| place(a, b)));
            ([first[0], second[0]], Places(places))
        });
        Self {
            places: places.collect(),
            matrices: vec![0.0; ENTRIES * groups.len()],
            groups,
        }
    }

    /// The unknowns of all elements, in a scene with a number of nodes.
    pub(crate) fn elements(&self, nodes: usize) -> Vec<Element> {
        let members = |group: usize| -> Vec<usize> {
            (GROUP * group..(GROUP * (group + 1)).min(nodes)).collect()
        };
        let of_groups = |[first, second]: &[usize; 2]| {
            let mut element = element_of(&members(*first));
            if first != second {
                let other = element_of(&members(*second));
                element[3 * GROUP..].copy_from_slice(&other[..3 * GROUP]);
            }
            element
        };
        self.groups.iter().map(of_groups).collect()
    }

    /// Passes the matrices of all elements for the contacts of the last evaluation.
    pub(crate) fn add(
        &mut self,
        contact: &ContactSystem,
        mut push: impl FnMut(usize, ElementMatrix),
    ) {
        let Some(curves) = contact.curves() else {
            return;
        };
        self.matrices.fill(0.0);
        for (pair, jacobian) in contact.contacts().iter().zip(contact.jacobians()) {
            if pair.first_body == 1 {
                // A point of a rod on the face of an obstacle.
                let own = std::array::from_fn(|i| std::array::from_fn(|j| jacobian[i][j]));
                self.subtract_at(curves, pair.nodes[0], &own);
                continue;
            }
            let bodies = match contact.is_of_rod(pair.nodes[3]) {
                true => 2,
                false => 1,
            };
            let edges = &contact.candidates()[pair.candidate].edges[..bodies];
            for (first, of_first) in edges.iter().enumerate() {
                for (second, of_second) in edges.iter().enumerate() {
                    let part = |m: usize, n: usize| -> Block {
                        let (row, column) = (3 * (2 * first + m), 3 * (2 * second + n));
                        std::array::from_fn(|i| {
                            std::array::from_fn(|j| jacobian[row + i][column + j])
                        })
                    };
                    let parts = [[part(0, 0), part(0, 1)], [part(1, 0), part(1, 1)]];
                    let windows = [of_first, of_second].map(|chord| curves.window(*chord));
                    self.subtract(windows, &parts);
                }
            }
        }
        for (touch, jacobian) in contact
            .plane_contacts()
            .iter()
            .zip(contact.plane_jacobians())
        {
            self.subtract_at(curves, touch.node, jacobian);
        }
        let (matrices, _) = self.matrices.as_chunks::<ENTRIES>();
        for (index, matrix) in matrices.iter().enumerate() {
            let (rows, _) = matrix.as_chunks::<12>();
            push(index, std::array::from_fn(|row| rows[row]));
        }
    }

    /// Subtracts the derivative of the force on a point by this point.
    fn subtract_at(&mut self, curves: &CurvePoints, point: usize, own: &Block) {
        let (chord, end) = curves.place_of(point);
        let mut parts = [[[[0.0; 3]; 3]; 2]; 2];
        parts[end][end] = *own;
        self.subtract([curves.window(chord); 2], &parts);
    }

    /// Subtracts the derivative of the forces on the two points of one edge by those of another.
    fn subtract(&mut self, [first, second]: [&Window; 2], parts: &[[Block; 2]; 2]) {
        let key = [first.nodes[0], second.nodes[0]];
        let Places(places) = &self.places[&key];
        for column in 0..WINDOW {
            let weights = [second.weights[0][column], second.weights[1][column]];
            // Force on each point of the first edge by the motion of this node.
            let by_node: [Block; 2] = std::array::from_fn(|m| {
                std::array::from_fn(|i| {
                    std::array::from_fn(|j| {
                        weights[0] * parts[m][0][i][j] + weights[1] * parts[m][1][i][j]
                    })
                })
            });
            for row in 0..WINDOW {
                let [one, other] = [first.weights[0][row], first.weights[1][row]];
                let start = places[row][column] as usize;
                for i in 0..3 {
                    let entries = &mut self.matrices[start + 12 * i..start + 12 * i + 3];
                    for (j, entry) in entries.iter_mut().enumerate() {
                        *entry -= one * by_node[0][i][j] + other * by_node[1][i][j];
                    }
                }
            }
        }
    }
}

/// The groups of two nodes, sorted.
fn groups_of([a, b]: [usize; 2]) -> [usize; 2] {
    let (a, b) = (a / GROUP, b / GROUP);
    [a.min(b), a.max(b)]
}
