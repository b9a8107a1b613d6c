//! Inverse of a small dense matrix, laid out for fast products.
//!
//! An explicit inverse instead of LU factors: the matrices here are well conditioned (30 to 120), and a
//! product has none of the sequential dependence of two triangular solves.

use super::instruction_set::{InstructionSet, LANES, Lanes, kernel};

/// The inverse of a square matrix.
pub(super) struct DenseInverse {
    set: InstructionSet,
    order: usize,
    /// Panels of eight rows; inside a panel column after column.
    panels: Vec<Lanes>,
    /// Row-major matrix under inversion, rows padded to whole lanes, and the row swapped at each pivot.
    matrix: Vec<f64>,
    swaps: Vec<usize>,
}

impl DenseInverse {
    /// Room for a matrix of `order` rows and columns; the inverse is zero at first.
    pub fn new(order: usize, set: InstructionSet) -> Self {
        let panels = order.div_ceil(LANES);
        Self {
            set,
            order,
            panels: vec![[0.0; LANES]; panels * order],
            matrix: vec![0.0; order * panels * LANES],
            swaps: vec![0; order],
        }
    }

    /// Inverts the matrix with the given entries (row, column). Returns whether that worked; where the
    /// matrix is singular or not finite the inverse is left as it was.
    pub fn invert(&mut self, entry: impl Fn(usize, usize) -> f64) -> bool {
        let (order, stride) = (self.order, self.order.div_ceil(LANES) * LANES);
        for i in 0..order {
            for j in 0..order {
                self.matrix[i * stride + j] = entry(i, j);
            }
        }
        if !invert_in_place(self.set, &mut self.matrix, stride, &mut self.swaps) {
            return false;
        }
        for (k, panel) in self.panels.chunks_exact_mut(order).enumerate() {
            for lane in 0..LANES.min(order - k * LANES) {
                let row = &self.matrix[(k * LANES + lane) * stride..][..order];
                for (column, &value) in panel.iter_mut().zip(row) {
                    column[lane] = value;
                }
            }
        }
        true
    }

    /// `y` = A⁻¹ `x`.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        multiply_panels(self.set, &self.panels, x, y);
    }
}

kernel! {
    /// Gauss–Jordan elimination with partial pivoting in rows of `stride` numbers; `swaps` is scratch.
    /// Returns whether every pivot was a normal number.
    fn invert_in_place(matrix: &mut [f64], stride: usize, swaps: &mut [usize]) -> bool {
        let order = swaps.len();
        for k in 0..order {
            let mut pivot = k;
            for i in k + 1..order {
                if matrix[i * stride + k].abs() > matrix[pivot * stride + k].abs() {
                    pivot = i;
                }
            }
            swaps[k] = pivot;
            if !matrix[pivot * stride + k].is_normal() {
                return false;
            }
            let (above, rest) = matrix.split_at_mut(k * stride);
            let (row, below) = rest.split_at_mut(stride);
            if pivot > k {
                row.swap_with_slice(&mut below[(pivot - k - 1) * stride..][..stride]);
            }
            let inverse = 1.0 / row[k];
            row[k] = 1.0;
            for value in row.iter_mut() {
                *value *= inverse;
            }
            for other in above.chunks_exact_mut(stride).chain(below.chunks_exact_mut(stride)) {
                let factor = -other[k];
                other[k] = 0.0;
                for (value, &pivot) in other.iter_mut().zip(&*row) {
                    *value = factor.mul_add(pivot, *value);
                }
            }
        }
        for row in matrix.chunks_exact_mut(stride) {
            for k in (0..order).rev() {
                row.swap(k, swaps[k]);
            }
        }
        true
    }
}

kernel! {
    /// Product of a matrix in panels with `x`. Four partial sums per row hide the latency of addition.
    fn multiply_panels(panels: &[Lanes], x: &[f64], y: &mut [f64]) {
        for (panel, y) in panels.chunks_exact(x.len()).zip(y.chunks_mut(LANES)) {
            let mut sums = [[0.0; LANES]; 4];
            let columns = panel.chunks_exact(4);
            let values = x.chunks_exact(4);
            for (column, &value) in columns.remainder().iter().zip(values.remainder()) {
                for l in 0..LANES {
                    sums[0][l] = column[l].mul_add(value, sums[0][l]);
                }
            }
            for (column, value) in columns.zip(values) {
                for k in 0..4 {
                    for l in 0..LANES {
                        sums[k][l] = column[k][l].mul_add(value[k], sums[k][l]);
                    }
                }
            }
            let mut total = [0.0; LANES];
            for l in 0..LANES {
                total[l] = (sums[0][l] + sums[1][l]) + (sums[2][l] + sums[3][l]);
            }
            y.copy_from_slice(&total[..y.len()]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(i: usize, j: usize) -> f64 {
        // No leading minor is well conditioned, so that pivoting matters.
        let i = i as f64;
        let j = j as f64;
        (1.3 * i * j + 0.7 * i - 0.2 * j).sin()
    }

    #[test]
    fn inverse_times_matrix_is_the_identity() {
        for order in [1, 3, 8, 30, 67] {
            for set in InstructionSet::available() {
                let mut inverse = DenseInverse::new(order, set);
                assert!(inverse.invert(|i, j| entry(i + 1, j + 2)));
                let mut column = vec![0.0; order];
                let mut unit = vec![0.0; order];
                for j in 0..order {
                    for i in 0..order {
                        column[i] = entry(i + 1, j + 2);
                    }
                    inverse.multiply(&column, &mut unit);
                    for (i, value) in unit.iter().enumerate() {
                        let expected = if i == j { 1.0 } else { 0.0 };
                        assert!((value - expected).abs() < 1e-10, "{order}: {i} {j} {value}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let mut inverse = DenseInverse::new(4, InstructionSet::best());
        assert!(!inverse.invert(|i, _| i as f64));
        assert!(!inverse.invert(|_, _| f64::NAN));
    }
}
