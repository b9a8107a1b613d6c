//! A spring between two nodes.
//!
//! With the stiffness k, the length L without force, and the vector d of length r = ‖d‖ from one
//! node to the other, it has
//!
//! ```text
//! E = ½ k (r − L)²,   ∂E/∂d = k (1 − L/r) d,   ∂²E/∂d² = k [ (1 − L/r) 1 + L/r d⊗d/r² ]
//! ```
//!
//! If L = 0 these are k d and k 1 at every distance. For L > 0 the force has no direction where
//! the nodes meet exactly, and is set to zero.
//!
//! A spring that acts only in tension has this energy where r ≥ L and none where r < L, one that
//! acts only in compression the reverse. The energy has a continuous derivative. At r = L, where
//! the second derivative jumps, it is that of the acting spring: Newton's method then predicts the
//! force of a tie that is placed without slack. Crossing r = L needs an iteration more, since the
//! residual is linear in r − L on either side.

use crate::mechanics::scene::SpringForce;
use crate::mechanics::{Matrix3, Vector3};

#[derive(Clone, Debug)]
pub(super) struct NodeSpring {
    /// Indices of its nodes among those of all rods.
    pub nodes: [usize; 2],
    /// k, N/m.
    pub stiffness: f64,
    /// L, m.
    pub rest_length: f64,
    /// The only sign of its force; `None` for both.
    pub only: Option<SpringForce>,
    /// d, m.
    pub span: Vector3,
}

impl NodeSpring {
    /// Whether it exerts a force, or would at once if its length changed.
    fn acts(&self) -> bool {
        let length = self.span.norm();
        match self.only {
            None => true,
            Some(SpringForce::Tension) => length >= self.rest_length,
            Some(SpringForce::Compression) => length <= self.rest_length,
        }
    }

    /// L/r; 0 if the direction is undefined.
    fn rest_part(&self) -> f64 {
        let length = self.span.norm();
        if length > 0.0 {
            self.rest_length / length
        } else {
            0.0
        }
    }

    /// Force k (r − L), N: positive where it pulls.
    pub(crate) fn force(&self) -> f64 {
        if !self.acts() {
            return 0.0;
        }
        self.stiffness * (self.span.norm() - self.rest_length)
    }

    /// E, J.
    pub(crate) fn energy(&self) -> f64 {
        if !self.acts() {
            return 0.0;
        }
        let lengthening = self.span.norm() - self.rest_length;
        0.5 * self.stiffness * lengthening * lengthening
    }

    /// ∂E/∂d, N.
    pub(crate) fn gradient(&self) -> Vector3 {
        if !self.acts() {
            return Vector3::zeros();
        }
        self.span * (self.stiffness * (1.0 - self.rest_part()))
    }

    /// ∂²E/∂d², N/m.
    pub(crate) fn hessian(&self) -> Matrix3 {
        if !self.acts() {
            return Matrix3::zeros();
        }
        let rest_part = self.rest_part();
        let across = Matrix3::from_diagonal_element(1.0 - rest_part);
        let square = self.span.norm_squared();
        if rest_part == 0.0 {
            return across * self.stiffness;
        }
        let along = self.span * self.span.transpose() * (rest_part / square);
        (across + along) * self.stiffness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spring(rest_length: f64, span: Vector3) -> NodeSpring {
        NodeSpring {
            nodes: [0, 1],
            stiffness: 3.0,
            rest_length,
            only: None,
            span,
        }
    }

    /// Natural length over length, and the only sign of the force.
    const LENGTHS: [(f64, Option<SpringForce>); 8] = [
        (0.0, None),
        (0.3, None),
        (1.0, None),
        (2.5, None),
        (0.3, Some(SpringForce::Tension)),
        (2.5, Some(SpringForce::Tension)),
        (0.3, Some(SpringForce::Compression)),
        (2.5, Some(SpringForce::Compression)),
    ];

    #[test]
    fn gradient_and_hessian_are_derivatives_of_the_energy() {
        let direction = Vector3::new(0.48, -0.6, 0.64);
        for size in [1e-3, 1.0, 1e3] {
            for (part, only) in LENGTHS {
                let at = |span: Vector3| NodeSpring {
                    only,
                    ..spring(part * size, span)
                };
                let here = at(direction * size);
                let step = 1e-4 * size;
                for axis in 0..3 {
                    let moved = |by: f64| at(here.span + Vector3::ith(axis, by * step));
                    let slope = |value: &dyn Fn(NodeSpring) -> f64| {
                        let [near, far] = [1.0, 2.0].map(|by| value(moved(by)) - value(moved(-by)));
                        (8.0 * near - far) / (12.0 * step)
                    };
                    let error = slope(&|spring| spring.energy()) - here.gradient()[axis];
                    assert!(error.abs() < 1e-8 * 3.0 * size, "{size} {part}: {error:e}");
                    for row in 0..3 {
                        let slope = slope(&|spring| spring.gradient()[row]);
                        let error = slope - here.hessian()[(row, axis)];
                        assert!(error.abs() < 1e-8 * 3.0, "{size} {part}: {error:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn one_sided_springs_exert_no_force_on_the_other_side() {
        for (only, slack, taut) in [
            (SpringForce::Tension, 1.5, 0.5),
            (SpringForce::Compression, 0.5, 1.5),
        ] {
            let of_length = |rest_length: f64| NodeSpring {
                only: Some(only),
                ..spring(rest_length, Vector3::x())
            };
            assert_eq!(of_length(slack).energy(), 0.0);
            assert_eq!(of_length(slack).force(), 0.0);
            assert_eq!(of_length(slack).gradient(), Vector3::zeros());
            assert_eq!(of_length(slack).hessian(), Matrix3::zeros());
            assert_eq!(of_length(taut).force(), 3.0 * (1.0 - taut));
            assert_eq!(
                of_length(taut).energy(),
                spring(taut, Vector3::x()).energy()
            );
            // At the rest length the force is zero, and the stiffness that of the acting spring.
            assert_eq!(of_length(1.0).force(), 0.0);
            assert_eq!(
                of_length(1.0).hessian(),
                spring(1.0, Vector3::x()).hessian()
            );
        }
    }

    #[test]
    fn one_without_length_is_linear_where_its_nodes_meet() {
        let here = spring(0.0, Vector3::zeros());
        assert_eq!(here.energy(), 0.0);
        assert_eq!(here.gradient(), Vector3::zeros());
        assert_eq!(here.hessian(), Matrix3::identity() * 3.0);
    }
}
