//! Result of a factorisation: the signs of its pivots, or the reason for its failure.

/// Signs and sizes of the pivots of an LDLᵀ factorisation.
///
/// By Sylvester's law of inertia the numbers of positive and negative pivots are those of the positive
/// and negative eigenvalues, for any order of elimination.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Number of positive pivots.
    pub positive: usize,
    /// Number of negative pivots.
    pub negative: usize,
    /// Smallest magnitude of a pivot.
    pub smallest_pivot: f64,
    /// Largest magnitude of a pivot.
    pub largest_pivot: f64,
}

impl Inertia {
    /// The inertia of an empty matrix, to which [`Inertia::count`] adds pivots.
    pub(super) const EMPTY: Self = Self {
        positive: 0,
        negative: 0,
        smallest_pivot: f64::INFINITY,
        largest_pivot: 0.0,
    };

    /// The inertia of a block-diagonal matrix of two blocks.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            positive: self.positive + other.positive,
            negative: self.negative + other.negative,
            smallest_pivot: self.smallest_pivot.min(other.smallest_pivot),
            largest_pivot: self.largest_pivot.max(other.largest_pivot),
        }
    }

    /// Adds one pivot; a pivot that is zero or not finite is an error.
    #[inline(always)]
    pub(super) fn count(&mut self, pivot: f64, unknown: usize) -> Result<(), SingularMatrix> {
        let size = pivot.abs();
        if !(size > 0.0 && size < f64::INFINITY) {
            return Err(SingularMatrix { unknown, pivot });
        }
        let is_positive = usize::from(pivot > 0.0);
        self.positive += is_positive;
        self.negative += 1 - is_positive;
        self.smallest_pivot = self.smallest_pivot.min(size);
        self.largest_pivot = self.largest_pivot.max(size);
        Ok(())
    }
}

/// A system that cannot be solved: a pivot is zero or not finite, or the solution does not satisfy it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the Newton matrix is singular at unknown {unknown} (node {}, pivot {pivot:e})",
    unknown / 4
)]
pub struct SingularMatrix {
    /// The unknown at which elimination failed.
    pub unknown: usize,
    /// The pivot found there, or the residual of the equation.
    pub pivot: f64,
}
