//! Motion of a clamp or an obstacle, as typed.

use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::units::{Angle, Dimensionless, Length, Time};

/// Time, position and orientation (unit quaternion qw, qx, qy, qz) of a gripper.
pub type Pose = (Quantity<Time>, Vector<Length>, [Quantity<Dimensionless>; 4]);
/// Displacement at given times.
pub type Translation = Vec<(Quantity<Time>, Vector<Length>)>;
/// Angle at given times.
pub type Turn = Vec<(Quantity<Time>, Quantity<Angle>)>;

/// The motion of a clamp or an obstacle: the keys given there, with their numbers checked.
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
                /// Steady rate of turning about the axis, added to `turn`.
                angular_velocity: number(AngularVelocity, FINITE) default(0.0),
                /// Direction about which it turns. Default: the tangent of the rod at the node of a clamp; [0, 0, 1] of an
                /// obstacle.
                axis: direction() optional,
                /// Fixed point of the rotation. Default: the node of a clamp; the centre of the shape of an obstacle, the mean
                /// of the vertices of a mesh.
                pivot: vector(Length) optional,
                /// CSV file of poses that it follows as one rigid body, such as those of a gripper, relative to the scenario
                /// file: columns time_s, x_m, y_m, z_m and the quaternion qw, qx, qy, qz. At the first pose it is where it was
                /// placed. Instead of `move`, `turn`, `axis` and `pivot`.
                follow: raw(String) raw,
                /// The poses themselves, [[time, [x, y, z], [qw, qx, qy, qz]], ...]: positions go straight between them,
                /// orientations the shorter way at constant speed.
                poses: raw(Vec<Pose>) raw,
            }
        }

        impl $Typed {
            /// Its motion.
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
