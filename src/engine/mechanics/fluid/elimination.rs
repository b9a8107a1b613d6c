//! Gaussian elimination for the small dense systems of the preconditioner.

use crate::linalg::instruction_set::kernel;

kernel! {
    /// Solves M X = B by Gaussian elimination with partial pivoting.
    ///
    /// `rows` holds the rows of [M B] one after the other, `order` + `columns` numbers each. X overwrites
    /// B. Returns whether every pivot was a normal number; if not, `rows` is unspecified.
    fn eliminate(rows: &mut [f64], order: usize, columns: usize) -> bool {
        let stride = order + columns;
        for k in 0..order {
            let mut pivot = k;
            for i in k + 1..order {
                if rows[i * stride + k].abs() > rows[pivot * stride + k].abs() {
                    pivot = i;
                }
            }
            if !rows[pivot * stride + k].is_normal() {
                return false;
            }
            let (above, below) = rows.split_at_mut((k + 1) * stride);
            let row = &mut above[k * stride + k..];
            if pivot > k {
                let other = (pivot - k - 1) * stride + k;
                row.swap_with_slice(&mut below[other..other + stride - k]);
            }
            let inverse = 1.0 / row[0];
            for other in below.chunks_exact_mut(stride) {
                let factor = -other[k] * inverse;
                for (value, &pivot) in other[k + 1..].iter_mut().zip(&row[1..]) {
                    *value = factor.mul_add(pivot, *value);
                }
            }
        }
        for k in (0..order).rev() {
            let (above, row) = rows.split_at_mut(k * stride);
            let inverse = 1.0 / row[k];
            let solution = &mut row[order..stride];
            for value in solution.iter_mut() {
                *value *= inverse;
            }
            for other in above.chunks_exact_mut(stride) {
                let factor = -other[k];
                for (value, &known) in other[order..].iter_mut().zip(&*solution) {
                    *value = factor.mul_add(known, *value);
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::instruction_set::InstructionSet;

    /// An unsymmetric matrix whose leading entries vanish, so that pivoting matters.
    fn entry(i: usize, j: usize) -> f64 {
        if i == j {
            return 0.0;
        }
        let (i, j) = (i as f64, j as f64);
        (1.3 * i * j + 0.7 * i - 0.2 * j).sin()
    }

    #[test]
    fn recovers_known_solutions() {
        let columns = 5;
        for order in [2, 3, 8, 30, 67] {
            for set in InstructionSet::available() {
                let solution = |i: usize, c: usize| (i as f64 - 2.0 * c as f64).cos();
                let mut rows = Vec::new();
                for i in 0..order {
                    rows.extend((0..order).map(|j| entry(i, j)));
                    rows.extend((0..columns).map(|c| {
                        (0..order)
                            .map(|j| entry(i, j) * solution(j, c))
                            .sum::<f64>()
                    }));
                }
                assert!(eliminate(set, &mut rows, order, columns));
                for i in 0..order {
                    for c in 0..columns {
                        let error = rows[i * (order + columns) + order + c] - solution(i, c);
                        assert!(error.abs() < 1e-10, "order {order}: {error:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let set = InstructionSet::best();
        assert!(!eliminate(set, &mut [1.0, 2.0, 1.0, 2.0, 4.0, 1.0], 2, 1));
        assert!(!eliminate(set, &mut [f64::NAN, 1.0], 1, 1));
    }
}
