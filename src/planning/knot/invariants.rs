//! Knot invariants.

use super::determinant::determinant_of_closed;
use super::signature::signature_of_closed;
use rodlab_engine::mechanics::Vector3;
use serde::{Deserialize, Serialize};

/// Determinant and signature of a knot: 1 and 0 without a knot, 3 and −2 for the right-handed
/// trefoil, 9 and 0 for the reef knot, 9 and ±4 for the granny knot. A few other knots have the
/// same values: the stevedore also has 9 and 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct KnotInvariants {
    /// The determinant.
    pub determinant: u64,
    /// The signature.
    pub signature: i64,
}

impl KnotInvariants {
    /// Invariants of a closed polygon, whose last node is joined to the first. `None` if two segments cross in space, or if no direction of
    /// projection was found in which all crossings are clear.
    pub fn of_closed(nodes: &[Vector3]) -> Option<Self> {
        Some(Self {
            determinant: determinant_of_closed(nodes)?,
            signature: signature_of_closed(nodes)?,
        })
    }
}
