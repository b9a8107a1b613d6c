//! Clamps as typed.

use crate::scenario::place::TypedPlace;
use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::resolved::Hold;
use crate::scenario::units::{Angle, AngularVelocity, Dimensionless, Length, Time};
use schemars::JsonSchema;

/// A held or driven node.
#[derive(Debug, Default, serde::Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "clamp")]
pub struct Clamp {
    /// Name of the rod.
    pub rod: Option<String>,
    /// "start", "end", or the number of a node, counted from zero.
    pub at: Option<TypedPlace>,
    /// "position", "frame" (tangent and material frame), or "both" (the default).
    pub hold: Option<Hold>,
    /// Displacement at given times, [[time, [x, y, z]], ...], linear between them and constant outside. Default: none.
    #[serde(rename = "move")]
    pub translation: Option<Vec<(Quantity<Time>, Vector<Length>)>>,
    /// Angle about the axis at given times, [[time, angle], ...], linear between them. Default: 0 always.
    #[serde(rename = "turn")]
    pub angle: Option<Vec<(Quantity<Time>, Quantity<Angle>)>>,
    /// Steady rate of turning about the axis, added to `turn`. Default: 0.
    pub angular_velocity: Option<Quantity<AngularVelocity>>,
    /// Direction about which the clamp turns. Default: the tangent of the rod at the node.
    pub axis: Option<Vector<Dimensionless>>,
    /// Fixed point of the rotation. Default: the node.
    pub pivot: Option<Vector<Length>>,
    /// CSV file of the poses of a gripper that holds the node, relative to the scenario file: columns time_s, x_m,
    /// y_m, z_m and the quaternion qw, qx, qy, qz. The node moves with the gripper as one rigid body; its place at
    /// the first pose is that where the rod was placed. Instead of `move`, `turn`, `axis` and `pivot`.
    pub follow: Option<String>,
    /// The poses themselves, [[time, [x, y, z], [qw, qx, qy, qz]], ...]: positions go straight between them,
    /// orientations the shorter way at constant speed.
    pub poses: Option<Vec<Pose>>,
}

/// Time, position and orientation (unit quaternion qw, qx, qy, qz) of a gripper.
pub type Pose = (Quantity<Time>, Vector<Length>, [Quantity<Dimensionless>; 4]);
