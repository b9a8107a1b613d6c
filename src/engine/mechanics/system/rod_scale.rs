//! Sizes of forces and lengths of one rod, for tolerances.

use crate::mechanics::scene::RodDescription;

/// Scales of one rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodScale {
    /// EI/L² for the larger bending stiffness, where that is least along the rod, N.
    pub force: f64,
    /// Smallest natural edge length, m.
    pub shortest_edge: f64,
    /// Rounding error of an elastic force per coordinate, N/m: EA ε/l̃, or 4 EI ε/l̃³ if bending
    /// is stiffer, i.e. for edges shorter than the diameter.
    pub rounding_stiffness: f64,
}

impl RodScale {
    pub(super) fn of(rod: &RodDescription, natural_lengths: &[f64]) -> Self {
        let length: f64 = natural_lengths.iter().sum();
        let [softest, stiffest] = rod.bending_range();
        let shortest = (natural_lengths.iter().copied()).fold(f64::INFINITY, f64::min);
        let stretching = rod.stiffest_stretching() * f64::EPSILON / shortest;
        let turning = 4.0 * stiffest * f64::EPSILON / shortest.powi(3);
        Self {
            force: softest / (length * length),
            shortest_edge: shortest,
            rounding_stiffness: stretching.max(turning),
        }
    }
}
