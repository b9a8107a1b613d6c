//! Knots as typed.

use super::quantity::Quantity;
use crate::scenario::resolved::KnotEnds;
use crate::scenario::units::{Dimensionless, Length, LinearDrag, Time, Velocity};
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
    /// Speed of each end, or "auto" (the default): so slow that the kinetic energy stays below `kinetic_bound`, as
    /// estimated from the mass of the rod and the energy π EI/R of its loop at the start.
    pub pull_speed: Option<Quantity<Velocity>>,
    /// Largest kinetic over elastic energy of a quasi-static pull, 1e-3 by default: `pull_speed = "auto"` aims at it,
    /// and a run that exceeds it while the ends move says so. `summary.csv` has both.
    pub kinetic_bound: Option<Quantity<Dimensionless>>,
    /// Time for which the knot settles under strong drag, which fades at its end, before the ends move. Default:
    /// twelve periods R² √(ρA/EI) of the loop, and two seconds at least.
    pub settling_time: Option<Quantity<Time>>,
    /// Drag per length while the ends move, or "auto" (the default): so small that it makes up a five-hundredth of
    /// the traction of the loop at the start, EI/2R².
    pub damping: Option<Quantity<LinearDrag>>,
}
