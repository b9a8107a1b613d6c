//! Force and Jacobian of one contact between two edges, with friction (thesis Eqs. 2.7–2.14).
//!
//! The normal force N(Δ) and the friction act at the contact points, and are distributed to the
//! nodes by the weights w of [`DistanceDerivatives`]:
//!
//! F = N w ⊗ d, d = n + t(n, v), v = Σ w_m (x_m − x_mⁿ)/Δt,
//!
//! with the traction t of [`FrictionLaw`] (Eq. 2.11: node i has the normal force |w_i| N, and the two edges
//! have opposite friction). The thesis obtains ∂β through the ratio of nodal forces (Eqs. 2.12, 2.13);
//! here it is given directly, and the chain rule of Eq. 2.14 reads
//!
//! ∂F = (w ∂N + N ∂w) ⊗ d + N w ⊗ ∂d,
//! ∂d = ∂n + (∂t/∂n) ∂n + (∂t/∂v) (w/Δt + Σ_k (a_k·ẋ) ∂β_k).
//!
//! A round obstacle that turns about its centreline adds n̂ × h Ω to the slip, with the distance h of
//! its surface from its centreline and its rate Ω (rad/s): points of the surface move with Ω × h n̂.
//!
//! Without friction the Jacobian is −k∇²E, symmetric to rounding error.

use super::closest_points::ClosestPoints;
use super::contacts::{EdgeJacobian, Linearised};
use super::distance::{DistanceDerivatives, WEIGHT_RATES};
use super::friction::{FrictionLaw, Traction};
use super::normal_response::NormalResponse;
use crate::mechanics::{Matrix3, Vector3};

/// The sliding of four nodes over a time step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sliding {
    /// Friction law between the edges.
    pub law: FrictionLaw,
    /// Velocities of the four nodes, m/s.
    pub velocities: [Vector3; 4],
    /// h Ω of an obstacle, m rad/s.
    pub swing: Vector3,
    /// Size Δt of the step, s.
    pub time_step: f64,
}

impl Sliding {
    /// Velocity of one contact point relative to the other, with the rotation of an obstacle, m/s.
    pub(crate) fn contact_velocity(&self, weights: &[f64; 4], normal: &Vector3) -> Vector3 {
        self.relative_velocity(weights) + self.velocity_of_swing(normal)
    }

    /// Velocity that the rotation of an obstacle adds to that of the contact points, m/s.
    pub(crate) fn velocity_of_swing(&self, normal: &Vector3) -> Vector3 {
        if self.swing == Vector3::zeros() {
            return self.swing;
        }
        normal.normalize().cross(&self.swing)
    }

    /// [`FrictionLaw::traction_derivatives`] with the rotation of an obstacle in addition to the
    /// relative `velocity`, m/s.
    pub(crate) fn traction_derivatives(
        &self,
        normal: &Vector3,
        velocity: Vector3,
        at: &Vector3,
    ) -> Traction {
        if self.swing == Vector3::zeros() {
            return self.law.traction_derivatives(normal, &velocity, at);
        }
        let velocity = velocity + self.velocity_of_swing(normal);
        let mut traction = self.law.traction_derivatives(normal, &velocity, at);
        let length = normal.norm();
        let unit = normal / length;
        let unit_by_normal = (Matrix3::identity() - unit * unit.transpose()) / length;
        traction.by_normal -= traction.by_velocity * self.swing.cross_matrix() * unit_by_normal;
        traction
    }

    /// Velocity of one contact point relative to the other without it, m/s.
    pub(crate) fn relative_velocity(&self, weights: &[f64; 4]) -> Vector3 {
        let [a, b, c, d] = &self.velocities;
        a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
    }
}

/// Force on the four nodes of a contact with given weights, N, from a normal force and the
/// friction `traction` per normal force.
///
/// The normal of smoothed closest points is shorter than 1 by about 1e-5, and so is the force N n
/// along it; friction follows this actual force.
pub(super) fn contact_force(
    weights: &[f64; 4],
    normal: &Vector3,
    normal_force: f64,
    traction: &Vector3,
) -> [f64; 12] {
    let direction = normal + traction * normal.norm();
    std::array::from_fn(|row| normal_force * weights[row / 3] * direction[row % 3])
}

