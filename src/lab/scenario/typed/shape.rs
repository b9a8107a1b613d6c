//! Shapes as typed.

use super::kinds::allow_text;
use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::resolved::Handedness;
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
}

/// Adds the natural shapes that need no further keys, as text.
fn plain_natural_shapes(schema: &mut Schema) {
    allow_text(schema, &["as-placed", "straight"]);
}

/// The placed shape; it has no keys of its own.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "as-placed")]
pub struct AsPlaced {}

/// A straight line.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "straight")]
pub struct Straight {
    /// First point.
    pub start: Option<Vector<Length>>,
    /// Last point.
    pub end: Option<Vector<Length>>,
}

/// Constant natural curvature and twist.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "curved")]
pub struct Curved {
    /// Natural curvatures about the first and the second material director. Default: none.
    pub curvature: Option<[Quantity<Curvature>; 2]>,
    /// Natural twist per length. Default: 0.
    pub twist: Option<Quantity<Twist>>,
}

/// A helix; give `start` or `centre`, and `turns` or `length`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "helix")]
pub struct Helix {
    /// First point of the helix itself.
    pub start: Option<Vector<Length>>,
    /// Point of the axis beside the first point of the helix.
    pub centre: Option<Vector<Length>>,
    /// Direction of the axis. Default: [0, 0, 1].
    pub axis: Option<Vector<Dimensionless>>,
    /// Radius of the helix.
    pub radius: Option<Quantity<Length>>,
    /// Advance along the axis per turn.
    pub pitch: Option<Quantity<Length>>,
    /// Number of turns.
    pub turns: Option<Quantity<Dimensionless>>,
    /// Length along the axis.
    pub length: Option<Quantity<Length>>,
    /// "right" (the default, an ordinary screw) or "left".
    pub handedness: Option<Handedness>,
    /// Angle of the first point about the axis, from the direction of x (of y about an axis along x).
    /// Default: 0.
    pub phase: Option<Quantity<Angle>>,
}

/// An arc of a circle that begins at `start` along `tangent` and turns about `normal`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "arc")]
pub struct Arc {
    /// First point.
    pub start: Option<Vector<Length>>,
    /// Direction at the first point.
    pub tangent: Option<Vector<Dimensionless>>,
    /// Direction about which the arc turns; its part normal to `tangent` counts.
    pub normal: Option<Vector<Dimensionless>>,
    /// Radius of the circle.
    pub radius: Option<Quantity<Length>>,
    /// Angle turned, greater than 0.
    pub angle: Option<Quantity<Angle>>,
}

/// A closed circle.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "ring")]
pub struct Ring {
    /// Centre.
    pub centre: Option<Vector<Length>>,
    /// Direction about which the ring runs. Default: [0, 0, 1].
    pub normal: Option<Vector<Dimensionless>>,
    /// Radius of the circle.
    pub radius: Option<Quantity<Length>>,
}

/// A chain that hangs between two points: near the equilibrium of a heavy, soft rod, which starts there without a fall.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "catenary")]
pub struct Catenary {
    /// First point.
    pub start: Option<Vector<Length>>,
    /// Last point; not above or below the first.
    pub end: Option<Vector<Length>>,
    /// Length of the chain, greater than the distance of its ends.
    pub length: Option<Quantity<Length>>,
    /// Direction in which it hangs. Default: [0, 0, -1].
    pub down: Option<Vector<Dimensionless>>,
}

/// A rod that is longer than its ends are apart, laid in the arc of a circle between them; its edges are equal and have exactly
/// the stated length together.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "slack")]
pub struct Slack {
    /// First point.
    pub start: Option<Vector<Length>>,
    /// Last point.
    pub end: Option<Vector<Length>>,
    /// Length of the rod, greater than the distance of its ends and at most a thousand times that.
    pub length: Option<Quantity<Length>>,
    /// Direction in which its middle lies off the line of its ends; its part normal to that line counts.
    pub towards: Option<Vector<Dimensionless>>,
}

/// A rod coiled flat, in a spiral of Archimedes from its inner end outwards; its edges are equal and have exactly the stated
/// length together.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "coil")]
pub struct Coil {
    /// Middle of the coil.
    pub centre: Option<Vector<Length>>,
    /// Direction about which it winds. Default: [0, 0, 1].
    pub normal: Option<Vector<Dimensionless>>,
    /// Distance of its inner end from the middle.
    pub inner_radius: Option<Quantity<Length>>,
    /// Distance of neighbouring turns from each other, greater than the diameter of the rod.
    pub spacing: Option<Quantity<Length>>,
    /// Length of the rod; it has as many turns as that makes.
    pub length: Option<Quantity<Length>>,
    /// Angle of the inner end about the normal, from the direction of x (of y about a normal along x). Default: 0.
    pub phase: Option<Quantity<Angle>>,
}

/// A polyline; give `file` or `points`. With `edges` it is resampled to equal arc lengths, which cuts corners between nodes
/// and shortens the rod; `rodlab check` warns from 0.01 % on.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "points")]
pub struct Points {
    /// CSV file with a header line and columns x, y, z in m, relative to the scenario file.
    pub file: Option<String>,
    /// The corners themselves.
    pub points: Option<Vec<Vector<Length>>>,
}
