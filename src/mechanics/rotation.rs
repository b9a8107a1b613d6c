//! Rotations from their vectors and back, θ = φ a for a turn by φ about the unit vector a.
//!
//! nalgebra has all of these; but it takes sines from the C library, and two of those differ in the last bit.

use super::{UnitQuaternion, Vector3};
use nalgebra::Quaternion;

/// The rotation of a rotation vector (rad): q = (cos φ/2, a sin φ/2).
pub fn from_vector(vector: Vector3) -> UnitQuaternion {
    let angle = vector.norm();
    if angle == 0.0 {
        return UnitQuaternion::identity();
    }
    let (sine, cosine) = libm::sincos(0.5 * angle);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cosine, vector * (sine / angle)))
}

/// The rotation vector of a rotation (rad), whose length is at most π.
pub fn to_vector(rotation: &UnitQuaternion) -> Vector3 {
    let sine = rotation.imag().norm();
    if sine == 0.0 {
        return Vector3::zeros();
    }
    let angle = angle(rotation);
    rotation.imag() * (angle.copysign(rotation.w) / sine)
}

/// The angle of a rotation, 0 to π.
pub fn angle(rotation: &UnitQuaternion) -> f64 {
    2.0 * libm::atan2(rotation.imag().norm(), rotation.w.abs())
}

/// A rigid motion of a body: x = R x₀ + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation R.
    pub rotation: UnitQuaternion,
    /// The translation t, m.
    pub translation: Vector3,
}

impl Default for Pose {
    fn default() -> Self {
        Self {
            rotation: UnitQuaternion::identity(),
            translation: Vector3::zeros(),
        }
    }
}

impl Pose {
    /// The matrix that acts on (x, y, z, 1), column after column.
    pub fn matrix(&self) -> [f64; 16] {
        let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| self.rotation * axis);
        let [a, b, c] = columns;
        let t = self.translation;
        [
            a.x, a.y, a.z, 0.0, b.x, b.y, b.z, 0.0, c.x, c.y, c.z, 0.0, t.x, t.y, t.z, 1.0,
        ]
    }

    /// Where a point of the body is.
    pub fn of(&self, point: &Vector3) -> Vector3 {
        self.rotation * point + self.translation
    }

    /// The point of the body that is there.
    pub fn back_of(&self, point: &Vector3) -> Vector3 {
        self.rotation.inverse() * (point - self.translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn vectors_and_rotations_are_those_of_nalgebra() {
        let direction = Vector3::new(0.36, -0.48, 0.8);
        for degrees in -180_i32..=180 {
            let vector = direction * f64::from(degrees).to_radians();
            let expected = UnitQuaternion::from_scaled_axis(vector);
            let found = from_vector(vector);
            assert!((found.coords - expected.coords).norm() < 4e-16);
            assert!((angle(&found) - vector.norm()).abs() < 1e-15);
            if degrees.abs() < 180 {
                assert!((to_vector(&found) - vector).norm() < 1e-15, "{degrees}");
            }
        }
        // Of the two vectors of a half turn either will do.
        let half = to_vector(&from_vector(PI * direction));
        assert!(
            (half - PI * direction)
                .norm()
                .min((half + PI * direction).norm())
                < 1e-15
        );
    }

    #[test]
    fn small_and_no_rotations_are_exact() {
        assert_eq!(to_vector(&from_vector(Vector3::zeros())), Vector3::zeros());
        for size in [1e-150, 1e-20, 1e-9] {
            let vector = Vector3::new(2.0 * size, -size, 2.0 * size);
            let back = to_vector(&from_vector(vector));
            assert!((back - vector).norm() <= 1e-15 * vector.norm(), "{size}");
        }
        // −q is the same rotation.
        let rotation = from_vector(Vector3::new(0.1, 0.2, 0.3));
        let negative = UnitQuaternion::new_unchecked(-rotation.into_inner());
        assert!((to_vector(&negative) - to_vector(&rotation)).norm() < 1e-16);
    }
}
