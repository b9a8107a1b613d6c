//! Supernodes: columns of the factor next to each other that fill the same rows, held as one dense panel.

use super::elimination_tree::{EliminationTree, ROOT};
use std::ops::Range;

/// Most columns of a supernode: two rows of its blocks stay in the fastest cache, and little work
/// is left to a single thread.
const WIDEST: usize = 16;

/// Share of zeros allowed in a panel merged from two, by its number of columns: narrow panels cost
/// more in bookkeeping than in arithmetic.
const ZEROS: [(usize, f64); 3] = [(2, 0.2), (6, 0.08), (WIDEST, 0.02)];

/// Consecutive columns and the rows that they fill.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Supernode {
    /// Its columns.
    pub(super) columns: Range<usize>,
    /// The rows below its last column, as a range of the rows of all supernodes.
    pub(super) rows: Range<usize>,
    /// Its first block. The blocks of a row are consecutive; the rows of its own columns come
    /// first.
    pub(super) first_block: usize,
}

impl Supernode {
    /// Number of columns.
    #[inline(always)]
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// Number of rows; those of its columns come first.
    #[inline(always)]
    pub(super) fn height(&self) -> usize {
        self.columns.len() + self.rows.len()
    }

    /// Number of block products among its own columns if the matrix is symmetric.
    pub(super) fn products(&self) -> usize {
        let (width, below) = (self.width(), self.rows.len());
        width * (width * width / 6 + width * below / 2 + width + below)
    }

    /// Its blocks.
    #[inline(always)]
    pub(super) fn blocks(&self) -> Range<usize> {
        self.first_block..self.first_block + self.width() * self.height()
    }
}

/// The supernodes of a factor.
#[derive(Clone, Debug)]
pub(super) struct Supernodes {
    /// Children before parents; every subtree of the elimination tree is consecutive.
    pub(super) list: Vec<Supernode>,
    /// Rows below each supernode, ascending, in the order of elimination.
    pub(super) rows: Vec<u32>,
    /// The supernode of each column.
    pub(super) of_column: Vec<u32>,
}

impl Supernodes {
    pub(super) fn new(tree: &EliminationTree) -> Self {
        let (fundamental, rows) = fundamental(tree);
        let (list, rows) = merged(fundamental, &rows);
        let mut of_column = vec![0; tree.order.len()];
        for (index, supernode) in list.iter().enumerate() {
            of_column[supernode.columns.clone()].fill(index as u32);
        }
        Self {
            list,
            rows,
            of_column,
        }
    }

    /// The supernode that holds the first row below each supernode.
    pub(super) fn parents(&self) -> Vec<Option<usize>> {
        let parent = |supernode: &Supernode| {
            let first = self.rows[supernode.rows.clone()].first()?;
            Some(self.of_column[*first as usize] as usize)
        };
        self.list.iter().map(parent).collect()
    }

    /// The supernode of a column, and its block in a row, on the diagonal or below.
    pub(super) fn place(&self, row: u32, column: u32) -> (usize, usize) {
        let (row, column) = (row as usize, column as usize);
        let index = self.of_column[column] as usize;
        let supernode = &self.list[index];
        let local = if supernode.columns.contains(&row) {
            row - supernode.columns.start
        } else {
            let below = self.rows[supernode.rows.clone()].binary_search(&(row as u32));
            supernode.width() + below.expect("the factor fills what the matrix fills")
        };
        (
            index,
            local * supernode.width() + column - supernode.columns.start,
        )
    }

    /// Number of block products of the elimination if the matrix is symmetric.
    pub(super) fn products(&self) -> usize {
        let of_panel = |supernode: &Supernode| {
            let below = supernode.rows.len()..supernode.height();
            below.map(|rows| rows * (rows + 1) / 2).sum::<usize>()
        };
        self.list.iter().map(of_panel).sum()
    }

    /// Number of blocks that are stored for each triangle, zeros included.
    pub(super) fn blocks(&self) -> usize {
        self.list.last().map_or(0, |last| last.blocks().end)
    }
}

/// A supernode under construction, which may share its rows with a supernode with which it was
/// merged.
#[derive(Clone)]
struct Growing {
    columns: Range<usize>,
    rows: Range<usize>,
    /// Number of nonzero blocks on the diagonal and below.
    filled: usize,
}

