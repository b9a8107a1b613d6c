//! The elimination of panels in order. Branches of the elimination tree run in parallel; then the
//! panels of the trunk follow one after the other, and the rows of each run in parallel.

use super::branches::Branch;
use super::error::{Inertia, SingularMatrix};
use super::instruction_set::{InstructionSet, kernel};
use super::node_block::{Block, BlockMatrix, DiagonalFactor};
use super::panel::{Earlier, Rows};
use super::symbolic::{Entry, SymbolicFactor, Update};

/// Products of blocks below which a task is not worth a thread.
pub(super) const SMALLEST_TASK: usize = 20_000;

/// Consecutive panels that no other panels change.
pub(super) struct Part<'a> {
    pub(super) set: InstructionSet,
    pub(super) matrix: &'a BlockMatrix<'a>,
    pub(super) symbolic: &'a SymbolicFactor,
    pub(super) symmetric: bool,
    /// The first block and column of it.
    pub(super) first_block: usize,
    pub(super) first_column: usize,
    pub(super) diagonal: &'a mut [DiagonalFactor],
    pub(super) lower: &'a mut [Block],
    pub(super) upper: &'a mut [Block],
}

impl<'a> Part<'a> {
    pub(super) fn reborrow(&mut self) -> Part<'_> {
        Part {
            diagonal: self.diagonal,
            lower: self.lower,
            upper: self.upper,
            ..*self
        }
    }

    /// Splits the panels into those before a branch and those from it on.
    fn split(self, branch: &Branch) -> (Self, Self) {
        let first = &self.symbolic.supernodes.list[branch.supernodes.start];
        let (lower, lower_after) = self
            .lower
            .split_at_mut(first.first_block - self.first_block);
        let (upper, upper_after) = self
            .upper
            .split_at_mut(first.first_block - self.first_block);
        let (diagonal, diagonal_after) =
            (self.diagonal).split_at_mut(first.columns.start - self.first_column);
        let after = Self {
            first_block: first.first_block,
            first_column: first.columns.start,
            diagonal: diagonal_after,
            lower: lower_after,
            upper: upper_after,
            ..self
        };
        let before = Self {
            diagonal,
            lower,
            upper,
            ..self
        };
        (before, after)
    }

    /// Factors branches in parallel. Returns the error of the first branch that has any.
    pub(super) fn eliminate_branches(
        mut self,
        branches: &[Branch],
        local_rows: &mut [Vec<u32>],
    ) -> Result<Inertia, SingularMatrix> {
        match branches {
            [] => Ok(Inertia::EMPTY),
            [branch] => {
                let mut inertia = Inertia::EMPTY;
                for supernode in branch.supernodes.clone() {
                    self.eliminate_panel(supernode, &mut local_rows[0], usize::MAX, &mut inertia)?;
                }
                Ok(inertia)
            }
            _ => {
                let middle = branches.len() / 2;
                let (one, other) = branches.split_at(middle);
                let (part_of_one, part_of_other) = self.split(&other[0]);
                let (rows_of_one, rows_of_other) = local_rows.split_at_mut(middle);
                let (one, other) = rayon::join(
                    || part_of_one.eliminate_branches(one, rows_of_one),
                    || part_of_other.eliminate_branches(other, rows_of_other),
                );
                Ok(one?.and(other?))
            }
        }
    }

    /// Loads a panel, subtracts the updates from the panels before it, and factors it. Processes
    /// its rows in parallel if their products exceed `smallest_task`.
    pub(super) fn eliminate_panel(
        &mut self,
        index: usize,
        local_rows: &mut [u32],
        smallest_task: usize,
        inertia: &mut Inertia,
    ) -> Result<(), SingularMatrix> {
        let (symbolic, set, symmetric) = (self.symbolic, self.set, self.symmetric);
        let supernode = &symbolic.supernodes.list[index];
        let below = symbolic.supernodes.rows[supernode.rows.clone()].iter();
        let columns = supernode.columns.clone();
        for (local, row) in columns.chain(below.map(|row| *row as usize)).enumerate() {
            local_rows[row] = local as u32;
        }
        let local_rows = &*local_rows;
        // Storage is in the order of panels: those before this one come first.
        let start = supernode.first_block - self.first_block;
        let (lower_before, lower) = self.lower.split_at_mut(start);
        let (upper_before, upper) = self.upper.split_at_mut(start);
        let earlier = Earlier {
            supernodes: &symbolic.supernodes,
            first_block: self.first_block,
            lower: lower_before,
            upper: upper_before,
        };
        let blocks = supernode.width() * supernode.height();
        let mut all = Rows {
            lower: &mut lower[..blocks],
            upper: &mut upper[..blocks],
            width: supernode.width(),
            first: 0,
        };
        let nodes = &symbolic.order[supernode.columns.clone()];
        let entries = symbolic.entries(index);
        load_rows(set, &mut all, self.matrix, nodes, entries, symmetric);
        let per_row = symbolic.products[index] / supernode.height();
        let most = (smallest_task / per_row.max(1)).max(8);
        let updates = symbolic.updates(index);
        side_by_side(all.reborrow(), most, &|mut rows| {
            update_rows(set, &mut rows, &earlier, updates, local_rows, symmetric);
        });
        let (mut square, below) = all.split(supernode.width());
        let first = supernode.columns.start - self.first_column;
        let diagonal = &mut self.diagonal[first..first + supernode.width()];
        factor_square(set, &mut square, nodes, diagonal, symmetric, inertia)?;
        let (square, diagonal) = (&square, &*diagonal);
        side_by_side(below, most, &|mut rows| {
            divide_rows(set, &mut rows, square, diagonal, symmetric);
        });
        Ok(())
    }
}

/// Calls `work` in parallel on groups of at most `most` rows.
fn side_by_side(rows: Rows, most: usize, work: &(impl Fn(Rows) + Sync)) {
    if rows.count() <= most {
        return work(rows);
    }
    let half = rows.count() / 2;
    let (before, after) = rows.split(half);
    rayon::join(
        || side_by_side(before, most, work),
        || side_by_side(after, most, work),
    );
}

kernel! {
    /// [`Rows::load`].
    fn load_rows(
        rows: &mut Rows,
        matrix: &BlockMatrix,
        nodes: &[usize],
        entries: &[Entry],
        symmetric: bool,
    ) {
        rows.load(matrix, nodes, entries, symmetric);
    }
}

kernel! {
    /// [`Rows::update`].
    fn update_rows(
        rows: &mut Rows,
        earlier: &Earlier,
        updates: &[Update],
        local_rows: &[u32],
        symmetric: bool,
    ) {
        rows.update(earlier, updates, local_rows, symmetric);
    }
}

kernel! {
    /// [`Rows::factor_square`].
    fn factor_square(
        rows: &mut Rows,
        nodes: &[usize],
        diagonal: &mut [DiagonalFactor],
        symmetric: bool,
        inertia: &mut Inertia,
    ) -> Result<(), SingularMatrix> {
        rows.factor_square(nodes, diagonal, symmetric, inertia)
    }
}

kernel! {
    /// [`Rows::divide`].
    fn divide_rows(
        rows: &mut Rows,
        square: &Rows,
        diagonal: &[DiagonalFactor],
        symmetric: bool,
    ) {
        rows.divide(square, diagonal, symmetric);
    }
}
