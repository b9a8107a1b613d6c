//! Derivatives of the centreline distance Δ of two edges, of its direction and of the contact ratios.
//!
//! The weights w = (1−β_i, β_i, −(1−β_j), −β_j) on the nodes x = (x_i, x_{i+1}, x_j, x_{j+1}) give
//! the separation r = Σ w_m x_m. With the smoothing c of [`ClosestPoints`] the distance Δ is given
//! by Δ² = ‖r‖² + c Σ_k (β_k − ½)², and n = r/Δ is a unit vector if c = 0. The contact ratios
//! minimise Δ, so that
//!
//! ∇Δ = w ⊗ n
//!
//! in every class of contact. The second derivative depends on the ratios that are free to move.
//! Let s_i = e_i and s_j = −e_j be the derivatives of r with respect to the ratios, a_i = (−1, 1,
//! 0, 0) and a_j = (0, 0, 1, −1) those of w, and Q_kl = s_k·s_l + c δ_kl over the free ratios.
//! Then, from the optimality condition r·s_k + c (β_k − ½) = 0,
//!
//! - ∂β_k = −Σ_l Q⁻¹_kl (w ⊗ s_l + Δ a_l ⊗ n),
//! - ∂n = T (w ⊗ ·)/Δ − Σ_kl Q⁻¹_kl s_k (a_l ⊗ n)ᵀ, with T = 1 − n nᵀ − Σ_kl Q⁻¹_kl s_k s_lᵀ,
//! - ∇²Δ = Σ_k (a_k ⊗ n) ∂β_kᵀ + w ⊗ ∂n.
//!
//! If c = 0, T projects onto the directions normal to n and to all free s_k: the tangent plane for
//! point–point, one line for point–edge, nothing for edge–edge. These are then the second
//! derivatives of thesis Eqs. 2.4, 2.5 and 2.6 (the tests use those as printed), without their
//! cross products and quotients.
//!
//! The thesis first multiplies all lengths by 1/h (Eq. 2.15). Relative rounding errors do not
//! depend on the unit of length, so here only the potential is scaled.

use super::closest_points::ClosestPoints;
use crate::mechanics::{Matrix3, Vector3};

/// Derivatives of the weights: ∂w_m/∂β_k is `WEIGHT_RATES[m]` for k = m/2, and zero for the other
/// ratio.
pub(super) const WEIGHT_RATES: [f64; 4] = [-1.0, 1.0, 1.0, -1.0];

/// First derivatives of the quantities that determine a contact force.
///
/// Rows of 12 are derivatives with respect to the coordinates of the four nodes, node after node.
#[derive(Clone, Copy, Debug)]
pub(super) struct DistanceDerivatives {
    /// Direction n from the second edge to the first, of length 1 without smoothing.
    pub normal: Vector3,
    /// Weights w of the four nodes in the separation.
    pub weights: [f64; 4],
    /// ∂β_i and ∂β_j, 1/m.
    pub ratio_gradients: [[f64; 12]; 2],
    /// ∂n, 1/m, indices [component of n][coordinate].
    pub normal_jacobian: [[f64; 12]; 3],
}

impl DistanceDerivatives {
    /// Derivatives for the edges (`nodes[0]`, `nodes[1]`) and (`nodes[2]`, `nodes[3]`).
    ///
    /// `closest` must belong to these nodes and have a nonzero distance.
    pub(crate) fn of(nodes: &[Vector3; 4], closest: &ClosestPoints) -> Self {
        let distance = closest.distance();
        let normal = closest.separation / distance;
        let weights = closest.weights();
        let slides = [nodes[1] - nodes[0], nodes[2] - nodes[3]];
        let inverse = inverse_over_free_ratios(&slides, closest.free, closest.smoothing);
        // y_k = Σ_l Q⁻¹_kl s_l
        let duals = [
            slides[0] * inverse[0][0] + slides[1] * inverse[0][1],
            slides[0] * inverse[1][0] + slides[1] * inverse[1][1],
        ];
        let projection = tangent_projection(&normal, &slides, &duals) / distance;

        let mut ratio_gradients = [[0.0; 12]; 2];
        let mut normal_jacobian = [[0.0; 12]; 3];
        for node in 0..4 {
            let own = node / 2;
            let (weight, rate) = (weights[node], WEIGHT_RATES[node]);
            for axis in 0..3 {
                let column = 3 * node + axis;
                let rate_along_normal = rate * normal[axis];
                for ratio in 0..2 {
                    ratio_gradients[ratio][column] = -(weight * duals[ratio][axis]
                        + distance * inverse[ratio][own] * rate_along_normal);
                }
                for component in 0..3 {
                    normal_jacobian[component][column] = weight * projection[(component, axis)]
                        - rate_along_normal * duals[own][component];
                }
            }
        }
        Self {
            normal,
            weights,
            ratio_gradients,
            normal_jacobian,
        }
    }

