//! Symmetric band matrices of half bandwidth 10 and their LDLᵀ factorisation (Golub & Van Loan,
//! Matrix Computations, 4th ed., sec. 4.3.5; no pivoting, so that the band does not fill).

use super::error::{Inertia, SingularMatrix};
use super::in_parts::{Span, in_chunks, in_parts};
use std::ops::Range;

/// Largest distance between coupled unknowns: a vertex couples x, θ, x, θ, x of three nodes, 11 unknowns.
pub const HALF_BANDWIDTH: usize = 10;

/// Entries stored per column: the diagonal and the band below it.
const WIDTH: usize = HALF_BANDWIDTH + 1;

/// One column of the lower band: entry r is row j + r of column j.
type Column = [f64; WIDTH];

/// The lower band of a symmetric matrix, column by column: entry (i, j), j ≤ i ≤ j + 10, is
/// `columns()[j][i - j]`. Entries of the last columns that would lie below the matrix stay zero.
#[derive(Clone, Debug)]
pub struct BandedSymmetric {
    columns: Vec<Column>,
}

impl BandedSymmetric {
    /// The zero matrix of the given dimension.
    pub fn new(dimension: usize) -> Self {
        Self {
            columns: vec![[0.0; WIDTH]; dimension],
        }
    }

    /// Number of rows.
    pub(crate) fn dimension(&self) -> usize {
        self.columns.len()
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        in_chunks(&mut self.columns, &|_, own| own.fill([0.0; WIDTH]));
    }

    /// Adds `value` to entry (i, j) of the lower triangle, j ≤ i ≤ j + 10.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        debug_assert!(j <= i && i - j <= HALF_BANDWIDTH && i < self.dimension());
        self.columns[j][i - j] += value;
    }

    /// Entry (i, j) of either triangle; zero outside the band.
    pub(crate) fn get(&self, i: usize, j: usize) -> f64 {
        let (row, column) = (i.max(j), i.min(j));
        self.columns[column]
            .get(row - column)
            .copied()
            .unwrap_or(0.0)
    }

    /// The columns of the lower band.
    #[inline]
    pub(crate) fn columns(&self) -> &[[f64; HALF_BANDWIDTH + 1]] {
        &self.columns
    }

    /// The columns of the lower band, for adding entries. Entries below the last row must stay
    /// zero.
    #[inline]
    pub(crate) fn columns_mut(&mut self) -> &mut [[f64; HALF_BANDWIDTH + 1]] {
        &mut self.columns
    }

    /// Eliminates held unknowns that follow each other: their rows and columns become zero, their
    /// diagonals one.
    pub fn hold(&mut self, unknowns: Range<usize>) {
        let before = unknowns.start.saturating_sub(HALF_BANDWIDTH)..unknowns.start;
        for (j, column) in before.clone().zip(&mut self.columns[before]) {
            let end = WIDTH.min(unknowns.end - j);
            column[unknowns.start - j..end].fill(0.0);
        }
        let mut held = [0.0; WIDTH];
        held[0] = 1.0;
        self.columns[unknowns].fill(held);
    }

    /// y = A x.
    pub(crate) fn multiply(&self, x: &[f64], y: &mut [f64]) {
        let n = self.dimension();
        assert!(x.len() == n && y.len() == n);
        y.fill(0.0);
        for (j, column) in self.columns.iter().enumerate() {
            let below = HALF_BANDWIDTH.min(n - 1 - j);
            let mut row = column[0] * x[j];
            for r in 1..=below {
                y[j + r] += column[r] * x[j];
                row += column[r] * x[j + r];
            }
            y[j] += row;
        }
    }
}

/// Least number of unknowns of a part that is factored in parallel with others: waking a thread
/// takes as long as a hundred columns.
const LEAST_PART: usize = 2000;

/// The factors of A = L D Lᵀ, with L unit lower triangular and D diagonal, not necessarily positive.
#[derive(Clone, Debug)]
pub struct BandedFactor {
    /// Columns of L below the diagonal, and 1/D on it.
    columns: Vec<Column>,
    /// Unknowns that are coupled with no other.
    parts: Vec<Range<usize>>,
}

