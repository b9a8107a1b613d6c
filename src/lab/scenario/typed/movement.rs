//! Typed motion of a clamp or an obstacle.

use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::units::{Angle, Dimensionless, Length, Time};

/// Time, position and orientation (unit quaternion qw, qx, qy, qz) of a gripper.
pub type Pose = (Quantity<Time>, Vector<Length>, [Quantity<Dimensionless>; 4]);
/// Displacement at given times.
pub type Translation = Vec<(Quantity<Time>, Vector<Length>)>;
/// Angle at given times.
pub type Turn = Vec<(Quantity<Time>, Quantity<Angle>)>;

/// The given keys of the motion of a clamp or an obstacle, with checked numbers.
pub struct TypedMovement<'a> {
    pub translation: &'a [(Quantity<Time>, Vector<Length>)],
    pub angle: &'a [(Quantity<Time>, Quantity<Angle>)],
    pub angular_velocity: f64,
    pub axis: Option<[f64; 3]>,
    pub pivot: Option<[f64; 3]>,
    pub follow: &'a Option<String>,
    pub poses: &'a Option<Vec<Pose>>,
}

/// Declares a table that ends with the keys of a motion.
macro_rules! moving {
    ($(#[$about:meta])* table $Typed:ident $schema:literal { $($keys:tt)* }) => {
        keys! {
            $(#[$about])*
            table $Typed $schema {
                $($keys)*
                /// Displacement at given times, [[time, [x, y, z]], ...], linear between them and constant outside. Default: none.
                #[serde(rename = "move")]
                translation: raw(Translation) raw,
                /// Angle about the axis at given times, [[time, angle], ...], linear between them. Default: 0 always.
                #[serde(rename = "turn")]
                angle: raw(Turn) raw,
                /// Constant angular velocity about the axis, added to `turn`.
                angular_velocity: number(AngularVelocity, FINITE) default(0.0),
                /// Axis of the rotation. Default: for a clamp the tangent of the rod at its node,
                /// for an obstacle [0, 0, 1].
                axis: direction() optional,
                /// Fixed point of the rotation. Default: for a clamp its node, for an obstacle the
                /// centre of its shape (for a mesh the mean of its vertices).
                pivot: vector(Length) optional,
                /// CSV file of poses to follow as a rigid body, such as the poses of a gripper;
                /// relative to the scenario file. Columns: time_s, x_m, y_m, z_m and the
                /// quaternion qw, qx, qy, qz. The first pose corresponds to the placed position.
                /// Replaces `move`, `turn`, `axis` and `pivot`.
                follow: raw(String) raw,
                /// The poses themselves, [[time, [x, y, z], [qw, qx, qy, qz]], ...]. Between two
                /// poses the position moves along a straight line, and the orientation takes the
                /// shorter rotation at constant speed.
                poses: raw(Vec<Pose>) raw,
            }
        }

        impl $Typed {
            /// Motion of the clamp or obstacle.
            pub fn movement(&self, section: &Section<'_>) -> TypedMovement<'_> {
                TypedMovement {
                    translation: self.translation.as_deref().unwrap_or_default(),
                    angle: self.angle.as_deref().unwrap_or_default(),
                    angular_velocity: self.angular_velocity(section),
                    axis: self.axis(section),
                    pivot: self.pivot(section),
                    follow: &self.follow,
                    poses: &self.poses,
                }
            }
        }
    };
}

pub(super) use moving;
