//! Knots as typed.

use super::resolved::{self, KnotEnds};
use crate::scenario::keys::{
    Dimensionless, FRACTION, Length, LinearDrag, NON_NEGATIVE, POSITIVE, Time, Vector, Velocity,
    keys,
};
use schemars::JsonSchema;
use serde::Deserialize;

keys! {
    /// A knot of one or two rods: it settles, then its ends are pulled apart at constant speed.
    table Knot "knot" {
        /// Name of the knot: "overhand" (the default, with an `unknotting_number`) or
        /// "figure-eight" of one rod; "reef", "granny", "surgeon" or "fisherman" of two rods, with
        /// all four ends pulled, two to each side. With a `curve` it is the knot that the curve
        /// must have, judged by its determinant; without this key any knot is allowed.
        kind: raw(KnotKind) raw,
        /// Unknotting number of an overhand knot, 1 to 6: 1 is the trefoil, 2 the cinquefoil; the braid has 2n + 1
        /// crossings.
        unknotting_number: raw(i64) raw,
        /// CSV file of the open curve along which one rod starts, instead of a knot tied from numbers: a header line and
        /// columns x, y, z in m, relative to the scenario file. The rod is cut evenly; its ends are pulled along the line
        /// through both and keep their directions.
        curve: raw(String) raw,
        /// The corners of such a curve, instead of a file.
        points: raw(Vec<Vector<Length>>) raw,
        /// Length of each rod. A curve is scaled to this length; without this key the curve keeps
        /// its own length.
        length: number(Length, POSITIVE) optional,
        /// Initial distance of the ends; with two rods, of the left ends from the right ends. Not
        /// for a curve, which defines it.
        end_to_end: number(Length, POSITIVE) optional,
        /// Support of the ends: "clamped" (the default: position, tangent and frame, so that they
        /// do not rotate relative to each other) or "pinned" (position only, so that twist leaves
        /// the rod).
        ends: word(KnotEnds) default(KnotEnds::Clamped),
        /// Speed of each end, or "auto" (the default): slow enough to keep the kinetic energy
        /// below `kinetic_bound`, as estimated from the mass of the rod and the initial energy π
        /// EI/R of its loop.
        pull_speed: number(Velocity, POSITIVE) derived,
        /// Largest kinetic over elastic energy of a quasi-static pull, 1e-3 by default.
        /// `pull_speed = "auto"` aims at this value, and a run whose ratio exceeds it while the
        /// ends move reports this. `summary.csv` has both values.
        kinetic_bound: number(Dimensionless, FRACTION) default(resolved::Knot::KINETIC_BOUND),
        /// Time for which the knot settles under strong drag before the ends move; the drag fades
        /// at the end of this time. Default: twelve periods R² √(ρA/EI) of the loop, at least two
        /// seconds.
        settling_time: number(Time, NON_NEGATIVE) derived,
        /// Drag per length while the ends move, or "auto" (the default): small enough to
        /// contribute only a five-hundredth of the initial traction of the loop, EI/2R².
        damping: number(LinearDrag, NON_NEGATIVE) derived,
    }
}

/// Names of knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum KnotKind {
    /// The overhand knot and its relatives with more turns.
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
