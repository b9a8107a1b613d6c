//! What tells knots apart.

use super::determinant::determinant_of_closed;
use super::signature::signature_of_closed;
use rodlab_engine::mechanics::Vector3;
use serde::{Deserialize, Serialize};

/// Determinant and signature of a knot: 1 and 0 of none, 3 and −2 of the right-handed trefoil, 9 and 0 of the reef knot, 9 and ±4
/// of the granny knot. Both are the same of a few other knots: 9 and 0 of the stevedore, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct KnotInvariants {
    /// The determinant.
    pub determinant: u64,
    /// The signature.
    pub signature: i64,
}

impl KnotInvariants {
    /// Those of a closed polygon, whose last node is joined to the first. `None` if two segments cross in space, or if no direction of
    /// projection was found in which all crossings are clear.
    pub fn of_closed(nodes: &[Vector3]) -> Option<Self> {
        Some(Self {
            determinant: determinant_of_closed(nodes)?,
            signature: signature_of_closed(nodes)?,
        })
    }
}
