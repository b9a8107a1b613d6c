//! Symbolic factorisation: the fill of the matrix in a given elimination order (George & Liu 1981,
//! ch. 5; Davis 2006, ch. 4), and the dependencies within it.

use super::branches::{Branch, branches};
use super::elimination_order::best_tree;
use super::elimination_tree::EliminationTree;
use super::node_graph::NodeGraph;
use super::supernodes::{Supernode, Supernodes};
use std::ops::Range;

/// The pattern of the factor by supernodes, in the order of elimination.
#[derive(Clone, Debug)]
pub(super) struct SymbolicFactor {
    /// Node eliminated as k-th.
    pub(super) order: Vec<usize>,
    pub(super) supernodes: Supernodes,
    /// Updates of supernode s by the supernodes before it: `updates[update_starts[s]..update_starts[s + 1]]`.
    update_starts: Vec<usize>,
    updates: Vec<Update>,
    /// Number of block products of each supernode if the matrix is symmetric.
    pub(super) products: Vec<usize>,
    /// Branches: supernodes that are independent of those of other branches.
    pub(super) branches: Vec<Branch>,
    /// Trunk: the other supernodes, children before parents.
    pub(super) trunk: Vec<usize>,
    /// Pairs of the node graph by the supernodes that hold them: those of s are `entries[entry_starts[s]..entry_starts[s + 1]]`.
    entry_starts: Vec<usize>,
    entries: Vec<Entry>,
}

/// Location of the block of a pair of nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// The pair, as the node graph lists them.
    pub(super) pair: u32,
    /// Its block, among those of its supernode.
    pub(super) place: u32,
    /// Whether it is transposed there.
    pub(super) is_transposed: bool,
}

/// A supernode with rows among the columns of a later one.
#[derive(Clone, Debug)]
pub(super) struct Update {
    /// The earlier supernode.
    pub(super) source: usize,
    /// Those rows, among the rows of the source below its columns.
    pub(super) rows: Range<usize>,
}

impl SymbolicFactor {
    /// Chooses the order and finds the pattern.
    pub(super) fn new(graph: &NodeGraph) -> Self {
        let (tree, supernodes) = best_tree(graph);
        Self::of_tree(graph, tree, supernodes)
    }

    /// The pattern for nodes eliminated in the order of a tree with these supernodes.
    fn of_tree(graph: &NodeGraph, tree: EliminationTree, supernodes: Supernodes) -> Self {
        let (update_starts, updates) = updates(&supernodes);
        let products: Vec<usize> = (supernodes.list.iter().zip(update_starts.windows(2)))
            .map(|(supernode, range)| {
                let updates = updates[range[0]..range[1]].iter();
                let of_update = |update: &Update| update.products(&supernodes.list[update.source]);
                supernode.products() + updates.map(of_update).sum::<usize>()
            })
            .collect();
        let (branches, trunk) = branches(&supernodes.parents(), &products);
        let (entry_starts, entries) = entries(graph, &tree.position, &supernodes);
        Self {
            order: tree.order,
            supernodes,
            update_starts,
            updates,
            products,
            branches,
            trunk,
            entry_starts,
            entries,
        }
    }

    /// Updates of a supernode by the supernodes before it.
    #[inline(always)]
    pub(super) fn updates(&self, supernode: usize) -> &[Update] {
        &self.updates[self.update_starts[supernode]..self.update_starts[supernode + 1]]
    }

    /// The pairs of nodes in a supernode.
    #[inline(always)]
    pub(super) fn entries(&self, supernode: usize) -> &[Entry] {
        &self.entries[self.entry_starts[supernode]..self.entry_starts[supernode + 1]]
    }
}

impl Update {
    /// Number of block products: each column of the update is multiplied with the rows from its
    /// own row on.
    fn products(&self, source: &Supernode) -> usize {
        let (columns, below) = (self.rows.len(), source.rows.len() - self.rows.start);
        source.width() * columns * (2 * below - columns + 1) / 2
    }
}

/// The updates of all supernodes, the sources of each in their order.
fn updates(supernodes: &Supernodes) -> (Vec<usize>, Vec<Update>) {
    let of_row = |row: &u32| supernodes.of_column[*row as usize] as usize;
    let targets = supernodes
        .list
        .iter()
        .enumerate()
        .flat_map(|(source, supernode)| {
            let rows = &supernodes.rows[supernode.rows.clone()];
            let mut start = 0;
            let chunks = rows.chunk_by(move |a, b| of_row(a) == of_row(b));
            chunks.map(move |chunk| {
                let rows = start..start + chunk.len();
                start = rows.end;
                (of_row(&chunk[0]), Update { source, rows })
            })
        });
    gathered(supernodes.list.len(), targets.collect())
}

