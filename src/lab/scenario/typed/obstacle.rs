//! Obstacles as typed.

use super::load::Pose;
use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::units::{Angle, AngularVelocity, Dimensionless, Length, Time};
use schemars::JsonSchema;
use serde::Deserialize;

/// A rigid body that rods may touch, fixed or moved.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "obstacle")]
pub struct Obstacle {
    /// Name by which probes and messages call it. Default: "obstacle 0", "obstacle 1", ...
    pub name: Option<String>,
    /// Its shape, and where it is at time zero.
    pub shape: Option<ObstacleShape>,
    /// Friction coefficient between obstacle and rods. Default: that of [contact].
    pub friction: Option<Quantity<Dimensionless>>,
    /// Displacement at given times, [[time, [x, y, z]], ...], linear between them and constant outside. Default: none.
    #[serde(rename = "move")]
    pub translation: Option<Vec<(Quantity<Time>, Vector<Length>)>>,
    /// Angle about the axis at given times, [[time, angle], ...], linear between them. Default: 0 always.
    #[serde(rename = "turn")]
    pub angle: Option<Vec<(Quantity<Time>, Quantity<Angle>)>>,
    /// Steady rate of turning about the axis, added to `turn`. Default: 0.
    pub angular_velocity: Option<Quantity<AngularVelocity>>,
    /// Direction about which it turns. Default: [0, 0, 1].
    pub axis: Option<Vector<Dimensionless>>,
    /// Fixed point of the rotation. Default: the centre of its shape, the mean of the vertices of a mesh.
    pub pivot: Option<Vector<Length>>,
    /// CSV file of poses that it follows as one rigid body, relative to the scenario file: columns time_s, x_m, y_m, z_m and
    /// the quaternion qw, qx, qy, qz. At the first pose it is where its shape says. Instead of `move`, `turn`, `axis` and
    /// `pivot`.
    pub follow: Option<String>,
    /// The poses themselves, [[time, [x, y, z], [qw, qx, qy, qz]], ...].
    pub poses: Option<Vec<Pose>>,
}

/// The shape of an obstacle.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", rename = "obstacle_shape")]
pub enum ObstacleShape {
    /// A sphere.
    Sphere(Sphere),
    /// A cylinder with round ends.
    Capsule(Capsule),
    /// A cylinder without ends.
    Cylinder(Cylinder),
    /// The inside of a tube, open at both ends.
    Tube(Capsule),
    /// A box, with rounded edges if asked.
    Box(Cuboid),
    /// A triangle mesh.
    Mesh(Mesh),
    /// A surface z(x, y) over a grid, touched from both sides.
    Heights(Heights),
}

/// A sphere.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "sphere")]
pub struct Sphere {
    /// Centre.
    pub centre: Option<Vector<Length>>,
    /// Radius.
    pub radius: Option<Quantity<Length>>,
}

/// A cylinder with round ends: all points within the radius of a segment; or the inside of a tube, with its inner radius.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "capsule")]
pub struct Capsule {
    /// First end of the segment.
    pub start: Option<Vector<Length>>,
    /// Last end.
    pub end: Option<Vector<Length>>,
    /// Radius.
    pub radius: Option<Quantity<Length>>,
}

/// A cylinder without ends.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "cylinder")]
pub struct Cylinder {
    /// Any point of its axis.
    pub point: Option<Vector<Length>>,
    /// Direction of its axis.
    pub direction: Option<Vector<Dimensionless>>,
    /// Radius.
    pub radius: Option<Quantity<Length>>,
}

/// A box. Its sides lie along x, y and z, unless it is turned.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "box")]
pub struct Cuboid {
    /// Centre.
    pub centre: Option<Vector<Length>>,
    /// Lengths of the three sides, from surface to surface.
    pub size: Option<Vector<Length>>,
    /// Radius to which its edges are rounded, less than half of the shortest side. Default: 0.
    pub rounding: Option<Quantity<Length>>,
    /// Direction about which it is turned. Default: [0, 0, 1].
    pub axis: Option<Vector<Dimensionless>>,
    /// Angle by which it is turned about its centre. Default: 0.
    pub angle: Option<Quantity<Angle>>,
}

/// A triangle mesh; give `file`, or `vertices` and `triangles`. It is scaled first, turned then, and moved last.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "mesh")]
pub struct Mesh {
    /// STL or OBJ file, relative to the scenario file.
    pub file: Option<String>,
    /// Length of a unit of the file, for example "1 mm". Default: 1 m.
    pub unit: Option<Quantity<Length>>,
    /// Where the origin of the file lies. Default: [0, 0, 0].
    pub position: Option<Vector<Length>>,
    /// Direction about which it is turned. Default: [0, 0, 1].
    pub axis: Option<Vector<Dimensionless>>,
    /// Angle by which it is turned about the origin of the file. Default: 0.
    pub angle: Option<Quantity<Angle>>,
    /// The vertices themselves, in m.
    pub vertices: Option<Vec<[f64; 3]>>,
    /// Three vertices of each triangle, counted from 0, anticlockwise as seen from outside.
    pub triangles: Option<Vec<[i64; 3]>>,
    /// Whether the triangles enclose a body, which rods touch from outside; false for a sheet, which they touch from both
    /// sides. Default: true.
    pub closed: Option<bool>,
}

/// A surface over a grid along x and y.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "heights")]
pub struct Heights {
    /// Where the first height stands. Default: [0, 0, 0].
    pub origin: Option<Vector<Length>>,
    /// Distance of neighbours in the grid.
    pub spacing: Option<Quantity<Length>>,
    /// Heights above the origin: rows along y of values along x, at least two of each.
    pub heights: Option<Vec<Vec<Quantity<Length>>>>,
}
