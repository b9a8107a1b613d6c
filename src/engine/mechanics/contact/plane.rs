//! Rigid planes.

use super::directed_friction::DirectedFriction;
use crate::mechanics::Vector3;

/// A rigid half space, free on the side of its `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPlane {
    /// Any point of the surface.
    pub point: Vector3,
    /// Unit normal.
    pub normal: Vector3,
    /// Own friction coefficient, if it has one; the largest if it depends on the direction.
    pub friction: Option<f64>,
    /// Friction coefficients by the direction of sliding, if they differ.
    pub directed_friction: Option<DirectedFriction>,
}

impl ContactPlane {
    /// Distance of a position from the plane, m; negative behind it.
    pub(super) fn distance(&self, position: &Vector3) -> f64 {
        (position - self.point).dot(&self.normal)
    }
}
