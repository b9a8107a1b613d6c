//! Free rigid bodies, their axles, and the rods that are joined to them.

use super::{JointKind, RodNode};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::{UnitQuaternion, Vector3};

/// A rigid body that moves freely or turns about an axle, and touches rods, planes, obstacles and
/// other bodies.
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
    /// Own friction coefficient, if it has one.
    pub friction: Option<f64>,
    /// The axle about which alone it turns; `None` if it moves freely.
    pub axle: Option<Axle>,
    /// Rods that are joined to it.
    pub joints: Vec<BodyJoint>,
}

/// An axle through the centre of mass of a body, which does not move.
#[derive(Clone, Debug, PartialEq)]
pub struct Axle {
    /// Unit vector.
    pub direction: Vector3,
    /// Moment of inertia of the body about it, kg m².
    pub inertia: f64,
    /// Largest moment of the friction in its bearing, N m.
    pub brake: f64,
    /// Moment about it at given times, [(s, N m), ...]: linear between them and constant outside;
    /// 0 if empty.
    pub torque: Vec<(f64, f64)>,
}

/// A node of a rod that is, from time zero on, a point of a free body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyJoint {
    /// The node, where it is placed.
    pub at: RodNode,
    /// Relative motion that the joint leaves free; not sliding.
    pub kind: JointKind,
}

impl FreeBody {
    /// Largest distance of a vertex from the centre of mass, m; for a ball its radius.
    pub fn reach(&self) -> f64 {
        let arms = self.shape.vertices.iter().map(|x| (x - self.centre).norm());
        arms.fold(self.shape.radius, f64::max)
    }

    /// Whether a moment drives it about its axle.
    pub(crate) fn is_driven(&self) -> bool {
        (self.axle.as_ref()).is_some_and(|axle| !axle.torque.is_empty())
    }

    /// Velocity of a point of the body at time zero, m/s.
    pub(crate) fn velocity_at(&self, point: &Vector3) -> Vector3 {
        self.velocity + self.angular_velocity.cross(&(point - self.centre))
    }

    /// Number of its nodes: the centre of mass and the vertices.
    pub fn nodes(&self) -> usize {
        1 + self.shape.vertices.len()
    }
}
