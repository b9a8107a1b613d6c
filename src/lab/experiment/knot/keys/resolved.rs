//! Knots as resolved.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A knot and how it is pulled tight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Knot {
    /// Placement of the rods at the start.
    #[serde(flatten)]
    pub start: KnotStart,
    /// Length of each rod, m.
    pub length: f64,
    /// Initial distance of the ends, m; with two rods, of the left ends from the right ends.
    pub end_to_end: f64,
    /// Support of the ends.
    pub ends: KnotEnds,
    /// Speed of each end, m/s.
    pub pull_speed: f64,
    /// Largest kinetic over elastic energy of a quasi-static pull. The default is not written, so
    /// that results from versions without this key are still recognised as those of the same
    /// scenario.
    #[serde(skip_serializing_if = "is_default_bound")]
    pub kinetic_bound: f64,
    /// Time for which the knot settles under strong drag before the ends move, s.
    pub settling_time: f64,
    /// Drag per length while the ends move, N s/m².
    pub damping: f64,
}

impl Knot {
    /// Default of the kinetic bound: a pull at half the speed then has the same traction within 1
    /// %.
    pub const KINETIC_BOUND: f64 = 1e-3;
}

fn is_default_bound(bound: &f64) -> bool {
    *bound == Knot::KINETIC_BOUND
}

/// Placement of the rods of a knot at the start.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum KnotStart {
    /// Tied from numbers.
    Tied(KnotKind),
    /// One rod along a curve.
    Curve {
        /// The knot that it must be.
        #[serde(flatten)]
        kind: Option<KnotKind>,
        /// The corners of the curve, m.
        points: Vec<[f64; 3]>,
    },
}

impl KnotStart {
    /// Kind of the knot; `None` allows any knot.
    pub fn kind(&self) -> Option<KnotKind> {
        match self {
            Self::Tied(kind) => Some(*kind),
            Self::Curve { kind, .. } => *kind,
        }
    }

    /// Number of rods that are tied.
    pub fn rods(&self) -> usize {
        use KnotKind::{Fisherman, Granny, Reef, Surgeon};
        match self {
            Self::Tied(Reef | Granny | Surgeon | Fisherman) => 2,
            Self::Tied(_) | Self::Curve { .. } => 1,
        }
    }
}

/// Kinds of knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum KnotKind {
    /// The overhand knot and its relatives with more turns.
    Overhand {
        /// Unknotting number n.
        unknotting_number: usize,
    },
    /// The figure-eight knot.
    FigureEight,
    /// The reef or square knot of two rods.
    Reef,
    /// The granny knot of two rods.
    Granny,
    /// The surgeon's knot of two rods.
    Surgeon,
    /// The fisherman's knot of two rods.
    Fisherman,
}

/// Support of the ends of a knotted rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum KnotEnds {
    /// Position, tangent and material frame: the ends do not rotate relative to each other.
    Clamped,
    /// Position only: the ends rotate freely, and twist leaves the rod.
    Pinned,
}
