//! Piecewise linear functions of a time or a place, constant outside of their corners.

use super::{UnitQuaternion, rotation};

/// Value at time `t` of a piecewise linear function given by its corners, constant outside them.
pub fn piecewise_linear<T>(corners: &[(f64, T)], t: f64) -> Option<T>
where
    T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
{
    let (a, b, fraction) = piece(corners, t)?;
    Some(a * (1.0 - fraction) + b * fraction)
}

/// Orientation at time `t` of a path given by its corners, constant outside them.
pub(crate) fn piecewise_turning(
    corners: &[(f64, UnitQuaternion)],
    t: f64,
) -> Option<UnitQuaternion> {
    let (a, b, fraction) = piece(corners, t)?;
    let difference = a.inverse() * b;
    Some(a * rotation::from_vector(rotation::to_vector(&difference) * fraction))
}

/// The corners on both sides of time `t`, and the position of `t` between them as a fraction.
fn piece<T: Copy>(corners: &[(f64, T)], t: f64) -> Option<(T, T, f64)> {
    let (first, last) = (corners.first()?, corners.last()?);
    if t <= first.0 {
        return Some((first.1, first.1, 0.0));
    }
    if t >= last.0 {
        return Some((last.1, last.1, 0.0));
    }
    // A NaN time, as after an overflow, is in no piece: the value is then NaN.
    let after = corners
        .partition_point(|corner| corner.0 <= t)
        .clamp(1, corners.len() - 1);
    let ((t0, a), (t1, b)) = (corners[after - 1], corners[after]);
    Some((a, b, (t - t0) / (t1 - t0)))
}

/// Slope of a piecewise linear function to the left of a place; 0 outside of its corners. An
/// implicit step that ends at a corner has the slope of the step.
pub(crate) fn piecewise_slope(corners: &[(f64, f64)], at: f64) -> f64 {
    let after = corners.partition_point(|corner| corner.0 < at);
    if after == 0 || after == corners.len() {
        return 0.0;
    }
    let ([x0, y0], [x1, y1]) = (corners[after - 1].into(), corners[after].into());
    (y1 - y0) / (x1 - x0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_that_is_no_number_does_not_panic() {
        let corners = [(0.0, 1.0), (1.0, 2.0), (3.0, 0.0)];
        assert_eq!(piecewise_linear(&corners, 2.0), Some(1.0));
        let value = piecewise_linear(&corners, f64::NAN);
        assert!(value.is_some_and(f64::is_nan), "{value:?}");
        // A single corner gives a constant function.
        assert_eq!(piecewise_linear(&corners[..1], 7.0), Some(1.0));
    }
}