/// Derivative of [`contact_force`] with respect to the coordinates of the four nodes, N/m, for the
/// friction law linearised at the slip given with `sliding` (m/s). The derivatives of normal and
/// contact points are included only if the contact `turns`.
///
/// The contribution of turning is of the order of N/Δ and of either sign. This contribution is
/// harmful while forces and contact points are only guesses: a force that is far too large makes
/// the system indefinite. Without it the Jacobian of frictionless contact is positive. For nearly
/// parallel edges, however, it is necessary even while corrections still move them far, since the
/// contact points run along the edges as they turn.
///
/// If the second edge belongs to an obstacle, only the part of the first edge is written, because
/// only that part is assembled.
pub(super) fn edge_jacobian(
    nodes: &[Vector3; 4],
    closest: &ClosestPoints,
    response: &NormalResponse,
    sliding: Option<(&Sliding, Vector3)>,
    turns: bool,
    is_at_obstacle: bool,
) -> Linearised<EdgeJacobian> {
    if is_at_obstacle {
        jacobian_over::<6>(nodes, closest, response, sliding, turns)
    } else {
        jacobian_over::<12>(nodes, closest, response, sliding, turns)
    }
}

/// [`edge_jacobian`] restricted to the first `COORDINATES` coordinates.
fn jacobian_over<const COORDINATES: usize>(
    nodes: &[Vector3; 4],
    closest: &ClosestPoints,
    response: &NormalResponse,
    sliding: Option<(&Sliding, Vector3)>,
    turns: bool,
) -> Linearised<EdgeJacobian> {
    let mut distance = DistanceDerivatives::of(nodes, closest);
    if !turns {
        distance.normal_jacobian = Default::default();
        distance.ratio_gradients = Default::default();
    }
    let gradient = distance.gradient();
    let (direction, direction_jacobian, rates) = match sliding {
        Some((sliding, at)) => direction_with_friction::<COORDINATES>(&distance, sliding, &at),
        None => (distance.normal, distance.normal_jacobian, [[0.0; 12]; 3]),
    };
    let mut jacobian = [[0.0; 12]; 12];
    for node in 0..COORDINATES / 3 {
        let weight = distance.weights[node];
        let ratio_gradient = &distance.ratio_gradients[node / 2];
        let (along, across) = (
            weight * response.force_slope,
            response.force * WEIGHT_RATES[node],
        );
        // Derivative of N w_m.
        let nodal: [f64; COORDINATES] = std::array::from_fn(|column| {
            along * gradient[column] + across * ratio_gradient[column]
        });
        let weighted_force = response.force * weight;
        for axis in 0..3 {
            let row = &mut jacobian[3 * node + axis];
            for column in 0..COORDINATES {
                row[column] = nodal[column] * direction[axis]
                    + weighted_force * direction_jacobian[axis][column];
            }
        }
    }
    Linearised {
        jacobian,
        gap_gradient: gradient,
        traction_gradient: rates,
    }
}

/// d = n + |n| t, ∂d and ∂t, for the first `COORDINATES` coordinates.
fn direction_with_friction<const COORDINATES: usize>(
    distance: &DistanceDerivatives,
    sliding: &Sliding,
    at: &Vector3,
) -> (Vector3, [[f64; 12]; 3], [[f64; 12]; 3]) {
    let velocity = sliding.relative_velocity(&distance.weights);
    let traction = sliding.traction_derivatives(&distance.normal, velocity, at);
    let [a, b, c, d] = &sliding.velocities;
    let by_ratio = [
        traction.by_velocity * (b - a),
        traction.by_velocity * (c - d),
    ];
    let by_position = traction.by_velocity / sliding.time_step;

    let turn = &distance.normal_jacobian;
    let length = distance.normal.norm();
    // ∂|n|
    let stretch: [f64; COORDINATES] = std::array::from_fn(|column| {
        let along = (0..3).map(|axis| distance.normal[axis] * turn[axis][column]);
        along.sum::<f64>() / length
    });
    let (mut rates, mut jacobian) = ([[0.0; 12]; 3], [[0.0; 12]; 3]);
    for axis in 0..3 {
        for column in 0..COORDINATES {
            let turned: f64 = (0..3)
                .map(|other| traction.by_normal[(axis, other)] * turn[other][column])
                .sum();
            let slid = by_ratio[0][axis] * distance.ratio_gradients[0][column]
                + by_ratio[1][axis] * distance.ratio_gradients[1][column];
            let rate =
                turned + slid + distance.weights[column / 3] * by_position[(axis, column % 3)];
            rates[axis][column] = rate;
            jacobian[axis][column] =
                turn[axis][column] + length * rate + traction.value[axis] * stretch[column];
        }
    }
    (distance.normal + traction.value * length, jacobian, rates)
}

#[cfg(test)]
mod tests {
    use super::super::friction::slip;
    use super::super::potential::normal_response;
    use super::super::test_support::*;
    use super::*;
    use nalgebra::SVector;
    use num_dual::{gradient, jacobian};