/// The pairs of nodes in each supernode.
fn entries(
    graph: &NodeGraph,
    position: &[u32],
    supernodes: &Supernodes,
) -> (Vec<usize>, Vec<Entry>) {
    let entry = |(pair, &(p, q)): (usize, &(u32, u32))| {
        let (row, column) = (position[p as usize], position[q as usize]);
        let (supernode, place) = supernodes.place(row.max(column), row.min(column));
        let entry = Entry {
            pair: pair as u32,
            place: place as u32,
            is_transposed: row < column,
        };
        (supernode, entry)
    };
    let entries = graph.pairs().iter().enumerate().map(entry).collect();
    gathered(supernodes.list.len(), entries)
}

/// Groups values by supernode, in order: the start of each group, and the values.
fn gathered<T>(supernodes: usize, mut values: Vec<(usize, T)>) -> (Vec<usize>, Vec<T>) {
    let mut starts = vec![0; supernodes + 1];
    values
        .iter()
        .for_each(|(supernode, _)| starts[supernode + 1] += 1);
    for k in 0..supernodes {
        starts[k + 1] += starts[k];
    }
    values.sort_by_key(|(supernode, _)| *supernode);
    (starts, values.into_iter().map(|(_, value)| value).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::dissection::dissection_order;
    use proptest::prelude::*;

    /// Random graphs of 1 to 39 nodes.
    fn graphs() -> impl Strategy<Value = NodeGraph> {
        (1..40usize).prop_flat_map(|nodes| {
            let pair = (0..nodes as u32, 0..nodes as u32);
            prop::collection::vec(pair, 0..80)
                .prop_map(move |pairs| NodeGraph::of_pairs(nodes, &pairs))
        })
    }

    /// The rows below the diagonal that Gaussian elimination fills in each column.
    fn filled(graph: &NodeGraph, order: &[usize]) -> Vec<Vec<bool>> {
        let nodes = graph.nodes;
        let mut position = vec![0; nodes];
        (0..nodes).for_each(|k| position[order[k]] = k);
        let mut filled = vec![vec![false; nodes]; nodes];
        for &(p, q) in graph.pairs() {
            let (p, q) = (position[p as usize], position[q as usize]);
            filled[p.min(q)][p.max(q)] = true;
        }
        for k in 0..nodes {
            let rows: Vec<usize> = (0..nodes).filter(|row| filled[k][*row]).collect();
            for (place, &column) in rows.iter().enumerate() {
                rows[place + 1..]
                    .iter()
                    .for_each(|&row| filled[column][row] = true);
            }
        }
        filled
    }

    proptest! {
        #[test]
        fn panels_hold_what_elimination_fills(graph in graphs(), dissects in any::<bool>()) {
            let order = if dissects { dissection_order(&graph) } else { graph.minimum_degree_order() };
            let factor = {
                let tree = EliminationTree::new(&graph, &order);
                let supernodes = Supernodes::new(&tree);
                SymbolicFactor::of_tree(&graph, tree, supernodes)
            };
            let mut nodes = factor.order.clone();
            nodes.sort_unstable();
            prop_assert!(nodes.into_iter().eq(0..graph.nodes));
            let filled = filled(&graph, &factor.order);
            let mut stored = vec![vec![false; graph.nodes]; graph.nodes];
            let mut end = 0;
            for supernode in &factor.supernodes.list {
                prop_assert_eq!(supernode.columns.start, end);
                end = supernode.columns.end;
                for column in supernode.columns.clone() {
                    let below = &factor.supernodes.rows[supernode.rows.clone()];
                    prop_assert!(below.is_sorted());
                    below.iter().for_each(|&row| stored[column][row as usize] = true);
                    (column + 1..end).for_each(|row| stored[column][row] = true);
                }
            }
            prop_assert_eq!(end, graph.nodes);
            for (stored, filled) in stored.iter().zip(&filled) {
                prop_assert!(stored.iter().zip(filled).all(|(stored, filled)| *stored || !filled));
            }
        }

        #[test]
        fn branches_depend_on_themselves_alone(graph in graphs()) {
            let factor = SymbolicFactor::new(&graph);
            let mut seen = factor.trunk.len();
            for branch in &factor.branches {
                seen += branch.supernodes.len();
                for supernode in branch.supernodes.clone() {
                    for update in factor.updates(supernode) {
                        prop_assert!(branch.supernodes.contains(&update.source));
                    }
                }
            }
            prop_assert_eq!(seen, factor.supernodes.list.len());
        }
    }
}
