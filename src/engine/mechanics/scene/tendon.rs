//! Tendons: cables that run through eyelets.

use super::{CoulombFriction, RodNode};
use crate::mechanics::Vector3;

/// A cable without mass and bending stiffness that runs straight from eyelet to eyelet, slides in
/// them, and pulls but does not push. It is fixed to its first and last eyelets, or leaves the scene
/// there.
#[derive(Clone, Debug, PartialEq)]
pub struct Tendon {
    /// Name in scenarios and messages.
    pub name: String,
    /// At least two eyelets, in the order in which the tendon runs through them.
    pub eyelets: Vec<Eyelet>,
    /// What determines its tension.
    pub pull: Pull,
    /// Friction in its eyelets; `None` if it slides freely. A given tension acts at the first
    /// eyelet, where a winch takes in, too; the tendon is fixed to the last one.
    pub friction: Option<CoulombFriction>,
}

impl Tendon {
    /// Whether its force is the gradient of an elastic energy that does not depend on time.
    pub(crate) fn is_conservative(&self) -> bool {
        matches!(&self.pull, Pull::Stretching { taken_in, .. } if taken_in.is_empty())
    }
}

/// A point through which a tendon runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eyelet {
    /// A point of the cross-section at a node, with its components along the two material
    /// directors, m.
    OnRod {
        /// The node.
        at: RodNode,
        /// Components from the node along the directors; at an inner node they are means over
        /// those of the edges on both sides.
        offset: [f64; 2],
    },
    /// A point that does not move, m.
    Fixed(Vector3),
}

impl Pull {
    /// Whether the tendon stretches.
    pub(crate) fn stretches(&self) -> bool {
        matches!(self, Self::Stretching { .. })
    }
}

/// Tension of a tendon.
#[derive(Clone, Debug, PartialEq)]
pub enum Pull {
    /// T at given times, [(s, N), ...]: linear between them and constant outside.
    Tension(Vec<(f64, f64)>),
    /// A tendon that stretches: T = EA (ℓ/L − 1) where its length ℓ is greater than L, else 0.
    Stretching {
        /// EA, N.
        stiffness: f64,
        /// L without `taken_in`, m; `None` is the length as placed.
        rest_length: Option<f64>,
        /// Length by which L is smaller at given times, [(s, m), ...]: linear between them and
        /// constant outside; 0 if empty.
        taken_in: Vec<(f64, f64)>,
    },
}
