//! Arithmetic on the rows of a panel, the blocks of a supernode; an elimination spends all its
//! time here.

use super::error::{Inertia, SingularMatrix};
use super::node_block::{Block, BlockMatrix, DiagonalFactor, NODE, product, symmetric_pivots};
use super::supernodes::Supernodes;
use super::symbolic::{Entry, Update};
use std::ops::Range;

/// Consecutive rows of a panel.
pub(super) struct Rows<'a> {
    /// Blocks of 𝓛, row by row; `upper` holds those of 𝓤, transposed.
    pub(super) lower: &'a mut [Block],
    pub(super) upper: &'a mut [Block],
    /// Columns of the panel.
    pub(super) width: usize,
    /// The first of the rows.
    pub(super) first: usize,
}

/// The panels before one.
pub(super) struct Earlier<'a> {
    pub(super) supernodes: &'a Supernodes,
    /// First block of the earliest of these panels.
    pub(super) first_block: usize,
    pub(super) lower: &'a [Block],
    pub(super) upper: &'a [Block],
}

/// One triangle of an earlier panel below its own columns.
struct Source<'a> {
    own: &'a [Block],
    other: &'a [Block],
    width: usize,
    /// Row of the matrix for each row of the source.
    rows: &'a [u32],
    local_rows: &'a [u32],
}

impl<'a> Rows<'a> {
    /// Number of rows.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.lower.len() / self.width
    }

    /// A temporary view of the same rows.
    #[inline(always)]
    pub(super) fn reborrow(&mut self) -> Rows<'_> {
        Rows {
            lower: self.lower,
            upper: self.upper,
            ..*self
        }
    }

    /// Splits the rows into the first `count` and the others.
    #[inline(always)]
    pub(super) fn split(self, count: usize) -> (Self, Self) {
        let (lower, lower_after) = self.lower.split_at_mut(count * self.width);
        let (upper, upper_after) = self.upper.split_at_mut(count * self.width);
        let after = Self {
            lower: lower_after,
            upper: upper_after,
            first: self.first + count,
            ..self
        };
        let before = Self {
            lower,
            upper,
            ..self
        };
        (before, after)
    }

    /// Loads the matrix entries of all rows of the panel.
    #[inline(always)]
    pub(super) fn load(
        &mut self,
        matrix: &BlockMatrix,
        nodes: &[usize],
        entries: &[Entry],
        symmetric: bool,
    ) {
        self.lower.fill(Block::ZERO);
        if !symmetric {
            self.upper.fill(Block::ZERO);
        }
        for (column, &node) in nodes.iter().enumerate() {
            self.lower[column * self.width + column] = matrix.diagonal[node];
        }
        for entry in entries {
            let (place, pair) = (entry.place as usize, entry.pair as usize);
            let below = matrix.lower[pair];
            let (lower, upper) = match (symmetric, entry.is_transposed) {
                (true, false) => (below, None),
                (true, true) => (below.transposed(), None),
                (false, false) => (below, Some(matrix.upper[pair])),
                (false, true) => (matrix.upper[pair].transposed(), Some(below.transposed())),
            };
            self.lower[place] = lower;
            if let Some(upper) = upper {
                self.upper[place] = upper;
            }
        }
    }

    /// Subtracts the updates from earlier panels: L_r U_cᵀ of every panel with a row c among the
    /// columns of this one.
    #[inline(always)]
    pub(super) fn update(
        &mut self,
        earlier: &Earlier,
        updates: &[Update],
        local_rows: &[u32],
        symmetric: bool,
    ) {
        for update in updates {
            let supernode = &earlier.supernodes.list[update.source];
            let width = supernode.width();
            let first = supernode.first_block - earlier.first_block;
            let below = first + width * width..first + width * supernode.height();
            let (own, other) = (&earlier.lower[below.clone()], &earlier.upper[below]);
            let of_lower = Source {
                own,
                other,
                width,
                rows: &earlier.supernodes.rows[supernode.rows.clone()],
                local_rows,
            };
            let rows = of_lower.rows_between(update, self.first, self.first + self.count());
            let place = (self.width, self.first);
            of_lower.subtract_from(self.lower, place, update, rows.clone(), 0);
            if !symmetric {
                let of_upper = Source {
                    own: other,
                    other: own,
                    ..of_lower
                };
                of_upper.subtract_from(self.upper, place, update, rows, 1);
            }
        }
    }

    /// Eliminates the columns of the panel from each other in its first rows, which are the rows
    /// of these columns.
    #[inline(always)]
    pub(super) fn factor_square(
        &mut self,
        nodes: &[usize],
        diagonal: &mut [DiagonalFactor],
        symmetric: bool,
        inertia: &mut Inertia,
    ) -> Result<(), SingularMatrix> {
        let width = self.width;
        for column in 0..width {
            subtract_columns_before(self.lower, self.upper, column, width, column);
            if !symmetric {
                subtract_columns_before(self.upper, self.lower, column, width, column + 1);
            }
            let pivot = &mut self.lower[column * width + column];
            let unknown = NODE * nodes[column];
            if symmetric {
                // Rounding makes the two triangles differ, while the blocks beside this one are
                // held once only. If not removed, the difference E would propagate to later pivots
                // as L E Lᵀ, which grows from node to node of a chain.
                pivot.mirror_lower_triangle();
                for (row, &pivot) in symmetric_pivots(pivot).iter().enumerate() {
                    inertia.count(pivot, unknown + row)?;
                }
            }
            let factor = DiagonalFactor::new(pivot).map_err(|(row, pivot)| SingularMatrix {
                unknown: unknown + row,
                pivot,
            })?;
            diagonal[column] = factor;
            for row in column + 1..width {
                let place = row * width + column;
                if symmetric {
                    self.upper[place] = self.lower[place];
                }
                self.lower[place] = factor.divide(&self.lower[place]);
            }
        }
        Ok(())
    }

    /// Eliminates the columns of the panel from the rows below them; `square` holds the first
    /// rows.
    #[inline(always)]
    pub(super) fn divide(&mut self, square: &Rows, diagonal: &[DiagonalFactor], symmetric: bool) {
        let width = self.width;
        let lower = self.lower.chunks_mut(2 * width);
        for (lower, upper) in lower.zip(self.upper.chunks_mut(2 * width)) {
            for column in 0..width {
                subtract_columns_before_in_two(lower, square.upper, column, width);
                if !symmetric {
                    subtract_columns_before_in_two(upper, square.lower, column, width);
                }
                for place in (column..lower.len()).step_by(width) {
                    if symmetric {
                        upper[place] = lower[place];
                    }
                    lower[place] = diagonal[column].divide(&lower[place]);
                }
            }
        }
    }
}