    /// ∇Δ = w ⊗ n.
    pub(crate) fn gradient(&self) -> [f64; 12] {
        std::array::from_fn(|column| self.weights[column / 3] * self.normal[column % 3])
    }
}

/// Q⁻¹ over the free ratios, zero elsewhere. For two free ratios det Q = ‖e_i × e_j‖² + c (Q_ii + Q_jj − c).
fn inverse_over_free_ratios(
    slides: &[Vector3; 2],
    free: [bool; 2],
    smoothing: f64,
) -> [[f64; 2]; 2] {
    let [square_i, square_j] = slides.map(|slide| slide.norm_squared() + smoothing);
    match free {
        [false, false] => [[0.0; 2]; 2],
        [true, false] => [[1.0 / square_i, 0.0], [0.0, 0.0]],
        [false, true] => [[0.0, 0.0], [0.0, 1.0 / square_j]],
        [true, true] => {
            let determinant = slides[0].cross(&slides[1]).norm_squared()
                + smoothing * (square_i + square_j - smoothing);
            let mixed = -slides[0].dot(&slides[1]) / determinant;
            [
                [square_j / determinant, mixed],
                [mixed, square_i / determinant],
            ]
        }
    }
}

/// T: the directions in which the separation can turn while the free points follow.
fn tangent_projection(normal: &Vector3, slides: &[Vector3; 2], duals: &[Vector3; 2]) -> Matrix3 {
    Matrix3::identity()
        - normal * normal.transpose()
        - slides[0] * duals[0].transpose()
        - slides[1] * duals[1].transpose()
}

#[cfg(test)]
mod tests {
    use super::super::test_support::*;
    use super::*;
    use nalgebra::SVector;
    use num_dual::{gradient, hessian};

    /// Eq. 2.4 between the nodes `a` and `b`.
    fn point_point<D: Dual>(x: &[D], a: usize, b: usize) -> D {
        norm(subtract(dual_node(x, a), dual_node(x, b)))
    }

    /// Eq. 2.5 between the edge (`a`, `b`) and the node `c`.
    fn point_edge<D: Dual>(x: &[D], a: usize, b: usize, c: usize) -> D {
        let edge = subtract(dual_node(x, a), dual_node(x, b));
        let offset = subtract(dual_node(x, b), dual_node(x, c));
        norm(cross(edge, offset)) / norm(edge)
    }

    /// Eq. 2.6.
    fn edge_edge<D: Dual>(x: &[D]) -> D {
        let u = cross(
            subtract(dual_node(x, 1), dual_node(x, 0)),
            subtract(dual_node(x, 3), dual_node(x, 2)),
        );
        (dot(subtract(dual_node(x, 0), dual_node(x, 2)), u) / norm(u)).abs()
    }

    /// The printed formula of the class in which the edges meet.
    fn printed_distance<D: Dual>(x: &[D], closest: &ClosestPoints) -> D {
        let first_end = closest.ratios[0].round() as usize;
        let second_end = 2 + closest.ratios[1].round() as usize;
        match closest.free {
            [false, false] => point_point(x, first_end, second_end),
            [true, false] => point_edge(x, 0, 1, second_end),
            [false, true] => point_edge(x, 2, 3, first_end),
            [true, true] => edge_edge(x),
        }
    }

    /// ∇²Δ as the module documentation gives it.
    fn distance_hessian(d: &DistanceDerivatives) -> [[f64; 12]; 12] {
        std::array::from_fn(|row| {
            let (m, c) = (row / 3, row % 3);
            std::array::from_fn(|column| {
                WEIGHT_RATES[m] * d.normal[c] * d.ratio_gradients[m / 2][column]
                    + d.weights[m] * d.normal_jacobian[c][column]
            })
        })
    }

