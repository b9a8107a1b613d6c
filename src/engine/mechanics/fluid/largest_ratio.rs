//! Ratio of the resistance of the flow to its local part.

use super::flow::Flow;
use super::gmres::{dot, scale};
use super::preconditioner::Preconditioner;
use crate::mechanics::{Matrix3, Vector3};

/// Power iterations that estimate the largest ratio of the resistance to its local part. After
/// ten, the error is below 5 % for a straight filament of 40 edges.
const POWER_ITERATIONS: usize = 10;

/// Estimates the largest eigenvalue of D⁻¹ R for the assembled operator, by power iteration with
/// A⁻¹ A_d, which has the same eigenvalues. The preconditioner approximates A⁻¹. `vector` and
/// `image` are scratch with as many numbers as there are unknowns.
pub(super) fn largest_ratio(
    operator: &Flow,
    preconditioner: &mut Preconditioner,
    vector: &mut [f64],
    image: &mut [f64],
) -> f64 {
    let blocks: Vec<Matrix3> = (0..operator.nodes())
        .map(|point| operator.diagonal(point))
        .collect();
    // Start with neighbours that move in opposite directions, plus some of every other motion:
    // rough motions have the largest resistance.
    for (k, entry) in vector.iter_mut().enumerate() {
        let node = k / 3;
        let sign = if node.is_multiple_of(2) { 1.0 } else { -1.0 };
        *entry = sign * (1.0 + 0.3 * libm::sin(1.7 * k as f64));
    }
    let mut ratio = 0.0;
    for _ in 0..POWER_ITERATIONS {
        scale(1.0 / dot(vector, vector).sqrt(), vector);
        for (point, block) in blocks.iter().enumerate() {
            let own = 3 * point..3 * point + 3;
            let product = block * Vector3::from_column_slice(&vector[own.clone()]);
            image[own].copy_from_slice(product.as_slice());
        }
        preconditioner.apply(image, vector);
        ratio = dot(vector, vector).sqrt();
    }
    ratio
}