    const TIME_STEP: f64 = 1e-3;
    const STIFFNESS: f64 = 2.5;
    /// δ/h; large, so that the random gaps of half a radius are within the potential.
    const TOLERANCE: f64 = 0.5;

    fn energy<D: Dual>(distance: D, radius: f64) -> D {
        let k1 = 15.0 / TOLERANCE;
        let softplus = ((-(distance / radius - 2.0) * k1).exp() + 1.0).ln() / k1;
        softplus * softplus * STIFFNESS
    }

    fn separation<D: Dual>(x: &[D], closest: &ClosestPoints) -> ([D; 4], DualVector<D>) {
        let [i, j] = dual_ratios(x, closest);
        let one = D::from(1.0);
        let weights = [one - i, i, j - one, -j];
        let sum = (0..4).fold([D::from(0.0); 3], |sum, m| {
            add(sum, scale(dual_node(x, m), weights[m]))
        });
        (weights, sum)
    }

    /// Eqs. 2.7–2.11 in dual numbers.
    fn printed_force<D: Dual>(
        x: &[D],
        previous: &[f64],
        closest: &ClosestPoints,
        radius: f64,
        friction: Option<(FrictionLaw, Vector3)>,
    ) -> SVector<D, 12> {
        let (weights, r) = separation(x, closest);
        let distance = norm(r);
        let n = scale(r, distance.recip());
        let k1 = 15.0 / TOLERANCE;
        let exponential = (-(distance / radius - 2.0) * k1).exp();
        let normal_force = (exponential + 1.0).ln() * exponential / (exponential + 1.0)
            * (2.0 * STIFFNESS / (k1 * radius));
        let mut direction = n;
        if let Some((law, swing)) = friction {
            let of_swing = cross(n, std::array::from_fn(|axis| D::from(swing[axis])));
            let v = (0..4).fold(of_swing, |sum, m| {
                let moved = subtract(
                    dual_node(x, m),
                    std::array::from_fn(|axis| D::from(previous[3 * m + axis])),
                );
                add(sum, scale(moved, weights[m] / TIME_STEP))
            });
            let slip = subtract(v, scale(n, dot(v, n)));
            let speed = norm(slip);
            let gamma = ((-speed * (15.0 / law.slip_tolerance)).exp() + 1.0).recip() * 2.0 - 1.0;
            direction = subtract(n, scale(slip, gamma / speed * law.coefficient));
        }
        SVector::from_fn(|row, _| weights[row / 3] * normal_force * direction[row % 3])
    }

    struct Case {
        nodes: [Vector3; 4],
        previous: [Vector3; 4],
        closest: ClosestPoints,
        radius: f64,
        law: FrictionLaw,
        swing: Vector3,
    }

    impl Case {
        fn response(&self) -> NormalResponse {
            let gap = self.closest.distance() - 2.0 * self.radius;
            normal_response(gap, self.radius, TOLERANCE * self.radius, STIFFNESS)
        }

        fn sliding(&self) -> Sliding {
            Sliding {
                law: self.law,
                velocities: std::array::from_fn(|m| (self.nodes[m] - self.previous[m]) / TIME_STEP),
                swing: self.swing,
                time_step: TIME_STEP,
            }
        }
    }

    /// Contacts of every class, over decades of size, from creeping to fast sliding.
    fn cases() -> Vec<Case> {
        let mut random = Random::new(11);
        let mut cases = Vec::new();
        for radius in [1e-4, 1e-3, 1e-2, 1e-1] {
            for (index, (nodes, closest)) in CLASSES
                .iter()
                .flat_map(|&free| edge_pairs_of_class(free, radius))
                .enumerate()
            {
                let slip_tolerance = 0.1 * radius;
                let speed = slip_tolerance * [0.01, 0.1, 1.0, 10.0][index % 4];
                let previous = nodes.map(|node| node - random.vector() * speed * TIME_STEP);
                let law = FrictionLaw {
                    coefficient: 0.3,
                    slip_tolerance,
                    grain: None,
                };
                cases.push(Case {
                    nodes,
                    previous,
                    closest,
                    radius,
                    law,
                    // Every third obstacle turns.
                    swing: random.vector() * if index % 3 == 0 { speed } else { 0.0 },
                });
            }
        }
        cases
    }

    fn flat(nodes: &[Vector3; 4]) -> SVector<f64, 12> {
        SVector::from_fn(|row, _| nodes[row / 3][row % 3])
    }

    /// The Jacobian by rows, from nalgebra's columns.
    fn rows(matrix: &nalgebra::SMatrix<f64, 12, 12>) -> Vec<f64> {
        matrix.transpose().as_slice().to_vec()
    }