    fn compare_with_the_printed_formula(free: [bool; 2]) {
        for radius in [1e-4, 1e-3, 1e-2, 1e-1] {
            for (nodes, closest) in edge_pairs_of_class(free, radius) {
                let derivatives = DistanceDerivatives::of(&nodes, &closest);
                let x = SVector::<f64, 12>::from_fn(|row, _| nodes[row / 3][row % 3]);

                let (value, expected) = gradient(|x| printed_distance(x.as_slice(), &closest), &x);
                let found = derivatives.gradient();
                assert!((closest.distance() - value).abs() < 1e-12 * value);
                assert!(relative_error(&found, expected.as_slice()) < 1e-8);

                let (_, _, expected) = hessian(|x| printed_distance(x.as_slice(), &closest), &x);
                let found = distance_hessian(&derivatives);
                assert!(relative_error(found.as_flattened(), expected.as_slice()) < 1e-6);
            }
        }
    }

    #[test]
    fn point_point_derivatives() {
        compare_with_the_printed_formula([false, false]);
    }

    #[test]
    fn point_edge_derivatives() {
        compare_with_the_printed_formula([true, false]);
        compare_with_the_printed_formula([false, true]);
    }

    #[test]
    fn edge_edge_derivatives() {
        compare_with_the_printed_formula([true, true]);
    }

    #[test]
    fn smoothed_derivatives_of_nearly_parallel_edges() {
        let mut random = Random::new(13);
        let (mut inside, smoothing, step) = (0, 1e-2, 1e-6);
        while inside < 20 {
            let along = Vector3::x() + random.vector() * 0.02;
            let start = Vector3::z() * 0.7 + random.vector() * 0.3;
            let nodes = [Vector3::zeros(), Vector3::x(), start, start + along];
            let closest = ClosestPoints::smoothed(&nodes, smoothing);
            if !closest
                .ratios
                .iter()
                .all(|ratio| (0.01..0.99).contains(ratio))
            {
                continue;
            }
            inside += 1;
            let derivatives = DistanceDerivatives::of(&nodes, &closest);
            let (slope, curvature) = (derivatives.gradient(), distance_hessian(&derivatives));
            for column in 0..12 {
                let moved = |sign: f64| {
                    let mut nodes = nodes;
                    nodes[column / 3][column % 3] += sign * step;
                    let closest = ClosestPoints::smoothed(&nodes, smoothing);
                    let gradient = DistanceDerivatives::of(&nodes, &closest).gradient();
                    (closest.distance(), gradient)
                };
                let (after, before) = (moved(1.0), moved(-1.0));
                let expected = (after.0 - before.0) / (2.0 * step);
                assert!((slope[column] - expected).abs() < 1e-8);
                for row in 0..12 {
                    let expected = (after.1[row] - before.1[row]) / (2.0 * step);
                    assert!((curvature[row][column] - expected).abs() < 1e-6 / smoothing);
                }
            }
        }
    }

    #[test]
    fn the_separation_turns_as_the_normal_jacobian_says() {
        for free in CLASSES {
            for (nodes, closest) in edge_pairs_of_class(free, 1e-3) {
                let derivatives = DistanceDerivatives::of(&nodes, &closest);
                let step = 1e-9;
                for column in 0..12 {
                    let moved = |sign: f64| {
                        let mut nodes = nodes;
                        nodes[column / 3][column % 3] += sign * step;
                        ClosestPoints::of(&nodes)
                    };
                    let (after, before) = (moved(1.0), moved(-1.0));
                    let turned = (after.separation.normalize() - before.separation.normalize())
                        / (2.0 * step);
                    let slid = (after.ratios[0] - before.ratios[0]) / (2.0 * step);
                    for axis in 0..3 {
                        let expected = derivatives.normal_jacobian[axis][column];
                        assert!((turned[axis] - expected).abs() < 1e-2, "{free:?} {column}");
                    }
                    assert!((slid - derivatives.ratio_gradients[0][column]).abs() < 1e-2);
                }
            }
        }
    }
}
