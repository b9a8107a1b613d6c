//! Rigid bodies that no rod carries.

use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::{UnitQuaternion, Vector3};

/// A rigid body that moves freely, and touches rods, planes, obstacles and other bodies.
///
/// It follows the rods of a scene in the numbering: its first node is its centre of mass, and the
/// others are the vertices of its shape.
#[derive(Clone, Debug)]
pub struct FreeBody {
    /// Name in scenarios and messages.
    pub name: String,
    /// Shape as placed.
    pub shape: RigidBody,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass as placed, m.
    pub centre: Vector3,
    /// Principal moments of inertia, kg m².
    pub inertia: [f64; 3],
    /// Rotates x, y and z to the principal axes as placed.
    pub axes: UnitQuaternion,
    /// Velocity of the centre of mass at time zero, m/s.
    pub velocity: Vector3,
    /// Angular velocity at time zero, rad/s.
    pub angular_velocity: Vector3,
}

impl FreeBody {
    /// Largest distance of a vertex from the centre of mass, m; for a ball its radius.
    pub fn reach(&self) -> f64 {
        let arms = self.shape.vertices.iter().map(|x| (x - self.centre).norm());
        arms.fold(self.shape.radius, f64::max)
    }

    /// Number of its nodes: the centre of mass and the vertices.
    pub fn nodes(&self) -> usize {
        1 + self.shape.vertices.len()
    }
}
