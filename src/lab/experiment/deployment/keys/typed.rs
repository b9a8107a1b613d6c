//! Deployments as typed.

use super::DENSITY;
use super::resolved::{Scheme, Solver};
use crate::experiment::on_table::JITTER_PERIOD;
use crate::scenario::keys::{
    Angle, Density, Dimensionless, FINITE, Length, NON_NEGATIVE, POSITIVE, Quantity, Time,
    Velocity, keys,
};
use rodlab_planning::plan::tying::Pass;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Default reach of a gripper, m: its fingers open by 3 cm.
const REACH: f64 = 0.015;
/// Default of the largest distance of the smooth curve from the drawing, m.
const DEVIATION: f64 = 0.25e-3;

keys! {
    /// A rod that a gripper lays on a table along a pattern.
    table Deployment "deployment" {
        /// Target curve of the rod: a drawing (`file`, SVG or CSV, or its `points`), or of `kind` "line",
        /// "circle" or "sine".
        pattern: raw(Pattern) raw,
        /// The rod. `scenarios/rods` has those of thesis Tab. 5.1; use them by `extends`.
        rod: raw(Rod) raw,
        /// Scheme for the gripper's path: "optimal" (the default, the optimal grasp of each point)
        /// or "intuitive" (upright above the contact node, thesis 5.1.1).
        scheme: word(Scheme) default(Scheme::Optimal),
        /// Solver for the optimal grasps: "exact" (the default), or "neural" (the network of the
        /// program, which is much faster, within the range of its samples).
        solver: word(Solver) default(Solver::Exact),
        /// Length of a lead-in before the pattern, over which the curvature grows from zero to
        /// that of the pattern, or "auto" (the default): long enough to keep the friction demand
        /// below 0.1, and none if the pattern begins straight.
        lead_in: raw(Quantity<Length>) raw,
        /// Relative error of the gravito-bending length in the plan of the gripper's path: 0.1
        /// plans for a rod whose L_gb is a tenth larger than that of the actual rod. Default: 0.
        length_error: raw(Quantity<Dimensionless>) raw,
        /// Displacement [x, y] of the planned frame of the pattern from the true one, as from a
        /// misaligned camera. Default: none.
        frame_shift: numbers(Length, 2, FINITE) optional,
        /// Rotation of that frame about the first point of the pattern, counter-clockwise.
        /// Default: none.
        frame_turn: number(Angle, FINITE) default(0.0),
        /// Root mean square, in each direction, of a smooth random displacement of the gripper from its path. Default: none.
        jitter: number(Length, NON_NEGATIVE) default(0.0),
        /// Root mean square of a smooth random rotation of the gripper about each axis. Default:
        /// none.
        jitter_angle: number(Angle, NON_NEGATIVE) default(0.0),
        /// Period of the fastest jitter; the slowest jitter has five times this period.
        jitter_period: number(Time, POSITIVE) default(JITTER_PERIOD),
        /// Seed of the jitter, and of the noise of observations. Default: 0.
        seed: raw(i64) raw,
        /// Corrects the gripper's path from the observed position of the rod while the rod is
        /// laid. Without this table the gripper follows the path planned before the run.
        correction: raw(Correction) raw,
        /// Posts on the table beside the pattern that hold the rod in its bends. A rod is placed
        /// if it passes every post on the same side as its pattern, below the top of the post.
        pegs: raw(Vec<Peg>) raw,
        /// Clips along the pattern: pairs of pegs with the rod between them.
        clips: raw(Clips) raw,
        /// Ties a knot along a pattern that crosses itself and is longer than the rod. When the
        /// rod is laid, its end is led along the rest of the pattern, under strands that another
        /// gripper lifts. With two rods the end of each rod that is shorter than its pattern is
        /// led in this way, that of the second rod first.
        knot: raw(Knot) raw,
        /// A second rod, which another gripper lays after the first one, along its own pattern in
        /// the same frame. All other keys apply to both rods.
        second: raw(Second) raw,
        /// Time before the end of the simulated time at which the gripper releases the rod. The
        /// pattern is laid by then, and the part that still hangs falls. Default: the gripper
        /// holds the rod to the end.
        release: number(Time, POSITIVE) optional,
    }
}

/// The second rod of a deployment.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "second_deployed_rod")]
pub struct Second {
    /// Target curve of the rod.
    pub pattern: Option<Pattern>,
    /// The rod.
    pub rod: Option<Rod>,
    /// Scheme for its gripper's path: "optimal" or "intuitive". Default: the scheme of the first
    /// rod.
    pub scheme: Option<Scheme>,
    /// Length of its lead-in, or "auto" (the default).
    pub lead_in: Option<Quantity<Length>>,
}

