//! Force and Jacobian of a node on a rigid plane, with friction.
//!
//! The potential is that of two edges (thesis Eq. 2.15) with the gap (x − p)·n − h of the node's
//! sphere over the plane in place of Δ − 2h. Friction is that of Eqs. 2.9–2.11 against the plane
//! at rest:
//!
//! F = N (n + t(n, v)), ∂F = (dN/dΔ) (n + t) nᵀ + N (∂t/∂v)/Δt, v = (x − xⁿ)/Δt.

use super::contacts::{Linearised, PlaneJacobian};
use super::edge_contact::Sliding;
use super::friction::FrictionLaw;
use super::normal_response::NormalResponse;
use crate::mechanics::Vector3;

/// The sliding of a node over a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeSliding {
    /// Friction law between node and plane.
    pub law: FrictionLaw,
    /// Velocity of the node, m/s.
    pub velocity: Vector3,
    /// Size Δt of the step, s.
    pub time_step: f64,
}

impl NodeSliding {
    /// The sliding as that of four nodes, three of them at rest.
    pub(crate) fn of_first_node(&self) -> Sliding {
        let rest = Vector3::zeros();
        Sliding {
            law: self.law,
            velocities: [self.velocity, rest, rest, rest],
            swing: rest,
            time_step: self.time_step,
        }
    }
}

/// Force on the node, N, from a normal force and the friction `traction` per normal force.
pub(super) fn plane_force(normal: &Vector3, normal_force: f64, traction: &Vector3) -> [f64; 3] {
    ((normal + traction) * normal_force).into()
}

/// Derivative of [`plane_force`] with respect to the position of the node, N/m, for the friction law linearised at the
/// slip given with `sliding` (m/s).
pub(super) fn plane_jacobian(
    normal: &Vector3,
    response: &NormalResponse,
    sliding: Option<(&NodeSliding, Vector3)>,
) -> Linearised<PlaneJacobian> {
    let mut traction_gradient = [[0.0; 12]; 3];
    let jacobian = match sliding {
        Some((sliding, at)) => {
            let traction = sliding
                .law
                .traction_derivatives(normal, &sliding.velocity, &at);
            for (row, gradient) in traction_gradient.iter_mut().enumerate() {
                for column in 0..3 {
                    gradient[column] = traction.by_velocity[(row, column)] / sliding.time_step;
                }
            }
            (normal + traction.value) * normal.transpose() * response.force_slope
                + traction.by_velocity * (response.force / sliding.time_step)
        }
        None => normal * normal.transpose() * response.force_slope,
    };
    Linearised {
        jacobian: std::array::from_fn(|row| std::array::from_fn(|column| jacobian[(row, column)])),
        gap_gradient: std::array::from_fn(|column| if column < 3 { normal[column] } else { 0.0 }),
        traction_gradient,
    }
}

#[cfg(test)]
mod tests {
    use super::super::directed_friction::DirectedFriction;
    use super::super::friction::slip;
    use super::super::potential::normal_response;
    use super::super::test_support::{Random, relative_error};
    use super::*;

    #[test]
    fn the_jacobian_agrees_with_differences_over_decades() {
        let directed = DirectedFriction {
            forwards: 0.2,
            backwards: 0.9,
            sideways: 0.6,
        };
        let mut random = Random::new(13);
        for radius in [1e-4, 1e-3, 1e-2, 1e-1] {
            let time_step = 10.0; // speeds near the slip tolerance
            for case in 0..100 {
                let normal = random.vector().normalize();
                let law = FrictionLaw {
                    coefficient: directed.sideways,
                    slip_tolerance: 0.1 * radius,
                    grain: (case % 2 == 0).then(|| directed.grain(&normal, &random.vector())),
                };
                let previous = random.vector() * radius;
                let position = normal * (radius * (1.0 + 0.2 * random.symmetric()));
                let evaluate = |x: &Vector3| {
                    let gap = x.dot(&normal) - radius;
                    let response = normal_response(gap, radius, 0.5 * radius, 2.0);
                    let sliding = NodeSliding {
                        law,
                        velocity: (x - previous) / time_step,
                        time_step,
                    };
                    (response, sliding)
                };
                let force = |x: &Vector3| {
                    let (response, sliding) = evaluate(x);
                    let traction = law.traction(&normal, &sliding.velocity);
                    Vector3::from(plane_force(&normal, response.force, &traction))
                };
                let (response, sliding) = evaluate(&position);
                let at = slip(&normal, &sliding.velocity);
                let found = plane_jacobian(&normal, &response, Some((&sliding, at))).jacobian;
                let step = 1e-5 * radius;
                let expected: [[f64; 3]; 3] = std::array::from_fn(|row| {
                    std::array::from_fn(|column| {
                        let mut offset = Vector3::zeros();
                        offset[column] = step;
                        let change = force(&(position + offset)) - force(&(position - offset));
                        change[row] / (2.0 * step)
                    })
                });
                let error = relative_error(found.as_flattened(), expected.as_flattened());
                assert!(error < 1e-6, "{error:e}");
            }
        }
    }
}
