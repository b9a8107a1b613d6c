//! Obstacles as resolved.

use super::movement::Movement;
use serde::Serialize;

/// A rigid body that rods may touch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Obstacle {
    /// Name of the obstacle.
    pub name: String,
    /// Shape of the obstacle at time zero.
    pub shape: ObstacleShape,
    /// Friction coefficient; `None` takes that of the contact model.
    pub friction: Option<f64>,
    /// Motion of the obstacle.
    #[serde(flatten)]
    pub movement: Movement,
}

/// The shape of an obstacle.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ObstacleShape {
    /// All points within a radius of a point.
    Sphere {
        /// The point, m.
        centre: [f64; 3],
        /// The radius, m.
        radius: f64,
    },
    /// All points within a radius of a segment.
    Capsule {
        /// First end of the capsule, m.
        start: [f64; 3],
        /// Last end of the capsule, m.
        end: [f64; 3],
        /// The radius, m.
        radius: f64,
    },
    /// The inside of a tube.
    Tube {
        /// First end of its axis, m.
        start: [f64; 3],
        /// Last end, m.
        end: [f64; 3],
        /// Inner radius, m.
        radius: f64,
    },
    /// All points within a radius of a line.
    Cylinder {
        /// A point of the line, m.
        point: [f64; 3],
        /// Direction of the cylinder, a unit vector.
        direction: [f64; 3],
        /// The radius, m.
        radius: f64,
    },
    /// A box.
    Box {
        /// Centre of the box, m.
        centre: [f64; 3],
        /// Lengths of its sides, m.
        size: [f64; 3],
        /// Radius of its edges, m.
        rounding: f64,
        /// Unit vector along the axis of its rotation.
        axis: [f64; 3],
        /// Angle of its rotation, rad.
        angle: f64,
    },
    /// A triangle mesh.
    Mesh {
        /// Vertices of the mesh, m.
        vertices: Vec<[f64; 3]>,
        /// Three vertices of each triangle.
        triangles: Vec<[usize; 3]>,
        /// Whether the mesh encloses a body.
        closed: bool,
        /// Whether the mesh stands for a smooth surface.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        smooth: bool,
        /// Angle between triangles above which their common side is a crease of a smooth surface,
        /// rad; `None` for a mesh that is not smooth.
        #[serde(skip_serializing_if = "Option::is_none")]
        crease_angle: Option<f64>,
    },
}
