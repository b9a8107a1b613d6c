//! Knots as typed.

use super::quantity::Quantity;
use crate::scenario::resolved::KnotEnds;
use crate::scenario::units::{Length, LinearDrag, Time, Velocity};
use schemars::JsonSchema;
use serde::Deserialize;

/// An open overhand knot on the x axis, its ends pulled apart at constant speed without turning against each other.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "knot")]
pub struct Knot {
    /// Unknotting number, 1 to 6: 1 is the trefoil, 2 the cinquefoil; the braid has 2n + 1 crossings.
    pub unknotting_number: Option<i64>,
    /// Length of the rod.
    pub length: Option<Quantity<Length>>,
    /// Distance of the ends at the start.
    pub end_to_end: Option<Quantity<Length>>,
    /// What is held at the ends: "clamped" (the default: position, tangent and frame, so that they do not turn
    /// against each other) or "pinned" (position only, so that twist leaves the rod).
    pub ends: Option<KnotEnds>,
    /// Speed of each end, or "auto" (the default): a hundredth of √(EI/ρA)/R with the radius R of the loop at the
    /// start, so that waves run round the loop long before it is smaller.
    pub pull_speed: Option<Quantity<Velocity>>,
    /// Time for which the knot settles under strong drag, which fades at its end, before the ends move. Default:
    /// six periods R² √(ρA/EI) of the loop, and two seconds at least.
    pub settling_time: Option<Quantity<Time>>,
    /// Drag per length while the ends move, or "auto" (the default): so small that it makes up a five-hundredth of
    /// the traction of the loop at the start, EI/2R².
    pub damping: Option<Quantity<LinearDrag>>,
}