impl BandedFactor {
    /// Storage for the factors of a matrix of the given dimension.
    pub fn new(dimension: usize) -> Self {
        Self::of_chains(dimension, std::iter::once(0..dimension))
    }

    /// Storage for the factors of a matrix whose chains, consecutive unknowns, are not coupled with
    /// each other. Large parts are factored in parallel.
    pub(crate) fn of_chains(dimension: usize, chains: impl Iterator<Item = Range<usize>>) -> Self {
        Self {
            columns: vec![[0.0; WIDTH]; dimension],
            parts: Self::parts_of(chains),
        }
    }

    /// Unites chains that follow each other to parts that are factored together.
    pub(crate) fn parts_of(chains: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
        let mut parts: Vec<Range<usize>> = Vec::new();
        for chain in chains {
            match parts.last_mut() {
                Some(last) if last.end == chain.start && last.len() < LEAST_PART => {
                    last.end = chain.end;
                }
                _ => parts.push(chain),
            }
        }
        parts
    }

    /// Factors `matrix` and reports the signs of the pivots.
    ///
    /// # Errors
    /// A pivot that is zero or not finite. Small pivots are not errors: `Inertia` holds their size.
    pub fn factor(&mut self, matrix: &BandedSymmetric) -> Result<Inertia, SingularMatrix> {
        let parts = std::mem::take(&mut self.parts);
        let inertia = self.factor_parts(matrix, &parts);
        self.parts = parts;
        inertia
    }

    /// Factors parts of `matrix` that are coupled with no other unknowns, in their order.
    ///
    /// # Errors
    /// A pivot that is zero or not finite.
    pub(crate) fn factor_parts(
        &mut self,
        matrix: &BandedSymmetric,
        parts: &[Range<usize>],
    ) -> Result<Inertia, SingularMatrix> {
        assert_eq!(matrix.dimension(), self.columns.len());
        if parts.is_empty() {
            return Ok(Inertia::EMPTY);
        }
        in_parts(
            parts,
            Span::all(&mut self.columns),
            &|columns, part| columns.cut(part.start),
            &|part, mut columns| {
                factor_part(part.start, columns.of(part), &matrix.columns[part.clone()])
            },
            &|one, other| Ok(one?.and(other?)),
        )
    }

    /// Solves A x = b in place.
    pub fn solve(&self, right_hand_side: &mut [f64]) {
        self.solve_parts(right_hand_side, &self.parts);
    }

    /// Solves A x = b in place for the unknowns of parts that were factored.
    pub(crate) fn solve_parts(&self, right_hand_side: &mut [f64], parts: &[Range<usize>]) {
        assert_eq!(right_hand_side.len(), self.columns.len());
        if parts.is_empty() {
            return;
        }
        in_parts(
            parts,
            Span::all(right_hand_side),
            &|entries, part| entries.cut(part.start),
            &|part, mut entries| solve_part(&self.columns[part.clone()], entries.of(part)),
            &|(), ()| (),
        );
    }

    /// Solves A X = B in place for the unknowns from `first` on, one per row given. These must not
    /// be coupled to unknowns before or after them. Solves for four right-hand sides at once; some
    /// may be zero.
    pub(crate) fn solve_part(&self, first: usize, rows: &mut [[f64; 4]]) {
        let columns = &self.columns[first..first + rows.len()];
        for i in 0..rows.len() {
            let known = rows[i];
            for (factor, row) in columns[i][1..].iter().zip(&mut rows[i + 1..]) {
                for (entry, known) in row.iter_mut().zip(known) {
                    *entry -= factor * known;
                }
            }
        }
        for j in (0..rows.len()).rev() {
            let mut sum = rows[j].map(|entry| entry * columns[j][0]);
            for (factor, row) in columns[j][1..].iter().zip(&rows[j + 1..]) {
                for (entry, known) in sum.iter_mut().zip(row) {
                    *entry -= factor * known;
                }
            }
            rows[j] = sum;
        }
    }
}

