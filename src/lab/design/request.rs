//! What is wanted.

use crate::scenario::CaseSet;
use std::path::Path;

/// What is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The scenario, of one case.
    pub scenario: &'a CaseSet,
    /// CSV file of the wanted curve, from the first node of the rod to its last.
    pub shape: &'a Path,
    /// The rod whose shape is wanted; the only one where it is `None`.
    pub rod: Option<&'a str>,
    /// The keys to find: `rods.NAME.natural_curvature` alone, or numbers.
    pub vary: &'a [String],
}
