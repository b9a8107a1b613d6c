//! Knots as typed.

use super::resolved::{self, KnotEnds};
use crate::scenario::keys::{
    Dimensionless, FRACTION, Length, LinearDrag, NON_NEGATIVE, POSITIVE, Time, Vector, Velocity,
    keys,
};
use schemars::JsonSchema;
use serde::Deserialize;

keys! {
    /// A knot of one rod or two: it settles, then its ends are pulled apart at constant speed.
    table Knot "knot" {
        /// Name of the knot: "overhand" (the default, with an `unknotting_number`) or "figure-eight" of one rod; "reef",
        /// "granny", "surgeon" or "fisherman" of two rods, all four ends of which are pulled, two to each side. With a
        /// `curve` it is the knot that the curve must have, judged by its determinant; without it any knot is allowed.
        kind: raw(KnotKind) raw,
        /// Unknotting number of an overhand knot, 1 to 6: 1 is the trefoil, 2 the cinquefoil; the braid has 2n + 1
        /// crossings.
        unknotting_number: raw(i64) raw,
        /// CSV file of the open curve along which one rod starts, instead of a knot tied from numbers: a header line and
        /// columns x, y, z in m, relative to the scenario file. The rod is cut evenly; its ends are pulled along the line
        /// through both and keep their directions.
        curve: raw(String) raw,
        /// The corners of such a curve themselves.
        points: raw(Vec<Vector<Length>>) raw,
        /// Length of each rod. A curve is scaled to it; without it the curve keeps its own length.
        length: number(Length, POSITIVE) optional,
        /// Distance of the ends at the start, with two rods of the ends on the left from those on the right. Not for a
        /// curve, which defines it.
        end_to_end: number(Length, POSITIVE) optional,
        /// Support of the ends: "clamped" (the default: position, tangent and frame, so that they do not turn
        /// against each other) or "pinned" (position only, so that twist leaves the rod).
        ends: word(KnotEnds) default(KnotEnds::Clamped),
        /// Speed of each end, or "auto" (the default): so slow that the kinetic energy stays below `kinetic_bound`, as
        /// estimated from the mass of the rod and the energy π EI/R of its loop at the start.
        pull_speed: number(Velocity, POSITIVE) derived,
        /// Largest kinetic over elastic energy of a quasi-static pull, 1e-3 by default: `pull_speed = "auto"` aims at it,
        /// and a run that exceeds it while the ends move reports it. `summary.csv` has both.
        kinetic_bound: number(Dimensionless, FRACTION) default(resolved::Knot::KINETIC_BOUND),
        /// Time for which the knot settles under strong drag, which fades at its end, before the ends move. Default:
        /// twelve periods R² √(ρA/EI) of the loop, and two seconds at least.
        settling_time: number(Time, NON_NEGATIVE) derived,
        /// Drag per length while the ends move, or "auto" (the default): so small that it makes up a five-hundredth of
        /// the traction of the loop at the start, EI/2R².
        damping: number(LinearDrag, NON_NEGATIVE) derived,
    }
}

/// Names of knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum KnotKind {
    /// The overhand knot and its relatives of more turns.
    Overhand,
    /// The figure-eight knot.
    FigureEight,
    /// The reef or square knot.
    Reef,
    /// The granny knot.
    Granny,
    /// The surgeon's knot.
    Surgeon,
    /// The fisherman's knot.
    Fisherman,
}
