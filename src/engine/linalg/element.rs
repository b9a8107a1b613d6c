//! Dense elements, which couple unknowns that are far apart in the band.

/// Number of unknowns of a dense element; [`UNUSED`] fills the places that it does not need.
pub type Element = [usize; 12];

/// Entries of a dense element: row, then column, in the order of its [`Element`].
pub type ElementMatrix = [[f64; 12]; 12];

/// Marks an unused place of an [`Element`].
pub const UNUSED: usize = usize::MAX;

/// An unknown that always has the value of another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharedUnknown {
    /// The unknown that is eliminated.
    pub unknown: usize,
    /// The unknown that owns its value, and is not itself shared.
    pub owner: usize,
}

/// Whether an element's unknown takes part in a system in which the unknowns in `held` keep their
/// value.
pub(super) fn is_free(unknown: usize, held: &[bool]) -> bool {
    unknown != UNUSED && !held[unknown]
}
