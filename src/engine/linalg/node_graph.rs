//! The graph of coupled nodes, and the order of their elimination.
//!
//! The order is found for nodes, not for unknowns: the graph is sixteen times smaller, and the
//! factorisation works on whole 4×4 blocks.

use super::element::{Element, is_free};
use super::node_block::NODE;
use amd::Control;

/// The coupled pairs of nodes.
#[derive(Clone, Debug)]
pub(super) struct NodeGraph {
    /// Number of nodes.
    pub(super) nodes: usize,
    /// Pairs (p, q), p > q, sorted by q, then p.
    pairs: Vec<(u32, u32)>,
    /// Start of the pairs of each q, and the end of the last.
    starts: Vec<u32>,
}

impl NodeGraph {
    /// Couples neighbours up to two apart along the band, and the nodes of each element that have
    /// a free unknown in it. Elements name the owners of shared unknowns.
    pub(super) fn new(elements: &[Element], band: &BandPattern) -> Self {
        let nodes = band.held.len().div_ceil(NODE);
        let couplings = band.couplings();
        let mut keys = Vec::with_capacity(2 * nodes + 6 * elements.len());
        for q in 0..nodes {
            for p in q..band.end_of_reach(q) {
                for &a in &couplings[q] {
                    for &b in &couplings[p] {
                        if a != b {
                            keys.push(pair_key(a, b));
                        }
                    }
                }
            }
        }
        let held = &band.held;
        let mut of_element: Vec<usize> = Vec::new();
        for element in elements {
            of_element.clear();
            for node in (element.iter().filter(|i| is_free(**i, held))).map(|i| i / NODE) {
                if !of_element.contains(&node) {
                    keys.extend(of_element.iter().map(|&other| pair_key(node, other)));
                    of_element.push(node);
                }
            }
        }
        Self::of_keys(nodes, keys)
    }

    /// The graph of the given pairs, in any order; pairs may repeat.
    pub(super) fn of_pairs(nodes: usize, pairs: &[(u32, u32)]) -> Self {
        let pairs = pairs.iter().filter(|(p, q)| p != q);
        let keys = pairs
            .map(|&(p, q)| pair_key(p as usize, q as usize))
            .collect();
        Self::of_keys(nodes, keys)
    }

    fn of_keys(nodes: usize, mut keys: Vec<u64>) -> Self {
        keys.sort_unstable();
        keys.dedup();
        let pair = |&key: &u64| (key as u32, (key >> 32) as u32);
        let pairs: Vec<(u32, u32)> = keys.iter().map(pair).collect();
        let mut starts = Vec::with_capacity(nodes + 1);
        for q in 0..=nodes as u32 {
            let before = starts.last().map_or(0, |start| *start as usize);
            let more = pairs[before..].iter().take_while(|pair| pair.1 < q);
            starts.push((before + more.count()) as u32);
        }
        Self {
            nodes,
            pairs,
            starts,
        }
    }

    /// Coupled pairs (p, q), p > q.
    pub(super) fn pairs(&self) -> &[(u32, u32)] {
        &self.pairs
    }

    /// Index of a pair in [`Self::pairs`].
    pub(super) fn pair(&self, p: usize, q: usize) -> Option<usize> {
        let [first, end] = [q, q + 1].map(|q| self.starts[q] as usize);
        let place = self.pairs[first..end].binary_search_by_key(&(p as u32), |pair| pair.0);
        place.ok().map(|place| first + place)
    }

    /// The same graph with its nodes renumbered in the order of the list.
    pub(super) fn renumbered(&self, nodes: &[u32]) -> Self {
        let mut number = vec![0; self.nodes];
        for (own, &node) in (0..).zip(nodes) {
            number[node as usize] = own;
        }
        let pairs = self.pairs.iter();
        let renumbered = pairs.map(|&(p, q)| (number[p as usize], number[q as usize]));
        Self::of_pairs(self.nodes, &renumbered.collect::<Vec<_>>())
    }

    /// The approximate minimum degree order (Amestoy, Davis & Duff 1996): entry k is the node to be
    /// eliminated as k-th.
    pub(super) fn minimum_degree_order(&self) -> Vec<usize> {
        // The upper triangle by columns is the lower triangle by rows, so sort the pairs by p
        // first. The diagonal ends each column.
        let mut starts = vec![0; self.nodes + 1];
        for &(p, _) in &self.pairs {
            starts[p as usize + 1] += 1;
        }
        for p in 0..self.nodes {
            starts[p + 1] += starts[p] + 1;
        }
        let mut next = starts.clone();
        let mut rows = vec![0; starts[self.nodes]];
        for &(p, q) in &self.pairs {
            rows[next[p as usize]] = q as usize;
            next[p as usize] += 1;
        }
        for p in 0..self.nodes {
            rows[next[p]] = p;
        }
        let (order, _, _) = amd::order(self.nodes, &starts, &rows, &Control::default())
            .expect("columns are sorted and name nodes of the graph");
        order
    }
}

/// Unknowns coupled by the band.
#[derive(Clone, Debug, Default)]
pub(super) struct BandPattern {
    /// The owner of each unknown's row and column: a shared unknown has another owner, any other
    /// unknown itself.
    pub(super) owners: Vec<usize>,
    /// Whether an unknown keeps its value; true for shared unknowns as well.
    pub(super) held: Vec<bool>,
    /// First nodes of the parts that are not coupled with those before; if empty, there is one
    /// part.
    pub(super) chains: Vec<usize>,
}

impl BandPattern {
    /// End of the range of nodes that the band may couple with this node; the range starts at the
    /// node itself.
    pub(super) fn end_of_reach(&self, node: usize) -> usize {
        let next = self.chains.partition_point(|first| *first <= node);
        let end = self.chains.get(next).copied().unwrap_or(usize::MAX);
        end.min(node + 3).min(self.held.len() / NODE)
    }

    /// For each node, the nodes whose free unknowns own its rows and columns: itself, if it has
    /// free unknowns, and the owners of its shared ones.
    fn couplings(&self) -> Vec<Vec<usize>> {
        let of_node = |(node, owners): (usize, &[usize])| {
            let unknowns = NODE * node..NODE * (node + 1);
            let itself = self.held[unknowns].contains(&false).then_some(node);
            let others = owners.iter().filter(|&&owner| !self.held[owner]);
            let others = others
                .map(|owner| owner / NODE)
                .filter(|owner| *owner != node);
            let mut nodes: Vec<usize> = itself.into_iter().chain(others).collect();
            nodes.dedup();
            nodes
        };
        self.owners.chunks(NODE).enumerate().map(of_node).collect()
    }
}

/// Sort key with the smaller node first.
fn pair_key(p: usize, q: usize) -> u64 {
    ((p.min(q) as u64) << 32) | p.max(q) as u64
}