keys! {
    /// A knot that is tied along the pattern.
    table Knot "tied_knot" {
        /// Second pass of the rod at each crossing of the pattern, "over" or "under", in the order
        /// of these passes. While the rod is laid, it passes over. With two rods the list has all
        /// crossings: first those of the second rod as it is laid, then those of its end, then
        /// those of the end of the first rod.
        crossings: raw(Vec<Pass>) raw,
        /// Height to which strands are lifted. Default: eight radii of the rod; with two rods, of
        /// the thicker one.
        lift: number(Length, POSITIVE) derived,
        /// Speed at which the end is led. Default: 4 cm/s.
        speed: number(Velocity, POSITIVE) derived,
        /// Largest distance of a strand from its planned place at which the gripper can grasp it.
        /// Default: 1.5 cm.
        reach: number(Length, POSITIVE) default(REACH),
    }
}

/// A fixed post on the table.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "peg")]
pub struct Peg {
    /// Position of its axis, [x, y].
    pub position: Option<[Quantity<Length>; 2]>,
    /// Radius of the post and of its round top.
    pub radius: Option<Quantity<Length>>,
    /// Height of its top above the table, more than its radius.
    pub height: Option<Quantity<Length>>,
}

/// Clips along a pattern. Each is a pair of pegs, one on either side.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "clips")]
pub struct Clips {
    /// Arc lengths of the clips along the pattern, from its first point, without the lead-in.
    pub at: Option<Vec<Quantity<Length>>>,
    /// Clear width between the two pegs, at least the diameter of the rod.
    pub width: Option<Quantity<Length>>,
    /// Radius of each peg and of its round top.
    pub radius: Option<Quantity<Length>>,
    /// Height of the tops of the pegs above the table; more than the radius.
    pub height: Option<Quantity<Length>>,
}

keys! {
    /// Correction of the gripper's path while a rod is laid by the optimal scheme.
    table Correction "correction" {
        /// Length laid between two corrections. Default: 0.8 gravito-bending lengths. Much shorter
        /// lengths make the rod swing about its pattern, because it follows the gripper only over
        /// about a gravito-bending length.
        every: number(Length, POSITIVE) derived,
        /// Length over which the rod returns to the pattern, at least three times `every` and the gravito-bending length.
        /// Default: 3.5 gravito-bending lengths, or three times `every`.
        return_length: number(Length, POSITIVE) derived,
        /// Root mean square error, in each direction, of the positions of the lying rod as
        /// measured by the camera. Default: none.
        noise: number(Length, NON_NEGATIVE) default(0.0),
    }
}

keys! {
    /// Target curve of a laid rod.
    table Pattern "pattern" {
        /// "drawn" (the default), or one with a formula: "line" along x, "circle" through the
        /// origin (once around), "sine" starting at its crest.
        kind: word(PatternKind) default(PatternKind::Drawn),
        /// Drawn: an SVG file, or a CSV file with columns x and y in m, relative to the scenario file.
        file: raw(String) raw,
        /// Drawn: the points [x, y] themselves.
        points: raw(Vec<[Quantity<Length>; 2]>) raw,
        /// Drawn: length of the longer side. Default: the size in the drawing.
        size: number(Length, POSITIVE) optional,
        /// Drawn: number of the stroke of an SVG file, counted from 1, if there are several.
        stroke: raw(i64) raw,
        /// Drawn: whether it is laid from the last point to the first.
        reverse: flag() default(false),
        /// Drawn: largest distance of the smooth curve from the drawing.
        deviation: number(Length, POSITIVE) default(DEVIATION),
        /// Length of the line.
        length: number(Length, POSITIVE) required,
        /// Radius of the circle; a negative radius turns it to the right.
        radius: number(Length, FINITE) required,
        /// Amplitude of the sine.
        amplitude: number(Length, POSITIVE) required,
        /// Wavelength of the sine.
        wavelength: number(Length, POSITIVE) required,
        /// Number of waves of the sine.
        waves: number(Dimensionless, POSITIVE) required,
    }
}

/// Kinds of patterns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum PatternKind {
    /// Points of a drawing.
    #[default]
    Drawn,
    /// A straight line.
    Line,
    /// A circle.
    Circle,
    /// A sine.
    Sine,
}

keys! {
    /// The rod to lay: round, naturally straight, incompressible.
    table Rod "deployed_rod" {
        /// Gravito-bending length L_gb = (E h²/(8 ρ g))^(1/3), which determines Young's modulus.
        gravito_bending_length: number(Length, POSITIVE) required,
        /// Radius h.
        radius: number(Length, POSITIVE) required,
        /// Length.
        length: number(Length, POSITIVE) required,
        /// Mass per volume, 1000 kg/m³ by default. Forces are proportional to it; shapes do not
        /// depend on it.
        density: number(Density, POSITIVE) default(DENSITY),
        /// Number of edges of the simulated rod. Default: four per gravito-bending length, at
        /// least 80 and at most 400.
        edges: raw(i64) raw,
        /// Coefficients of friction with tables, by name, for `rodlab plan deployment --friction NAME`. The table of a
        /// simulation has `contact.friction`.
        friction: raw(BTreeMap<String, f64>) raw,
    }
}
