//! Which nodes are coupled, and in which order to eliminate them.
//!
//! The order is found for nodes, not for unknowns: the graph is sixteen times smaller, and the
//! factorisation works on whole 4×4 blocks.

use super::element::{Element, is_free};
use super::node_block::NODE;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

/// The coupled pairs of nodes.
#[derive(Clone, Debug)]
pub(super) struct NodeGraph {
    /// Number of nodes.
    pub(super) nodes: usize,
    /// Pairs (p, q), p > q, sorted by q, then p.
    pairs: Vec<(u32, u32)>,
}

impl NodeGraph {
    /// Neighbours up to two apart along the band and the nodes of each element, as far as they have a
    /// free unknown in it. `owners` are the unknowns to which rows and columns of the band belong: those of elements have
    /// been replaced by theirs.
    pub(super) fn new(elements: &[Element], owners: &[usize], held: &[bool]) -> Self {
        let nodes = held.len().div_ceil(NODE);
        let owner_nodes = NodeOwners::new(owners, held);
        let has_free: Vec<bool> = held
            .chunks(NODE)
            .map(|node| node.contains(&false))
            .collect();
        let mut keys = Vec::with_capacity(2 * nodes + 6 * elements.len());
        for q in 0..nodes {
            for p in q + 1..nodes.min(q + 3) {
                if has_free[p] && has_free[q] {
                    keys.push(pair_key(p, q));
                }
            }
        }
        for (q, own) in owner_nodes.0.iter().enumerate() {
            for p in q..nodes.min(q + 3) {
                let other = &owner_nodes.0[p];
                if own.is_empty() && other.is_empty() {
                    continue;
                }
                // The node itself, as far as it has unknowns of its own, and those that own the others.
                let all = |node: usize, owners: &[usize]| -> Vec<usize> {
                    let itself = has_free[node].then_some(node);
                    owners.iter().copied().chain(itself).collect()
                };
                for &a in &all(q, own) {
                    for &b in &all(p, other) {
                        if a != b {
                            keys.push(pair_key(a, b));
                        }
                    }
                }
            }
        }
        for element in elements {
            for (place, &i) in element.iter().enumerate() {
                for &j in &element[..place] {
                    if is_free(i, held) && is_free(j, held) && i / NODE != j / NODE {
                        keys.push(pair_key(i / NODE, j / NODE));
                    }
                }
            }
        }
        keys.sort_unstable();
        keys.dedup();
        let pairs = keys
            .iter()
            .map(|&key| (key as u32, (key >> 32) as u32))
            .collect();
        Self { nodes, pairs }
    }

    /// Coupled pairs (p, q), p > q.
    pub(super) fn pairs(&self) -> &[(u32, u32)] {
        &self.pairs
    }

    /// Place of a pair in [`Self::pairs`].
    pub(super) fn pair(&self, p: usize, q: usize) -> Option<usize> {
        self.pairs
            .binary_search_by_key(&(q as u32, p as u32), |&(p, q)| (q, p))
            .ok()
    }

    /// The approximate minimum degree order (Amestoy, Davis & Duff 1996): entry k is the node to be
    /// eliminated as k-th.
    pub(super) fn elimination_order(&self) -> Vec<usize> {
        // The upper triangle by columns is the lower one by rows, so sort the pairs by p first.
        let mut starts = vec![0; self.nodes + 1];
        for &(p, _) in &self.pairs {
            starts[p as usize + 1] += 1;
        }
        for p in 0..self.nodes {
            starts[p + 1] += starts[p];
        }
        let mut next = starts.clone();
        let mut rows = vec![0; self.pairs.len()];
        for &(p, q) in &self.pairs {
            rows[next[p as usize]] = q as usize;
            next[p as usize] += 1;
        }
        let pattern =
            SymbolicSparseColMatRef::new_checked(self.nodes, self.nodes, &starts, None, &rows);
        let mut order = vec![0; self.nodes];
        let mut inverse = vec![0; self.nodes];
        let mut buffer = MemBuffer::new(amd::order_scratch::<usize>(self.nodes, rows.len()));
        amd::order(
            &mut order,
            &mut inverse,
            pattern,
            amd::Control::default(),
            MemStack::new(&mut buffer),
        )
        .expect("the number of coupled nodes fits an index");
        order
    }
}

/// Nodes that own free unknowns of each node; none where all are its own.
struct NodeOwners(Vec<Vec<usize>>);

impl NodeOwners {
    fn new(owners: &[usize], held: &[bool]) -> Self {
        let of_node = |(node, owners): (usize, &[usize])| {
            let others = owners.iter().filter(|&&owner| !held[owner]);
            let mut nodes: Vec<usize> = others.map(|owner| owner / NODE).collect();
            nodes.retain(|owner| *owner != node);
            nodes.dedup();
            nodes
        };
        Self(owners.chunks(NODE).enumerate().map(of_node).collect())
    }
}

/// Sorts by the smaller node first.
fn pair_key(p: usize, q: usize) -> u64 {
    ((p.min(q) as u64) << 32) | p.max(q) as u64
}
