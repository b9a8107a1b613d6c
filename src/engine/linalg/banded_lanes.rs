//! [`LANES`] symmetric band matrices of one size at a time: the factorisation of [`super::banded`] lane by lane, with the same
//! operations in the same order, so that every lane gets the bytes that it would get alone.

use super::banded::HALF_BANDWIDTH;
use super::instruction_set::{InstructionSet, LANES, Lanes, kernel};

/// Entries stored per column: the diagonal and the band below it.
const WIDTH: usize = HALF_BANDWIDTH + 1;

/// One column of the lower bands: entry r is row j + r of column j.
type Column = [Lanes; WIDTH];

/// Lower bands, column by column, then their factors L D Lᵀ in the same place: 1/D on the diagonal, L below it.
///
/// Ten columns of padding follow the matrices. A pivot that is zero leaves numbers in its lane that are not finite, and no trace in
/// the others.
#[derive(Clone, Debug)]
pub(crate) struct BandedLanes {
    columns: Vec<Column>,
    dimension: usize,
}

impl BandedLanes {
    /// Zero matrices of the given dimension.
    pub(crate) fn new(dimension: usize) -> Self {
        Self {
            columns: vec![[[0.0; LANES]; WIDTH]; dimension + HALF_BANDWIDTH],
            dimension,
        }
    }

    /// Sets every entry to zero.
    pub(crate) fn clear(&mut self) {
        self.columns.fill([[0.0; LANES]; WIDTH]);
    }

    /// The columns of the lower bands, to add to. Entries below the last row must stay zero.
    pub(crate) fn columns_mut(&mut self) -> &mut [[Lanes; HALF_BANDWIDTH + 1]] {
        &mut self.columns[..self.dimension]
    }

    /// Eliminates a held unknown: its row and column become zero, its diagonal one.
    pub(crate) fn hold(&mut self, i: usize) {
        self.columns[i] = [[0.0; LANES]; WIDTH];
        self.columns[i][0] = [1.0; LANES];
        for j in i.saturating_sub(HALF_BANDWIDTH)..i {
            self.columns[j][i - j] = [0.0; LANES];
        }
    }

    /// Factors the matrices in place.
    pub(crate) fn factor(&mut self, set: InstructionSet) {
        factor(set, &mut self.columns, self.dimension);
    }

    /// Solves A x = b in place, lane by lane.
    pub(crate) fn solve(&self, set: InstructionSet, right_hand_sides: &mut [Lanes]) {
        assert_eq!(right_hand_sides.len(), self.dimension);
        solve(set, &self.columns, right_hand_sides);
    }
}

kernel! {
    /// L D Lᵀ of every lane.
    fn factor(columns: &mut [Column], dimension: usize) {
        for j in 0..dimension {
            let (column, following) = columns[j..=j + HALF_BANDWIDTH]
                .split_first_mut()
                .expect("a column and its padding");
            let following: &mut [Column; HALF_BANDWIDTH] =
                following.try_into().expect("ten columns follow");
            let unscaled = *column;
            let mut inverse_pivot = [0.0; LANES];
            for lane in 0..LANES {
                inverse_pivot[lane] = 1.0 / unscaled[0][lane];
            }
            for r in 1..WIDTH {
                for lane in 0..LANES {
                    column[r][lane] = unscaled[r][lane] * inverse_pivot[lane];
                }
            }
            column[0] = inverse_pivot;
            for k in 1..WIDTH {
                let factor = column[k];
                let target = &mut following[k - 1];
                for r in k..WIDTH {
                    for lane in 0..LANES {
                        target[r - k][lane] -= factor[lane] * unscaled[r][lane];
                    }
                }
            }
        }
    }
}

kernel! {
    /// Forward and backward substitution of every lane.
    fn solve(columns: &[Column], x: &mut [Lanes]) {
        let n = x.len();
        for i in 0..n {
            let (column, known) = (&columns[i], x[i]);
            for r in 1..WIDTH.min(n - i) {
                for lane in 0..LANES {
                    x[i + r][lane] -= column[r][lane] * known[lane];
                }
            }
        }
        for j in (0..n).rev() {
            let column = &columns[j];
            let mut sum = x[j];
            for lane in 0..LANES {
                sum[lane] *= column[0][lane];
            }
            for r in (1..WIDTH.min(n - j)).rev() {
                for lane in 0..LANES {
                    sum[lane] -= column[r][lane] * x[j + r][lane];
                }
            }
            x[j] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::banded::{BandedFactor, BandedSymmetric};
    use super::*;

    #[test]
    fn every_lane_gets_the_bytes_that_it_gets_alone() {
        for set in InstructionSet::available() {
            for n in [1, 7, 10, 43] {
                let entry = |i: usize, j: usize, lane: usize| {
                    let value = ((i * 37 + j * 91 + lane * 13) as f64).sin();
                    if i == j { 25.0 + value } else { value }
                };
                let mut together = BandedLanes::new(n);
                let mut sides: Vec<Lanes> = (0..n)
                    .map(|k| std::array::from_fn(|lane| ((k + 5 * lane) as f64).cos()))
                    .collect();
                let expected: Vec<Vec<f64>> = (0..LANES)
                    .map(|lane| {
                        let mut matrix = BandedSymmetric::new(n);
                        for j in 0..n {
                            for i in j..n.min(j + WIDTH) {
                                matrix.add(i, j, entry(i, j, lane));
                                together.columns_mut()[j][i - j][lane] = entry(i, j, lane);
                            }
                        }
                        matrix.hold(n / 2);
                        let mut factor = BandedFactor::new(n);
                        factor.factor(&matrix).unwrap();
                        let mut x: Vec<f64> = sides.iter().map(|side| side[lane]).collect();
                        factor.solve(&mut x);
                        x
                    })
                    .collect();
                together.hold(n / 2);
                together.factor(set);
                together.solve(set, &mut sides);
                for lane in 0..LANES {
                    for k in 0..n {
                        assert_eq!(sides[k][lane], expected[lane][k], "{set:?} {n} {lane} {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_singular_lane_leaves_the_others_alone() {
        let (set, n) = (InstructionSet::best(), 12);
        let mut matrix = BandedLanes::new(n);
        for column in matrix.columns_mut() {
            column[0] = [4.0; LANES];
        }
        matrix.columns_mut()[5][0][3] = 0.0;
        matrix.factor(set);
        let mut x = vec![[8.0; LANES]; n];
        matrix.solve(set, &mut x);
        for lane in 0..LANES {
            assert_eq!(x[5][lane].is_finite(), lane != 3);
            assert!(lane == 3 || x.iter().all(|entries| entries[lane] == 2.0));
        }
    }
}
