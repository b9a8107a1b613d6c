//! Shapes as typed.

use super::kinds::allow_text;
use crate::scenario::declaration::keys;
use crate::scenario::quantity::Vector;
use crate::scenario::resolved::Handedness;
use crate::scenario::section::{FINITE, POSITIVE, UP};
use crate::scenario::units::{Angle, Curvature, Dimensionless, Length, Twist};
use schemars::{JsonSchema, Schema};
use serde::Deserialize;

/// A curve in space.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", rename = "shape")]
pub enum Shape {
    /// A straight line.
    Straight(Straight),
    /// A helix.
    Helix(Helix),
    /// An arc of a circle.
    Arc(Arc),
    /// A closed circle.
    Ring(Ring),
    /// A chain that hangs between two points.
    Catenary(Catenary),
    /// A slack rod between two points.
    Slack(Slack),
    /// A rod coiled flat.
    Coil(Coil),
    /// A polyline.
    Points(Points),
}

/// The shape without stress.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", rename = "natural_shape", transform = plain_natural_shapes)]
pub enum NaturalShape {
    /// Curvature, twist and lengths as placed.
    AsPlaced(AsPlaced),
    /// Straight and untwisted. With `start` and `end` their distance is the natural length, else the
    /// edges keep their placed lengths.
    Straight(Straight),
    /// Constant natural curvature and twist, edge lengths as placed.
    Curved(Curved),
    /// Curvature, twist and lengths of a helix.
    Helix(Helix),
    /// Curvature, twist and lengths of an arc.
    Arc(Arc),
    /// Curvature, twist and lengths of a ring.
    Ring(Ring),
    /// Curvature, twist and lengths of a polyline.
    Points(Points),
    /// Curvature and twist over the natural arc length, for open rods.
    Strains(Strains),
}

/// Adds the natural shapes that need no further keys, as text.
fn plain_natural_shapes(schema: &mut Schema) {
    allow_text(schema, &["as-placed", "straight"]);
}

/// The placed shape; it has no keys of its own.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "as-placed")]
pub struct AsPlaced {}

keys! {
    /// A straight line.
    table Straight "straight" {
        /// First point.
        start: vector(Length) required,
        /// Last point.
        end: vector(Length) required,
    }
}

keys! {
    /// Constant natural curvature and twist.
    table Curved "curved" {
        /// Natural curvatures about the first and the second material director. Default: none.
        curvature: numbers(Curvature, 2, FINITE) optional,
        /// Natural twist per length.
        twist: number(Twist, FINITE) default(0.0),
    }
}

keys! {
    /// A helix; give `start` or `centre`, and `turns` or `length`.
    table Helix "helix" {
        /// First point of the helix itself.
        start: vector(Length) optional,
        /// Point of the axis nearest to the first point of the helix.
        centre: vector(Length) optional,
        /// Direction of the axis.
        axis: direction() default(UP),
        /// Radius of the helix.
        radius: number(Length, POSITIVE) required,
        /// Advance along the axis per turn.
        pitch: number(Length, POSITIVE) required,
        /// Number of turns.
        turns: number(Dimensionless, POSITIVE) optional,
        /// Length along the axis.
        length: number(Length, POSITIVE) optional,
        /// "right" (the default, an ordinary screw) or "left".
        handedness: word(Handedness) default(Handedness::Right),
        /// Angle of the first point about the axis, from the direction of x (of y about an axis along x).
        ///
        phase: number(Angle, FINITE) default(0.0),
    }
}

keys! {
    /// An arc of a circle that begins at `start` along `tangent` and turns about `normal`.
    table Arc "arc" {
        /// First point.
        start: vector(Length) required,
        /// Direction at the first point.
        tangent: direction() required,
        /// Axis about which the arc turns; only the component normal to `tangent` is used.
        normal: direction() required,
        /// Radius of the circle.
        radius: number(Length, POSITIVE) required,
        /// Angle turned, greater than 0.
        angle: number(Angle, POSITIVE) required,
    }
}

keys! {
    /// A closed circle.
    table Ring "ring" {
        /// Centre.
        centre: vector(Length) required,
        /// Normal of the plane of the ring, which runs counter-clockwise about it.
        normal: direction() default(UP),
        /// Radius of the circle.
        radius: number(Length, POSITIVE) required,
    }
}

keys! {
    /// A chain that hangs between two points. This is near the equilibrium of a heavy, soft rod,
    /// which therefore starts without a fall.
    table Catenary "catenary" {
        /// First point.
        start: vector(Length) required,
        /// Last point; not directly above or below the first.
        end: vector(Length) required,
        /// Length of the chain, greater than the distance of its ends.
        length: number(Length, POSITIVE) required,
        /// Direction in which it hangs.
        down: direction() default([0.0, 0.0, -1.0]),
    }
}

keys! {
    /// A rod that is longer than the distance of its ends, laid in a circular arc between them.
    /// Its edges are equal and add up to exactly the stated length.
    table Slack "slack" {
        /// First point.
        start: vector(Length) required,
        /// Last point.
        end: vector(Length) required,
        /// Length of the rod, greater than the distance of its ends and at most a thousand times that.
        length: number(Length, POSITIVE) required,
        /// Direction from the line between the ends to the middle of the rod; only the component
        /// normal to that line is used.
        towards: direction() required,
    }
}

keys! {
    /// A rod coiled flat, in a spiral of Archimedes from its inner end outwards. Its edges are
    /// equal and add up to exactly the stated length.
    table Coil "coil" {
        /// Middle of the coil.
        centre: vector(Length) required,
        /// Axis about which the rod winds.
        normal: direction() default(UP),
        /// Distance of its inner end from the centre.
        inner_radius: number(Length, POSITIVE) required,
        /// Distance between adjacent turns, greater than the diameter of the rod.
        spacing: number(Length, POSITIVE) required,
        /// Length of the rod, which determines the number of turns.
        length: number(Length, POSITIVE) required,
        /// Angle of the inner end about the normal, from the direction of x (of y about a normal along x).
        phase: number(Angle, FINITE) default(0.0),
    }
}

/// A polyline; give `file` or `points`. With `edges` it is resampled to equal arc lengths, which
/// cuts corners between nodes and shortens the rod; `rodlab check` warns if the rod becomes
/// shorter by 0.01 % or more.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "points")]
pub struct Points {
    /// CSV file with a header line and columns x, y, z in m, relative to the scenario file.
    pub file: Option<String>,
    /// The corners themselves.
    pub points: Option<Vec<Vector<Length>>>,
}

/// Natural curvature and twist over the natural arc length; give `file`, or lists of equal
/// lengths. If there is one row for each node, the rows belong to the nodes, and their distances
/// are the natural lengths of the edges. Otherwise the rows are interpolated at nodes of equal
/// distances.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "strains")]
pub struct Strains {
    /// CSV file with a header line and columns arc_length (m), curvature_1, curvature_2 (1/m) and twist (rad/m), relative to the
    /// scenario file; `rodlab design` writes it.
    pub file: Option<String>,
    /// Natural arc lengths, starting at 0, m.
    pub arc_length: Option<Vec<f64>>,
    /// Natural curvatures about the first material director, 1/m.
    pub curvature_1: Option<Vec<f64>>,
    /// Natural curvatures about the second material director, 1/m.
    pub curvature_2: Option<Vec<f64>>,
    /// Natural twist of the material frame, rad/m.
    pub twist: Option<Vec<f64>>,
}