impl Growing {
    /// Number of blocks on the diagonal and below.
    fn blocks(&self) -> usize {
        let width = self.columns.len();
        width * (width + 1) / 2 + width * self.rows.len()
    }

    /// Whether `parent` has the next columns and contains the first row below this supernode.
    fn is_child_of(&self, parent: &Self, rows: &[u32]) -> bool {
        let first = rows[self.rows.clone()].first();
        self.columns.end == parent.columns.start
            && first.is_some_and(|row| parent.columns.contains(&(*row as usize)))
    }

    fn merged_into(&self, parent: &Self) -> Self {
        Self {
            columns: self.columns.start..parent.columns.end,
            rows: parent.rows.clone(),
            filled: self.filled + parent.filled,
        }
    }

    /// Whether it is narrow enough, and few enough of its blocks are zero.
    fn is_dense(&self) -> bool {
        let width = self.columns.len();
        let limit = ZEROS.iter().find(|(columns, _)| width <= *columns);
        let zeros = self.blocks() - self.filled;
        limit.is_some_and(|(_, part)| zeros as f64 <= part * self.blocks() as f64)
    }
}

/// Joins consecutive columns while each is a child of the next and fills just one row more. The
/// pattern of a column is that of the matrix and of the children (George & Liu 1981, ch. 5).
fn fundamental(tree: &EliminationTree) -> (Vec<Growing>, Vec<u32>) {
    let columns = tree.parent.len();
    let mut supernodes: Vec<Growing> = Vec::new();
    let mut rows: Vec<u32> = Vec::new();
    let mut seen_by = vec![ROOT; columns];
    // Linked lists of the supernodes whose first row below is each column.
    let (mut first_child, mut sibling) = (vec![ROOT; columns], Vec::new());
    for k in 0..columns {
        let start = rows.len();
        let mut visit = |row: u32, rows: &mut Vec<u32>| {
            if row as usize != k && seen_by[row as usize] != k as u32 {
                seen_by[row as usize] = k as u32;
                rows.push(row);
            }
        };
        let mut child = first_child[k];
        while child != ROOT {
            for place in supernodes[child as usize].rows.clone() {
                visit(rows[place], &mut rows);
            }
            child = sibling[child as usize];
        }
        for &row in tree.rows(k) {
            visit(row, &mut rows);
        }
        let count = rows.len() - start;
        let extended = supernodes.last_mut().filter(|before| {
            let is_child = k > 0 && tree.parent[k - 1] == k as u32;
            is_child && before.rows.len() == count + 1 && before.columns.len() < WIDEST
        });
        let own = if let Some(before) = extended {
            // The rows of the extended supernode, without its first row k.
            rows.truncate(start);
            before.columns.end = k + 1;
            before.rows.start += 1;
            before.filled += 1 + count;
            supernodes.len() - 1
        } else {
            rows[start..].sort_unstable();
            supernodes.push(Growing {
                columns: k..k + 1,
                rows: start..rows.len(),
                filled: 1 + count,
            });
            sibling.push(ROOT);
            supernodes.len() - 1
        };
        let parent = tree.parent[k];
        if parent != ROOT {
            sibling[own] = first_child[parent as usize];
            first_child[parent as usize] = own as u32;
        }
    }
    (supernodes, rows)
}

/// Merges supernodes with the last of their children while the panel stores few zeros.
fn merged(fundamental: Vec<Growing>, rows: &[u32]) -> (Vec<Supernode>, Vec<u32>) {
    let mut stack: Vec<Growing> = Vec::with_capacity(fundamental.len());
    for mut supernode in fundamental {
        while let Some(child) = stack
            .last()
            .filter(|last| last.is_child_of(&supernode, rows))
        {
            let both = child.merged_into(&supernode);
            if !both.is_dense() {
                break;
            }
            supernode = both;
            stack.pop();
        }
        stack.push(supernode);
    }
    let mut own_rows = Vec::with_capacity(rows.len());
    let mut first_block = 0;
    let supernodes = stack
        .into_iter()
        .map(|growing| {
            let start = own_rows.len();
            own_rows.extend_from_slice(&rows[growing.rows]);
            let supernode = Supernode {
                columns: growing.columns,
                rows: start..own_rows.len(),
                first_block,
            };
            first_block = supernode.blocks().end;
            supernode
        })
        .collect();
    (supernodes, own_rows)
}