impl Source<'_> {
    /// The rows, from the first of the update on, that are between two rows of the current panel.
    #[inline(always)]
    fn rows_between(&self, update: &Update, first: usize, end: usize) -> Range<usize> {
        let from_update = &self.rows[update.rows.start..];
        let before = |bound: usize| {
            update.rows.start
                + from_update
                    .partition_point(|row| (self.local_rows[*row as usize] as usize) < bound)
        };
        let start = if first == 0 {
            update.rows.start
        } else {
            before(first)
        };
        start..before(end)
    }

    /// Subtracts X_r Y_cᵀ from blocks (r, c) of a panel of `width` columns whose first row is
    /// `first`. c runs over the columns of the update, r over the rows from c on, or after c if
    /// `skip` is 1.
    #[inline(always)]
    fn subtract_from(
        &self,
        panel: &mut [Block],
        (width, first): (usize, usize),
        update: &Update,
        rows: Range<usize>,
        skip: usize,
    ) {
        let local = |row: usize| self.local_rows[self.rows[row] as usize] as usize;
        for column in update.rows.clone() {
            let target = local(column);
            let y = &self.other[column * self.width..(column + 1) * self.width];
            let start = (column + skip).max(rows.start);
            if start >= rows.end {
                break;
            }
            let x = self.own[start * self.width..rows.end * self.width].chunks(2 * self.width);
            for (row, x) in (start..).step_by(2).zip(x) {
                let place = (local(row) - first) * width + target;
                if x.len() == 2 * self.width {
                    let (x0, x1) = x.split_at(self.width);
                    let [p0, p1] = product([x0, x1], y);
                    panel[place].subtract(&p0);
                    panel[(local(row + 1) - first) * width + target].subtract(&p1);
                } else {
                    let [p0] = product([x], y);
                    panel[place].subtract(&p0);
                }
            }
        }
    }
}

/// Subtracts X_r Y_cᵀ, summed over the columns before `column`, from the blocks of `column`, from
/// row `first` on.
#[inline(always)]
fn subtract_columns_before(
    own: &mut [Block],
    other: &[Block],
    column: usize,
    width: usize,
    first: usize,
) {
    for rows in own[first * width..].chunks_mut(2 * width) {
        subtract_columns_before_in_two(rows, other, column, width);
    }
}

/// Subtracts the columns before `column` from one row or two rows.
#[inline(always)]
fn subtract_columns_before_in_two(
    rows: &mut [Block],
    other: &[Block],
    column: usize,
    width: usize,
) {
    if column == 0 {
        return;
    }
    let y = &other[column * width..column * width + column];
    if rows.len() == 2 * width {
        let (x0, x1) = rows.split_at_mut(width);
        let [p0, p1] = product([&x0[..column], &x1[..column]], y);
        x0[column].subtract(&p0);
        x1[column].subtract(&p1);
    } else {
        let [p0] = product([&rows[..column]], y);
        rows[column].subtract(&p0);
    }
}