/// Factors a part of a matrix, which begins at the unknown `first`, into `columns`.
fn factor_part(
    first: usize,
    columns: &mut [Column],
    matrix: &[Column],
) -> Result<Inertia, SingularMatrix> {
    columns.copy_from_slice(matrix);
    let mut inertia = Inertia::EMPTY;
    let last = columns.len().saturating_sub(HALF_BANDWIDTH);
    eliminate_columns(first, columns, &mut inertia)?;
    // Zeros follow the last columns, so that their update needs no bounds checks.
    let mut padded = [[0.0; WIDTH]; 2 * HALF_BANDWIDTH];
    let rest = &mut columns[last..];
    padded[..rest.len()].copy_from_slice(rest);
    let all = &mut padded[..rest.len() + HALF_BANDWIDTH];
    eliminate_columns(first + last, all, &mut inertia)?;
    rest.copy_from_slice(&padded[..rest.len()]);
    Ok(inertia)
}

/// Eliminates all columns but the last ten.
fn eliminate_columns(
    first: usize,
    columns: &mut [Column],
    inertia: &mut Inertia,
) -> Result<(), SingularMatrix> {
    for j in 0..columns.len().saturating_sub(HALF_BANDWIDTH) {
        let (column, following) = columns[j..=j + HALF_BANDWIDTH]
            .split_first_mut()
            .expect("a column and ten others");
        let following: &mut [Column; HALF_BANDWIDTH] =
            following.try_into().expect("ten columns follow");
        inertia.count(column[0], first + j)?;
        eliminate(column, following);
    }
    Ok(())
}

/// Solves A x = b in place with the columns of a part.
fn solve_part(columns: &[Column], x: &mut [f64]) {
    let n = x.len();
    // Forward substitution: registers hold the next ten unknowns, minus the contributions of
    // those already found.
    let mut next = [0.0; HALF_BANDWIDTH];
    for (next, &value) in next.iter_mut().zip(&*x) {
        *next = value;
    }
    for i in 0..n {
        let (column, known) = (&columns[i], next[0]);
        x[i] = known;
        let far = i + HALF_BANDWIDTH;
        let last = if far < n { x[far] } else { 0.0 };
        for r in 1..HALF_BANDWIDTH {
            next[r - 1] = next[r] - column[r] * known;
        }
        next[HALF_BANDWIDTH - 1] = last - column[HALF_BANDWIDTH] * known;
    }
    // Backward substitution: registers hold the last ten unknowns found. The sum subtracts the
    // nearest of them last, so that only this term waits for it.
    let mut found = [0.0; HALF_BANDWIDTH];
    for j in (0..n).rev() {
        let column = &columns[j];
        let mut sum = x[j] * column[0];
        for r in (1..WIDTH).rev() {
            sum -= column[r] * found[r - 1];
        }
        x[j] = sum;
        for r in (1..HALF_BANDWIDTH).rev() {
            found[r] = found[r - 1];
        }
        found[0] = sum;
    }
}

