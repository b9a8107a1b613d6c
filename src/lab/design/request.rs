//! What is wanted.

use crate::scenario::CaseSet;
use std::path::Path;

/// Request of an inverse design.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The scenario, a single case.
    pub scenario: &'a CaseSet,
    /// CSV file of the target curve, from the first node of the rod to its last.
    pub shape: &'a Path,
    /// The rod to design. `None` if there is only one.
    pub rod: Option<&'a str>,
    /// The keys to find: `rods.NAME.natural_curvature` alone, or numbers.
    pub vary: &'a [String],
}
