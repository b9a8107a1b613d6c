//! Rotations from their vectors and back: θ = φ a for a rotation by φ about the unit vector a.
//!
//! nalgebra provides all of these, but uses sines of the C library, which may differ in the last
//! bit between libraries.

use super::{Matrix3, UnitQuaternion, Vector3};
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
pub(crate) fn angle(rotation: &UnitQuaternion) -> f64 {
    2.0 * libm::atan2(rotation.imag().norm(), rotation.w.abs())
}

/// The left Jacobian of the rotation group: a change dφ of the rotation vector φ rotates the body
/// by J dφ, in fixed axes,
///
/// ```text
/// J(φ) = 1 + a [φ]× + b [φ]×²,     a = (1 − cos φ)/φ²,     b = (φ − sin φ)/φ³
/// ```
pub(crate) fn left_jacobian(vector: &Vector3) -> Matrix3 {
    let [a, b, _, _] = coefficients(vector.norm());
    let cross = vector.cross_matrix();
    Matrix3::identity() + cross * a + cross * cross * b
}

/// Derivative with respect to φ of Jᵀ(φ) T = T − a φ×T + b φ×(φ×T) for a constant moment T.
pub(crate) fn left_jacobian_derivative(vector: &Vector3, moment: &Vector3) -> Matrix3 {
    let [a, b, a_slope, b_slope] = coefficients(vector.norm());
    let cross = vector.cross(moment);
    let twice = vector.cross(&cross);
    moment.cross_matrix() * a
        - (cross.cross_matrix() + vector.cross_matrix() * moment.cross_matrix()) * b
        + (twice * b_slope - cross * a_slope) * vector.transpose()
}

/// The inverse of the left Jacobian, which is finite up to a whole turn:
///
/// ```text
/// J⁻¹(φ) = 1 − ½ [φ]× + e [φ]×²,     e = (1 − ½ φ cot ½ φ)/φ²
/// ```
pub(crate) fn inverse_left_jacobian(vector: &Vector3) -> Matrix3 {
    let square = vector.norm_squared();
    let coefficient = if square < 1e-2 {
        // Five terms of the series: the next is below rounding error.
        let terms: [f64; 5] = [
            1.0 / 12.0,
            1.0 / 720.0,
            1.0 / 30240.0,
            1.0 / 1209600.0,
            1.0 / 47900160.0,
        ];
        (terms.iter().rev()).fold(0.0, |sum, term| sum * square + term)
    } else {
        let half = 0.5 * square.sqrt();
        let (sine, cosine) = libm::sincos(half);
        (1.0 - half * cosine / sine) / square
    };
    let cross = vector.cross_matrix();
    Matrix3::identity() - cross * 0.5 + cross * cross * coefficient
}

/// The factors a and b, and their derivatives with respect to φ divided by φ.
fn coefficients(angle: f64) -> [f64; 4] {
    let square = angle * angle;
    if square < 1e-2 {
        // Five terms of each series: the next is below rounding error.
        let series = |terms: [f64; 5]| {
            terms
                .iter()
                .rev()
                .fold(0.0, |sum, term| sum * square + term)
        };
        return [
            series([
                1.0 / 2.0,
                -1.0 / 24.0,
                1.0 / 720.0,
                -1.0 / 40320.0,
                1.0 / 3628800.0,
            ]),
            series([
                1.0 / 6.0,
                -1.0 / 120.0,
                1.0 / 5040.0,
                -1.0 / 362880.0,
                1.0 / 39916800.0,
            ]),
            series([
                -1.0 / 12.0,
                1.0 / 180.0,
                -1.0 / 6720.0,
                1.0 / 453600.0,
                -1.0 / 47900160.0,
            ]),
            series([
                -1.0 / 60.0,
                1.0 / 1260.0,
                -1.0 / 60480.0,
                1.0 / 4989600.0,
                -1.0 / 622702080.0,
            ]),
        ];
    }
    let (sine, cosine) = libm::sincos(angle);
    let a = (1.0 - cosine) / square;
    let b = (angle - sine) / (angle * square);
    [
        a,
        b,
        (sine / angle - 2.0 * a) / square,
        (a - 3.0 * b) / square,
    ]
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
    /// The matrix that acts on (x, y, z, 1), in column-major order.
    pub fn matrix(&self) -> [f64; 16] {
        let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| self.rotation * axis);
        let [a, b, c] = columns;
        let t = self.translation;
        [
            a.x, a.y, a.z, 0.0, b.x, b.y, b.z, 0.0, c.x, c.y, c.z, 0.0, t.x, t.y, t.z, 1.0,
        ]
    }

    /// Position of a point of the body.
    pub fn of(&self, point: &Vector3) -> Vector3 {
        self.rotation * point + self.translation
    }

    /// The point of the body at a position.
    pub(crate) fn back_of(&self, point: &Vector3) -> Vector3 {
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
        // Half a turn has two rotation vectors; either is correct.
        let half = to_vector(&from_vector(PI * direction));
        assert!(
            (half - PI * direction)
                .norm()
                .min((half + PI * direction).norm())
                < 1e-15
        );
    }

    #[test]
    fn a_change_of_the_vector_turns_by_its_jacobian() {
        let change = Vector3::new(0.3, 0.5, -0.2);
        let moment = Vector3::new(-0.7, 0.4, 1.1);
        for size in [0.0, 1e-3, 0.0999, 0.1001, 0.7, 2.5, 3.1] {
            let vector = Vector3::new(0.48, 0.6, -0.64) * size;
            let step = 1e-5;
            let ends = [step, -step].map(|step| from_vector(vector + change * step));
            let turned = to_vector(&(ends[0] * ends[1].inverse())) / (2.0 * step);
            assert!(
                (turned - left_jacobian(&vector) * change).norm() < 1e-9,
                "{size}"
            );
            let of = |step: f64| left_jacobian(&(vector + change * step)).transpose() * moment;
            let slope = (of(step) - of(-step)) / (2.0 * step);
            let found = left_jacobian_derivative(&vector, &moment) * change;
            assert!((slope - found).norm() < 1e-9, "{size}: {slope} {found}");
            let inverse = inverse_left_jacobian(&vector) * left_jacobian(&vector);
            let error = (inverse - Matrix3::identity()).amax();
            assert!(error < 1e-13, "{size}: {error:e}");
        }
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
