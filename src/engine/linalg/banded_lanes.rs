//! [`LANES`] symmetric band matrices of one size, each with a right-hand side, factored at the
//! same time. Each lane does the operations of [`super::banded`] on every entry in the same order,
//! so that it gets the same bytes as alone.
//!
//! Once a column is complete, all columns before it are eliminated from it at once, and columns
//! after it may still be incomplete. The column is then still in the cache, and is read and written
//! only once. The columns hold D Lᵀ; one product turns this into L.

use super::LaneVector;
use super::banded::HALF_BANDWIDTH;
use super::instruction_set::{InstructionSet, LANES, Lanes, kernel};

/// Entries stored per column: the diagonal and the band below it.
const WIDTH: usize = HALF_BANDWIDTH + 1;

/// One column of the lower bands: entry r is row j + r of column j.
type Column = [Lanes; WIDTH];

/// Lower bands, column by column, which the factors D Lᵀ replace, with 1/D on the diagonal; and
/// right-hand sides, which the solutions replace.
///
/// Ten columns of padding precede the matrices; ten entries of padding precede the right-hand
/// sides, and ten follow them. A zero pivot leaves numbers that are not finite in its own lane and
/// does not affect the others.
#[derive(Debug)]
pub(crate) struct BandedLanes {
    columns: LaneVector,
    sides: LaneVector,
    dimension: usize,
}

impl BandedLanes {
    /// Zero matrices of the given dimension.
    pub(crate) fn new(dimension: usize) -> Self {
        Self {
            columns: LaneVector::new(WIDTH * (HALF_BANDWIDTH + dimension)),
            sides: LaneVector::new(HALF_BANDWIDTH + dimension + HALF_BANDWIDTH),
            dimension,
        }
    }

    /// The columns of the lower bands, for adding entries. Entries below the last row must stay
    /// zero.
    pub(crate) fn columns_mut(&mut self) -> &mut [[Lanes; HALF_BANDWIDTH + 1]] {
        let (columns, _) = self.columns.as_chunks_mut();
        &mut columns[HALF_BANDWIDTH..]
    }

    /// The right-hand sides, or the solutions.
    pub(crate) fn sides(&self) -> &[Lanes] {
        &self.sides[HALF_BANDWIDTH..][..self.dimension]
    }

    /// The right-hand sides, or the solutions.
    pub(crate) fn sides_mut(&mut self) -> &mut [Lanes] {
        &mut self.sides[HALF_BANDWIDTH..][..self.dimension]
    }

    /// Eliminates `count` columns from `first` on. They must be complete, and all columns before
    /// them eliminated.
    pub(crate) fn eliminate(&mut self, set: InstructionSet, first: usize, count: usize) {
        let (columns, _) = self.columns.as_chunks_mut();
        let end = first + HALF_BANDWIDTH + count;
        eliminate(set, &mut columns[first..end], &mut self.sides[first..end]);
    }

    /// Computes the solutions once all columns are eliminated.
    pub(crate) fn substitute_back(&mut self, set: InstructionSet) {
        let (columns, _) = self.columns.as_chunks();
        let sides = &mut self.sides[HALF_BANDWIDTH..];
        substitute_back(set, &columns[HALF_BANDWIDTH..], sides);
    }
}

/// Subtracts the contribution of the column `$k` places before from the current one.
macro_rules! subtract {
    ($before:ident, $known:ident, $own:ident, $side:ident, $lane:ident, $($k:literal)*) => {
        $({
            let earlier: &Column = &$before[HALF_BANDWIDTH - $k];
            let factor = earlier[$k][$lane] * earlier[0][$lane];
            for r in $k..WIDTH {
                $own[r - $k] -= factor * earlier[r][$lane];
            }
            $side -= factor * $known[HALF_BANDWIDTH - $k][$lane];
        })*
    };
}

kernel! {
    /// Eliminates all columns except the first ten, which are eliminated already, and substitutes
    /// forward.
    fn eliminate(columns: &mut [Column], sides: &mut [Lanes]) {
        for j in HALF_BANDWIDTH..columns.len().min(sides.len()) {
            let (before, from) = columns.split_at_mut(j);
            let before: &[Column; HALF_BANDWIDTH] = before.last_chunk().expect("ten are before");
            let (known, unknown) = sides.split_at_mut(j);
            let known: &[Lanes; HALF_BANDWIDTH] = known.last_chunk().expect("ten are before");
            let (column, unknown) = (&mut from[0], &mut unknown[0]);
            for lane in 0..LANES {
                let mut own = [0.0; WIDTH];
                for r in 0..WIDTH {
                    own[r] = column[r][lane];
                }
                let mut side = unknown[lane];
                subtract!(before, known, own, side, lane, 10 9 8 7 6 5 4 3 2 1);
                column[0][lane] = 1.0 / own[0];
                for r in 1..WIDTH {
                    column[r][lane] = own[r];
                }
                unknown[lane] = side;
            }
        }
    }
}

kernel! {
    /// Backward substitution of every lane; ten zeros follow the right-hand sides.
    fn substitute_back(columns: &[Column], sides: &mut [Lanes]) {
        for (j, column) in columns.iter().enumerate().rev() {
            let (own, found) = sides[j..].split_first_mut().expect("one for each column");
            let found: &[Lanes; HALF_BANDWIDTH] = found.first_chunk().expect("ten follow");
            for lane in 0..LANES {
                let inverse_pivot = column[0][lane];
                let mut sum = own[lane] * inverse_pivot;
                for r in (1..WIDTH).rev() {
                    sum -= column[r][lane] * inverse_pivot * found[r - 1][lane];
                }
                own[lane] = sum;
            }
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
            for (n, at_once) in [(1, 1), (7, 3), (10, 4), (43, 4), (43, 43)] {
                let entry = |i: usize, j: usize, lane: usize| {
                    let value = ((i * 37 + j * 91 + lane * 13) as f64).sin();
                    if i == j { 25.0 + value } else { value }
                };
                let mut together = BandedLanes::new(n);
                for (k, side) in together.sides_mut().iter_mut().enumerate() {
                    *side = std::array::from_fn(|lane| ((k + 5 * lane) as f64).cos());
                }
                let expected: Vec<Vec<f64>> = (0..LANES)
                    .map(|lane| {
                        let mut matrix = BandedSymmetric::new(n);
                        for j in 0..n {
                            for i in j..n.min(j + WIDTH) {
                                matrix.add(i, j, entry(i, j, lane));
                                together.columns_mut()[j][i - j][lane] = entry(i, j, lane);
                            }
                        }
                        let mut factor = BandedFactor::new(n);
                        factor.factor(&matrix).unwrap();
                        let sides = together.sides().iter();
                        let mut x: Vec<f64> = sides.map(|side| side[lane]).collect();
                        factor.solve(&mut x);
                        x
                    })
                    .collect();
                for first in (0..n).step_by(at_once) {
                    together.eliminate(set, first, at_once.min(n - first));
                }
                together.substitute_back(set);
                for lane in 0..LANES {
                    for (k, side) in together.sides().iter().enumerate() {
                        assert_eq!(side[lane], expected[lane][k], "{set:?} {n} {lane} {k}");
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
        matrix.sides_mut().fill([8.0; LANES]);
        matrix.eliminate(set, 0, n);
        matrix.substitute_back(set);
        for lane in 0..LANES {
            assert_eq!(matrix.sides()[5][lane].is_finite(), lane != 3);
            let own = matrix.sides().iter().map(|entries| entries[lane]);
            assert!(lane == 3 || own.into_iter().all(|entry| entry == 2.0));
        }
    }
}
