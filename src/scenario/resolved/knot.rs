//! The knot-tightening experiment as resolved.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An open overhand knot and how it is pulled tight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Knot {
    /// Unknotting number n.
    pub unknotting_number: usize,
    /// Length of the rod, m.
    pub length: f64,
    /// Distance of the ends at the start, m.
    pub end_to_end: f64,
    /// What is held at the ends.
    pub ends: KnotEnds,
    /// Speed of each end, m/s.
    pub pull_speed: f64,
    /// Largest kinetic over elastic energy of a quasi-static pull. Left out where it is the default, so that results
    /// of before it was are still known as those of the same scenario.
    #[serde(skip_serializing_if = "is_default_bound")]
    pub kinetic_bound: f64,
    /// Time for which the knot settles under strong drag before the ends move, s.
    pub settling_time: f64,
    /// Drag per length while the ends move, N s/m².
    pub damping: f64,
}

impl Knot {
    /// Default of the kinetic bound: pulled at half the speed, the traction is then the same within 1 %.
    pub const KINETIC_BOUND: f64 = 1e-3;
}

fn is_default_bound(bound: &f64) -> bool {
    *bound == Knot::KINETIC_BOUND
}

/// What is held at the ends of a knotted rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum KnotEnds {
    /// Position, tangent and material frame: the ends do not turn against each other.
    Clamped,
    /// Position only: the ends turn freely, and twist leaves the rod.
    Pinned,
}