    impl Case {
        fn slip(&self) -> Vector3 {
            let (weights, normal) = (self.closest.weights(), self.closest.normal());
            slip(&normal, &self.sliding().contact_velocity(&weights, &normal))
        }
    }

    /// Force of the friction law.
    fn force(case: &Case, sliding: Option<&Sliding>) -> [f64; 12] {
        let traction = sliding.map_or_else(Vector3::zeros, |sliding| {
            sliding.law.traction_of_slip(&case.slip())
        });
        contact_force(
            &case.closest.weights(),
            &case.closest.normal(),
            case.response().force,
            &traction,
        )
    }

    #[test]
    fn the_frictionless_force_is_the_gradient_of_the_energy() {
        for case in cases() {
            let (value, expected) = gradient(
                |x| energy(norm(separation(x.as_slice(), &case.closest).1), case.radius),
                &flat(&case.nodes),
            );
            let response = case.response();
            let found = force(&case, None);
            assert!((response.energy - value).abs() < 1e-8 * value);
            assert!(relative_error(&found, (-expected).as_slice()) < 1e-8);
        }
    }

    #[test]
    fn the_frictionless_jacobian_is_minus_the_hessian_and_symmetric() {
        for case in cases() {
            let (_, expected) = jacobian(
                |x| printed_force(x.as_slice(), &[], &case.closest, case.radius, None),
                &flat(&case.nodes),
            );
            let found = edge_jacobian(
                &case.nodes,
                &case.closest,
                &case.response(),
                None,
                true,
                false,
            )
            .jacobian;
            assert!(relative_error(found.as_flattened(), &rows(&expected)) < 1e-6);
            let transposed: EdgeJacobian =
                std::array::from_fn(|r| std::array::from_fn(|c| found[c][r]));
            assert!(relative_error(found.as_flattened(), transposed.as_flattened()) < 1e-12);
        }
    }

    #[test]
    fn friction_and_its_full_jacobian() {
        for case in cases() {
            let previous = flat(&case.previous);
            let (value, expected) = jacobian(
                |x| {
                    let previous = previous.as_slice();
                    printed_force(
                        x.as_slice(),
                        previous,
                        &case.closest,
                        case.radius,
                        Some((case.law, case.swing)),
                    )
                },
                &flat(&case.nodes),
            );
            let (response, sliding) = (case.response(), case.sliding());
            let force = force(&case, Some(&sliding));
            assert!(relative_error(&force, value.as_slice()) < 1e-8);
            let found = edge_jacobian(
                &case.nodes,
                &case.closest,
                &response,
                Some((&sliding, case.slip())),
                true,
                false,
            )
            .jacobian;
            let error = relative_error(found.as_flattened(), &rows(&expected));
            assert!(error < 1e-6, "{error:e} {:?}", case.closest.free);
        }
    }

    #[test]
    fn forces_balance_and_normal_forces_have_no_torque() {
        for case in cases() {
            let vectors = |force: [f64; 12]| -> [Vector3; 4] {
                std::array::from_fn(|m| Vector3::from_column_slice(&force[3 * m..3 * m + 3]))
            };
            let response = case.response();
            let sum = |forces: &[Vector3; 4]| forces.iter().sum::<Vector3>().norm();
            let with_friction = vectors(force(&case, Some(&case.sliding())));
            assert!(sum(&with_friction) < 1e-15 * response.force.max(f64::MIN_POSITIVE) * 4.0);

            let normal = vectors(force(&case, None));
            let torque: Vector3 = (0..4).map(|m| case.nodes[m].cross(&normal[m])).sum();
            assert!(torque.norm() < 1e-14 * response.force * 10.0 * case.radius);
        }
    }

    #[test]
    fn friction_only_takes_energy() {
        for case in cases() {
            let (response, sliding) = (case.response(), case.sliding());
            let normal = force(&case, None);
            let total = force(&case, Some(&sliding));
            let friction = |row: usize| total[row] - normal[row];
            let of_nodes: f64 = (0..12)
                .map(|row| friction(row) * sliding.velocities[row / 3][row % 3])
                .sum();
            let of_swing = sliding.velocity_of_swing(&case.closest.normal());
            let on_first = Vector3::from_fn(|axis, _| friction(axis) + friction(3 + axis));
            let power = of_nodes + on_first.dot(&of_swing);
            let scale = response.force * (sliding.velocities[0].norm() + case.swing.norm());
            assert!(power <= 1e-14 * scale, "{power:e}");
        }
    }
}
