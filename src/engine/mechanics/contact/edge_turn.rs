//! Rotation of an edge of a rod at a contact with a free body.
//!
//! Friction acts at the surface of the rod, at the distance h from its centreline, so that a rod on
//! a drum that turns with it does not slip. The rotation vector of the edge since the stage began
//! is that of the smallest rotation between its directions t₀ and t,
//!
//! ```text
//! θ = q(c) t₀ × t,     c = t₀·t,     q = arccos c / √(1 − c²)
//! ```
//!
//! which has no part about the edge itself: friction does not twist the rod. A moment M on the edge
//! is a couple of forces ± M × d/d² on its ends, with the vector d between these.

use crate::mechanics::{Matrix3, Vector3};

/// 1 − c below which q and its derivative are evaluated by their series.
const NEARLY_PARALLEL: f64 = 1e-3;

/// An edge of a rod in a stage.
#[derive(Clone, Copy, Debug)]
pub(super) struct EdgeTurn {
    /// h, m.
    pub arm: f64,
    /// θ, rad.
    pub turn: Vector3,
    /// ∂θ/∂d, rad/m.
    pub by_span: Matrix3,
    /// d, m.
    span: Vector3,
}

impl EdgeTurn {
    /// The turn of an edge of radius `arm` (m) from the vector between its ends `before` to that
    /// `now`, m.
    pub(crate) fn between(before: &Vector3, now: &Vector3, arm: f64) -> Self {
        let length = now.norm();
        let (old, new) = (before.normalize(), now / length);
        let (sine, cosine) = (old.cross(&new), old.dot(&new));
        let [ratio, slope] = angle_over_sine(cosine);
        let by_direction = sine * old.transpose() * slope + old.cross_matrix() * ratio;
        let across = Matrix3::identity() - new * new.transpose();
        Self {
            arm,
            turn: sine * ratio,
            by_span: by_direction * across / length,
            span: *now,
        }
    }

    /// The force on the second end under a moment, N; that on the first end is opposite.
    pub(crate) fn couple(&self, moment: &Vector3) -> Vector3 {
        moment.cross(&self.span) / self.span.norm_squared()
    }

    /// Derivative of [`Self::couple`] for changes of the moment and of d.
    pub(crate) fn couple_rate(&self, moment: &Vector3, changed: &Vector3, by: &Vector3) -> Vector3 {
        let square = self.span.norm_squared();
        let turned = changed.cross(&self.span) + moment.cross(by);
        (turned - self.couple(moment) * (2.0 * self.span.dot(by))) / square
    }
}

/// q and its derivative.
fn angle_over_sine(cosine: f64) -> [f64; 2] {
    let rest = 1.0 - cosine;
    if rest < NEARLY_PARALLEL {
        // The next terms are below 1e-11.
        let ratio = 1.0 + rest * (1.0 / 3.0 + rest * (2.0 / 15.0 + rest * (2.0 / 35.0)));
        let slope = 1.0 / 3.0 + rest * (4.0 / 15.0 + rest * (6.0 / 35.0 + rest * (32.0 / 315.0)));
        return [ratio, -slope];
    }
    let square = (1.0 - cosine * cosine).max(f64::EPSILON);
    let ratio = libm::acos(cosine.clamp(-1.0, 1.0)) / square.sqrt();
    [ratio, (cosine * ratio - 1.0) / square]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::rotation;

    #[test]
    fn it_turns_by_the_rotation_of_a_rigid_body_and_by_its_derivative() {
        let before = Vector3::new(0.3, -0.1, 0.2);
        for size in [1e-3, 0.03, 0.05, 0.5, 2.0] {
            let axis = before.cross(&Vector3::new(0.2, 0.5, -0.3)).normalize();
            let now = rotation::from_vector(axis * size) * before * 1.2;
            let found = EdgeTurn::between(&before, &now, 0.1);
            assert!((found.turn - axis * size).norm() < 1e-11 * size, "{size}");
            for column in 0..3 {
                let moved = |by: f64| {
                    let mut now = now;
                    now[column] += by;
                    EdgeTurn::between(&before, &now, 0.1).turn
                };
                let expected = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                let error = (found.by_span.column(column) - expected).norm();
                assert!(error < 1e-7, "{size} {column}: {error:e}");
            }
        }
    }

    #[test]
    fn the_couple_has_the_moment_across_the_edge() {
        let span = Vector3::new(0.3, -0.1, 0.2);
        let edge = EdgeTurn::between(&span, &span, 0.1);
        let moment = Vector3::new(0.4, 0.2, -0.7);
        let across = moment - span * (moment.dot(&span) / span.norm_squared());
        assert!((span.cross(&edge.couple(&moment)) - across).norm() < 1e-15);
    }
}
