//! Clamps, loads and planes as typed.

use crate::scenario::place::TypedPlace;
use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::resolved::{Hold, LoadFrame};
use crate::scenario::units::{
    Acceleration, Angle, AngularVelocity, Dimensionless, Force, ForcePerLength, Length, LinearDrag,
    Moment, SpinDrag, Time,
};
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

/// Corners of a piecewise linear factor: [[time, factor], ...].
pub type Schedule = Vec<(Quantity<Time>, Quantity<Dimensionless>)>;

/// An external load.
#[derive(Debug, serde::Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", deny_unknown_fields, rename = "load")]
pub enum Load {
    /// Weight of every rod.
    Gravity {
        /// Acceleration of free fall, for example [0, 0, -9.81].
        acceleration: Option<Vector<Acceleration>>,
        /// Factor at given times, [[time, factor], ...], linear between them. Default: 1 always.
        schedule: Option<Schedule>,
    },
    /// A force on a node.
    Force {
        /// Name of the rod.
        rod: Option<String>,
        /// "start", "end", or the number of a node.
        at: Option<TypedPlace>,
        /// The force.
        force: Option<Vector<Force>>,
        /// "space" (the default: a fixed direction), or "material": components along the two material directors and the
        /// tangent of the rod, with which the load turns.
        frame: Option<LoadFrame>,
        /// Factor at given times, [[time, factor], ...], linear between them. Default: 1 always.
        schedule: Option<Schedule>,
    },
    /// A moment on an edge.
    Moment {
        /// Name of the rod.
        rod: Option<String>,
        /// "start", "end", or the number of an edge.
        at: Option<TypedPlace>,
        /// The moment.
        moment: Option<Vector<Moment>>,
        /// "space" (the default: a fixed direction), or "material": components along the two material directors and the
        /// tangent of the rod, with which the load turns.
        frame: Option<LoadFrame>,
        /// Factor at given times, [[time, factor], ...], linear between them. Default: 1 always.
        schedule: Option<Schedule>,
    },
    /// A force per natural length.
    Distributed {
        /// Name of the rod. Default: all rods.
        rod: Option<String>,
        /// Force per length.
        force_per_length: Option<Vector<ForcePerLength>>,
        /// "space" (the default: a fixed direction), or "material": components along the two material directors and the
        /// tangent of the rod, with which the load turns.
        frame: Option<LoadFrame>,
        /// Factor at given times, [[time, factor], ...], linear between them. Default: 1 always.
        schedule: Option<Schedule>,
    },
    /// Drag against velocity and spin, at least one of them.
    Drag {
        /// Name of the rod. Default: all rods.
        rod: Option<String>,
        /// Coefficient of the velocity per length. Default: 0.
        translation: Option<Quantity<LinearDrag>>,
        /// Coefficient of the spin per length. Default: 0.
        rotation: Option<Quantity<SpinDrag>>,
        /// Factor at given times, [[time, factor], ...], linear between them. Default: 1 always.
        schedule: Option<Schedule>,
    },
}

/// A rigid half space that rods may touch.
#[derive(Debug, Default, serde::Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "plane")]
pub struct Plane {
    /// Any point of the surface. Default: the origin.
    pub point: Option<Vector<Length>>,
    /// Direction out of the surface into the free side. Default: [0, 0, 1].
    pub normal: Option<Vector<Dimensionless>>,
    /// Friction coefficient between plane and rods. Default: that of [contact].
    pub friction: Option<Quantity<Dimensionless>>,
    /// Whether the plane is a no-slip wall of the flow, at which the fluid of the model "rss" is at rest. At most one plane can
    /// be; false leaves the plane out of the flow, which then passes through it. Default: true with the model "rss",
    /// otherwise false.
    pub wall: Option<bool>,
}
