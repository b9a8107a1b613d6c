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
    /// Blocks left of the diagonal in row k are `row_blocks[row_starts[k]..row_starts[k + 1]]`.
    pub(super) row_starts: Vec<u32>,
    /// Each of them by columns, with the end of its column.
    pub(super) row_blocks: Vec<RowBlock>,
    /// Block of each pair of the node graph, and whether it lies there transposed.
    pub(super) places: Vec<(u32, bool)>,
}

/// A block of the factor as seen from its row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RowBlock {
    /// The block.
    pub(super) block: u32,
    /// End of the blocks of the same column.
    pub(super) end: u32,
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
        let (row_starts, row_blocks) = by_rows(&starts, &rows);
        let places = graph
            .pairs()
            .iter()
            .map(|&(p, q)| {
                let (row, column) = (position[p as usize], position[q as usize]);
                let block = find(&starts, &rows, row.max(column), row.min(column));
                (block, row < column)
            })
            .collect();
        Self {
            order,
            starts,
            rows,
            row_starts,
            row_blocks,
            places,
        }
    }

    /// Blocks left of the diagonal in row k.
    #[inline(always)]
    pub(super) fn row(&self, k: usize) -> &[RowBlock] {
        &self.row_blocks[self.row_starts[k] as usize..self.row_starts[k + 1] as usize]
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

/// The same pattern by rows.
fn by_rows(starts: &[u32], rows: &[u32]) -> (Vec<u32>, Vec<RowBlock>) {
    let mut row_starts = vec![0u32; starts.len()];
    for &row in rows {
        row_starts[row as usize + 1] += 1;
    }
    for k in 1..row_starts.len() {
        row_starts[k] += row_starts[k - 1];
    }
    let mut next = row_starts.clone();
    let mut row_blocks = vec![RowBlock::default(); rows.len()];
    for column in starts.windows(2) {
        for block in column[0]..column[1] {
            let place = &mut next[rows[block as usize] as usize];
            row_blocks[*place as usize] = RowBlock {
                block,
                end: column[1],
            };
            *place += 1;
        }
    }
    (row_starts, row_blocks)
}

/// Index of block (row, column), row > column.
fn find(starts: &[u32], rows: &[u32], row: u32, column: u32) -> u32 {
    let range = starts[column as usize] as usize..starts[column as usize + 1] as usize;
    let place = rows[range]
        .binary_search(&row)
        .expect("the pattern of the factor contains that of the matrix");
    starts[column as usize] + place as u32
}
