//! The elimination tree of a pattern, and an elimination order in which the nodes of each subtree
//! are consecutive.

use super::node_graph::NodeGraph;

/// No parent.
pub(super) const ROOT: u32 = u32::MAX;

/// An elimination order with its tree: column k fills only columns on the path from k to its root.
#[derive(Clone, Debug)]
pub(super) struct EliminationTree {
    /// Node eliminated as k-th. The columns of each subtree are consecutive; its root comes last.
    pub(super) order: Vec<usize>,
    /// Place of each node in the order.
    pub(super) position: Vec<u32>,
    /// First row below the diagonal of each column, or [`ROOT`] if there is none.
    pub(super) parent: Vec<u32>,
    /// Rows below the diagonal in each column of the matrix: those of column k are `rows[starts[k]..starts[k + 1]]`.
    starts: Vec<u32>,
    rows: Vec<u32>,
}

impl EliminationTree {
    /// The tree of a graph whose nodes are eliminated in the given order, up to the order of independent columns.
    pub(super) fn new(graph: &NodeGraph, order: &[usize]) -> Self {
        let position = inverse(order);
        let (starts, columns) = below_diagonal(graph, &position, |row, _| row, |_, column| column);
        let parent = parents(&starts, &columns);
        let postorder = postorder(&parent);
        let order: Vec<usize> = postorder.iter().map(|&k| order[k]).collect();
        let place = inverse(&postorder);
        let parent = (postorder.iter())
            .map(|&k| {
                let above = parent[k];
                if above == ROOT {
                    ROOT
                } else {
                    place[above as usize]
                }
            })
            .collect();
        let position = inverse(&order);
        let (starts, rows) = below_diagonal(graph, &position, |_, column| column, |row, _| row);
        Self {
            order,
            position,
            parent,
            starts,
            rows,
        }
    }

    /// Rows below the diagonal in a column of the matrix, in no order.
    pub(super) fn rows(&self, column: usize) -> &[u32] {
        &self.rows[self.starts[column] as usize..self.starts[column + 1] as usize]
    }
}

fn inverse(order: &[usize]) -> Vec<u32> {
    let mut position = vec![0; order.len()];
    for (k, &node) in order.iter().enumerate() {
        position[node] = k as u32;
    }
    position
}

/// Groups the entries (row, column) below the diagonal by `key` and returns the `value` of each.
fn below_diagonal(
    graph: &NodeGraph,
    position: &[u32],
    key: impl Fn(u32, u32) -> u32,
    value: impl Fn(u32, u32) -> u32,
) -> (Vec<u32>, Vec<u32>) {
    let entries = || {
        graph.pairs().iter().map(|&(p, q)| {
            let (p, q) = (position[p as usize], position[q as usize]);
            (p.max(q), p.min(q))
        })
    };
    let mut starts = vec![0u32; graph.nodes + 1];
    for (row, column) in entries() {
        starts[key(row, column) as usize + 1] += 1;
    }
    for k in 0..graph.nodes {
        starts[k + 1] += starts[k];
    }
    let mut next = starts.clone();
    let mut values = vec![0; graph.pairs().len()];
    for (row, column) in entries() {
        let place = &mut next[key(row, column) as usize];
        values[*place as usize] = value(row, column);
        *place += 1;
    }
    (starts, values)
}

/// The parent of each node, from the columns left of the diagonal in each row (Liu 1990, algorithm
/// 4.2, with path compression).
fn parents(starts: &[u32], columns: &[u32]) -> Vec<u32> {
    let nodes = starts.len() - 1;
    let mut parent = vec![ROOT; nodes];
    let mut ancestor = vec![ROOT; nodes];
    for row in 0..nodes {
        for &column in &columns[starts[row] as usize..starts[row + 1] as usize] {
            let mut k = column as usize;
            while ancestor[k] != ROOT && ancestor[k] != row as u32 {
                k = std::mem::replace(&mut ancestor[k], row as u32) as usize;
            }
            if ancestor[k] == ROOT {
                ancestor[k] = row as u32;
                parent[k] = row as u32;
            }
        }
    }
    parent
}

/// The postorder: one subtree after the other, each with its root last.
fn postorder(parent: &[u32]) -> Vec<usize> {
    let nodes = parent.len();
    let (mut first_child, mut sibling) = (vec![ROOT; nodes], vec![ROOT; nodes]);
    for k in (0..nodes).rev() {
        if parent[k] != ROOT {
            sibling[k] = first_child[parent[k] as usize];
            first_child[parent[k] as usize] = k as u32;
        }
    }
    let mut order = Vec::with_capacity(nodes);
    for root in (0..nodes).filter(|&k| parent[k] == ROOT) {
        let mut k = descend(root, &first_child);
        loop {
            order.push(k);
            if k == root {
                break;
            }
            k = match sibling[k] {
                ROOT => parent[k] as usize,
                next => descend(next as usize, &first_child),
            };
        }
    }
    order
}

/// The leaf reached from `k` through first children.
fn descend(mut k: usize, first_child: &[u32]) -> usize {
    while first_child[k] != ROOT {
        k = first_child[k] as usize;
    }
    k
}
