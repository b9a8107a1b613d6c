//! Where an elimination in a given order fills the matrix (George & Liu 1981, ch. 5).

use super::node_graph::NodeGraph;

/// The pattern of the factor by columns, in the order of elimination.
#[derive(Clone, Debug)]
pub(super) struct SymbolicFactor {
    /// Node eliminated as k-th.
    pub(super) order: Vec<usize>,
    /// Blocks of column k below the diagonal are `starts[k]..starts[k + 1]`.
    pub(super) starts: Vec<u32>,
    /// Row, in the order of elimination, of each block below the diagonal; ascending in each column.
    pub(super) rows: Vec<u32>,
    /// Block that each pair (a, b), a > b, of rows of a column updates: block (row a, row b), in the order
    /// in which the elimination meets the pairs: by column, then b, then a.
    pub(super) targets: Vec<u32>,
    /// Block of each pair of the node graph, and whether it lies there transposed.
    pub(super) places: Vec<(u32, bool)>,
}

impl SymbolicFactor {
    /// Chooses the order and finds the pattern.
    pub(super) fn new(graph: &NodeGraph) -> Self {
        let order = graph.elimination_order();
        let mut position = vec![0u32; graph.nodes];
        for (k, &node) in order.iter().enumerate() {
            position[node] = k as u32;
        }
        let (starts, rows) = fill(graph, &position);
        let targets = update_targets(&starts, &rows);
        let places = graph
            .pairs()
            .iter()
            .map(|&(p, q)| {
                let (row, column) = (position[p as usize], position[q as usize]);
                let block = find(&starts, &rows, row.max(column), row.min(column));
                (block, row < column)
            })
            .collect();
        Self { order, starts, rows, targets, places }
    }

    /// Blocks of column k.
    #[inline(always)]
    pub(super) fn column(&self, k: usize) -> std::ops::Range<usize> {
        self.starts[k] as usize..self.starts[k + 1] as usize
    }
}

/// Pattern of each column: that of the matrix and those of its children in the elimination tree.
fn fill(graph: &NodeGraph, position: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let nodes = graph.nodes;
    let mut neighbours = vec![Vec::new(); nodes];
    for &(p, q) in graph.pairs() {
        let (row, column) = (position[p as usize], position[q as usize]);
        neighbours[row.min(column) as usize].push(row.max(column));
    }
    let mut children = vec![Vec::new(); nodes];
    let mut seen_by = vec![u32::MAX; nodes];
    let (mut starts, mut rows) = (vec![0u32], Vec::<u32>::new());
    for k in 0..nodes {
        let start = rows.len();
        let mut visit = |row: u32, rows: &mut Vec<u32>| {
            if row as usize != k && seen_by[row as usize] != k as u32 {
                seen_by[row as usize] = k as u32;
                rows.push(row);
            }
        };
        for &row in &neighbours[k] {
            visit(row, &mut rows);
        }
        for &child in &children[k] {
            for place in starts[child] as usize..starts[child + 1] as usize {
                visit(rows[place], &mut rows);
            }
        }
        rows[start..].sort_unstable();
        if let Some(&parent) = rows.get(start) {
            children[parent as usize].push(k);
        }
        starts.push(rows.len() as u32);
    }
    (starts, rows)
}

/// For each column and each pair of its rows, the block that the pair's outer product updates.
fn update_targets(starts: &[u32], rows: &[u32]) -> Vec<u32> {
    let mut targets = Vec::new();
    for column in starts.windows(2) {
        let own = &rows[column[0] as usize..column[1] as usize];
        for (b, &row_b) in own.iter().enumerate() {
            // The rows after b all occur in column `row_b`, in the same ascending order.
            let mut block = starts[row_b as usize];
            for &row_a in &own[b + 1..] {
                while rows[block as usize] != row_a {
                    block += 1;
                }
                targets.push(block);
            }
        }
    }
    targets
}

/// Index of block (row, column), row > column.
fn find(starts: &[u32], rows: &[u32], row: u32, column: u32) -> u32 {
    let range = starts[column as usize] as usize..starts[column as usize + 1] as usize;
    let place =
        rows[range].binary_search(&row).expect("the pattern of the factor contains that of the matrix");
    starts[column as usize] + place as u32
}
