//! Parallel transport of directors, and the angle that remains after it.

use crate::mechanics::Vector3;

/// Parallel transport of `director` (normal to the unit vector `from`) along the shortest rotation that
/// takes `from` to `to`: P v = v − (v·to)/(1 + from·to) (from + to).
#[inline(always)]
pub fn parallel_transport(director: &Vector3, from: &Vector3, to: &Vector3) -> Vector3 {
    director - (from + to) * (director.dot(to) / (1.0 + from.dot(to)))
}

/// Angle from `a` to `b` about the unit vector `axis`, in (−π, π].
pub(crate) fn signed_angle(a: &Vector3, b: &Vector3, axis: &Vector3) -> f64 {
    libm::atan2(a.cross(b).dot(axis), a.dot(b))
}

/// `angle` shifted by full turns to lie within half a turn of `near`.
pub(crate) fn unwrapped(angle: f64, near: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    if (near - angle).abs() < 0.5 * turn {
        return angle;
    }
    angle + turn * ((near - angle) / turn).round()
}

/// Any unit vector normal to the unit vector `tangent`.
pub fn any_normal(tangent: &Vector3) -> Vector3 {
    let axis = if tangent.x.abs() <= tangent.y.abs() && tangent.x.abs() <= tangent.z.abs() {
        Vector3::x()
    } else if tangent.y.abs() <= tangent.z.abs() {
        Vector3::y()
    } else {
        Vector3::z()
    };
    (axis - tangent * axis.dot(tangent)).normalize()
}

/// The part of `hint` normal to `tangent`, normalised; `None` if the two are parallel.
pub fn normal_part(hint: &Vector3, tangent: &Vector3) -> Option<Vector3> {
    let part = hint - tangent * hint.dot(tangent);
    let length = part.norm();
    (length > 1e-9 * hint.norm()).then(|| part / length)
}

/// `vector` rotated by `angle` about the unit vector `axis` (Rodrigues).
pub fn rotated(vector: &Vector3, axis: &Vector3, angle: f64) -> Vector3 {
    let (sin, cos) = libm::sincos(angle);
    vector * cos + axis.cross(vector) * sin + axis * (axis.dot(vector) * (1.0 - cos))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transport_is_the_shortest_rotation() {
        let from = Vector3::new(0.3, -0.2, 0.9).normalize();
        let to = Vector3::new(-0.5, 0.4, 0.7).normalize();
        let director = any_normal(&from);
        let moved = parallel_transport(&director, &from, &to);
        let axis = from.cross(&to);
        let expected = rotated(
            &director,
            &axis.normalize(),
            axis.norm().atan2(from.dot(&to)),
        );
        assert!((moved - expected).norm() < 1e-15);
        assert!(moved.dot(&to).abs() < 1e-15);
        assert!((moved.norm() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn angles_unwrap_to_the_nearest_turn() {
        assert!((unwrapped(3.0, -10.0) - (3.0 - 2.0 * std::f64::consts::TAU)).abs() < 1e-15);
        assert_eq!(unwrapped(0.5, 0.1), 0.5);
    }
}
