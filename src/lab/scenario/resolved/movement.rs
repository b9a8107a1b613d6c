//! Resolved motion of a clamp or an obstacle.

use serde::Serialize;

/// Time in s, position in m, and orientation as a unit quaternion (w, x, y, z).
pub type Pose = (f64, [f64; 3], [f64; 4]);

/// A prescribed motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Movement {
    /// Displacement in m at given times in s, piecewise linear.
    #[serde(rename = "move", skip_serializing_if = "Vec::is_empty")]
    pub translation: Vec<(f64, [f64; 3])>,
    /// Angle in rad at given times in s, piecewise linear.
    #[serde(rename = "turn", skip_serializing_if = "Vec::is_empty")]
    pub angle: Vec<(f64, f64)>,
    /// Constant angular velocity, rad/s.
    pub angular_velocity: f64,
    /// Unit vector along the axis of rotation; `None` is the default axis of the moved object.
    pub axis: Option<[f64; 3]>,
    /// Fixed point of the rotation; `None` is the default point of the moved object.
    pub pivot: Option<[f64; 3]>,
    /// Poses that are followed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub poses: Vec<Pose>,
}

impl Movement {
    /// Whether anything moves.
    pub fn moves(&self) -> bool {
        !self.translation.is_empty()
            || !self.angle.is_empty()
            || self.angular_velocity != 0.0
            || !self.poses.is_empty()
    }
}
