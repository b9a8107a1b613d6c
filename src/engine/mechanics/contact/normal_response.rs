//! Response of a normal force law to a gap.

/// Energy of a contact at a gap, and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct NormalResponse {
    /// Energy E, J.
    pub energy: f64,
    /// Normal force N = −dE/dΔ, N, never negative.
    pub force: f64,
    /// dN/dΔ, N/m, never positive.
    pub force_slope: f64,
}