/// One step of elimination: turns `column` into a column of L with 1/D on top and subtracts its outer
/// product from the ten columns that follow.
#[inline(always)]
fn eliminate(column: &mut Column, following: &mut [Column; HALF_BANDWIDTH]) {
    let inverse_pivot = 1.0 / column[0];
    let unscaled = *column;
    for r in 1..WIDTH {
        column[r] = unscaled[r] * inverse_pivot;
    }
    column[0] = inverse_pivot;
    for k in 1..WIDTH {
        let factor = column[k];
        let target = &mut following[k - 1];
        for r in k..WIDTH {
            target[r - k] -= factor * unscaled[r];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn dense(matrix: &BandedSymmetric) -> DMatrix<f64> {
        let n = matrix.dimension();
        DMatrix::from_fn(n, n, |i, j| matrix.get(i, j))
    }

    /// A band with the given entries, made diagonally dominant; `signs` picks the signs of the diagonal.
    fn dominant_band(
        n: usize,
        entries: &[f64],
        negative: impl Fn(usize) -> bool,
    ) -> BandedSymmetric {
        let mut matrix = BandedSymmetric::new(n);
        let mut values = entries.iter().cycle();
        for j in 0..n {
            for i in j + 1..n.min(j + WIDTH) {
                matrix.add(i, j, *values.next().unwrap());
            }
            let diagonal = 22.0 + *values.next().unwrap();
            matrix.add(j, j, if negative(j) { -diagonal } else { diagonal });
        }
        matrix
    }

    proptest! {
        #[test]
        fn solves_indefinite_bands(
            n in 1usize..60,
            entries in prop::collection::vec(-1.0..1.0f64, 97),
            period in 1usize..7,
        ) {
            let matrix = dominant_band(n, &entries, |j| j % period == 2);
            let mut factor = BandedFactor::new(n);
            let inertia = factor.factor(&matrix).unwrap();
            let solution: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
            let mut x = vec![0.0; n];
            matrix.multiply(&solution, &mut x);
            factor.solve(&mut x);
            for i in 0..n {
                prop_assert!((x[i] - solution[i]).abs() < 1e-13);
            }
            let eigenvalues = dense(&matrix).symmetric_eigenvalues();
            let negative = eigenvalues.iter().filter(|&&value| value < 0.0).count();
            prop_assert_eq!(inertia.negative, negative);
            prop_assert_eq!(inertia.positive, n - negative);
        }

        #[test]
        fn multiplies_as_the_dense_matrix(n in 1usize..40, entries in prop::collection::vec(-1.0..1.0f64, 89)) {
            let matrix = dominant_band(n, &entries, |_| false);
            let x = DVector::from_fn(n, |i, _| (i as f64).cos());
            let mut y = vec![0.0; n];
            matrix.multiply(x.as_slice(), &mut y);
            let expected = dense(&matrix) * &x;
            for i in 0..n {
                prop_assert!((y[i] - expected[i]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_part_that_couples_to_no_other_is_solved_alone() {
        let (sizes, n) = ([23, 4, 31], 58);
        let mut matrix = BandedSymmetric::new(n);
        let mut first = 0;
        for size in sizes {
            let part = dominant_band(size, &[0.3, -0.8, 0.5, 0.1], |j| j == 2);
            matrix.columns_mut()[first..first + size].copy_from_slice(part.columns());
            first += size;
        }
        let mut factor = BandedFactor::new(n);
        factor.factor(&matrix).unwrap();
        first = 0;
        for size in sizes {
            let of_row = |row: usize| std::array::from_fn(|side| ((7 * row + side) as f64).sin());
            let mut rows: Vec<[f64; 4]> = (0..size).map(of_row).collect();
            factor.solve_part(first, &mut rows);
            for side in 0..4 {
                let mut x = vec![0.0; n];
                for row in 0..size {
                    x[first + row] = of_row(row)[side];
                }
                factor.solve(&mut x);
                for row in 0..size {
                    assert!((rows[row][side] - x[first + row]).abs() < 1e-14);
                }
            }
            first += size;
        }
    }

    #[test]
    fn a_held_unknown_solves_to_its_right_hand_side_and_moves_nobody() {
        let n = 30;
        let mut matrix = dominant_band(n, &[0.3, -0.8, 0.5], |_| false);
        let free = dense(&matrix).remove_row(13).remove_column(13);
        matrix.hold(13..14);
        let mut factor = BandedFactor::new(n);
        factor.factor(&matrix).unwrap();
        let mut x = vec![1.0; n];
        x[13] = 5.0;
        factor.solve(&mut x);
        assert_eq!(x[13], 5.0);
        let expected = free.lu().solve(&DVector::from_element(n - 1, 1.0)).unwrap();
        for i in 0..n - 1 {
            let own = x[if i < 13 { i } else { i + 1 }];
            assert!((own - expected[i]).abs() < 1e-14);
        }
    }

    #[test]
    fn a_floating_chain_is_singular_at_its_last_unknown() {
        let n = 12;
        let mut matrix = BandedSymmetric::new(n);
        for i in 0..n - 1 {
            matrix.add(i, i, 1.0);
            matrix.add(i + 1, i + 1, 1.0);
            matrix.add(i + 1, i, -1.0);
        }
        let error = BandedFactor::new(n).factor(&matrix).unwrap_err();
        assert_eq!(
            error,
            SingularMatrix {
                unknown: 11,
                pivot: 0.0
            }
        );
    }

    #[test]
    fn an_entry_that_is_not_a_number_is_an_error() {
        let mut matrix = dominant_band(20, &[0.1], |_| false);
        matrix.add(9, 7, f64::NAN);
        let error = BandedFactor::new(20).factor(&matrix).unwrap_err();
        assert_eq!(error.unknown, 9);
    }
}
