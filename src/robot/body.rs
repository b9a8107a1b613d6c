//! Shapes of links for collision checks.

use super::pose::Pose;
use nalgebra::{Translation3, UnitQuaternion, Vector3};

/// A shape that moves with a link.
#[derive(Clone, Debug)]
pub struct Body {
    /// Index of the chain's segment that carries it; `None` for the base.
    pub link: Option<usize>,
    /// Pose in the frame of that link.
    pub pose: Pose,
    /// Its shape.
    pub shape: Shape,
}

/// A convex shape about its own origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// All points within `radius` of a line along z, m; a ball where that has no length.
    Capsule {
        /// Half the length of the line.
        half_length: f64,
        /// Radius.
        radius: f64,
    },
    /// A box, m.
    Box {
        /// Half its sides along x, y and z.
        half: [f64; 3],
    },
}

impl Body {
    /// A capsule between two points of a link's frame, m.
    pub fn capsule(link: Option<usize>, from: [f64; 3], to: [f64; 3], radius: f64) -> Self {
        let (from, to) = (Vector3::from(from), Vector3::from(to));
        let along = to - from;
        let rotation =
            UnitQuaternion::rotation_between(&Vector3::z(), &along).unwrap_or_else(|| {
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
            });
        Self {
            link,
            pose: Pose::from_parts(Translation3::from(0.5 * (from + to)), rotation),
            shape: Shape::Capsule {
                half_length: 0.5 * along.norm(),
                radius,
            },
        }
    }
}
