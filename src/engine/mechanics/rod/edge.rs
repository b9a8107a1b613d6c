//! Stretching of one edge.
//!
//! E = ½ EA ε² l̃ with ε = l/l̃ − 1 (thesis Eqs. 1.2 and 1.6a); with the unit tangent t
//!
//! ```text
//! ∂E/∂e = EA ε t,   ∂²E/∂e² = EA [ t⊗t/l̃ + (1/l̃ − 1/l)(1 − t⊗t) ]
//! ```

use crate::mechanics::{Matrix3, Vector3};

/// Stretching energy, J.
#[inline(always)]
pub(crate) fn stretching_energy(stiffness: f64, length: f64, natural_length: f64) -> f64 {
    let strain = length / natural_length - 1.0;
    0.5 * stiffness * strain * strain * natural_length
}

/// Force EA ε t, N: the gradient with respect to the edge vector.
#[inline(always)]
pub(crate) fn stretching_gradient(
    stiffness: f64,
    tangent: &Vector3,
    length: f64,
    natural_length: f64,
) -> Vector3 {
    tangent * (stiffness * (length / natural_length - 1.0))
}

/// Hessian with respect to the edge vector, N/m.
#[inline(always)]
pub(crate) fn stretching_hessian(
    stiffness: f64,
    tangent: &Vector3,
    length: f64,
    natural_length: f64,
) -> Matrix3 {
    let transverse = stiffness * (1.0 / natural_length - 1.0 / length);
    let along = stiffness / natural_length - transverse;
    Matrix3::from_diagonal_element(transverse) + tangent * tangent.transpose() * along
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::{DualNum, hessian};

    fn energy<D: DualNum<Primitive = f64> + Copy>(
        edge: nalgebra::SVector<D, 3>,
        stiffness: f64,
        natural: f64,
    ) -> D {
        let length = (edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]).sqrt();
        let strain = length / natural - 1.0;
        strain * strain * (0.5 * stiffness * natural)
    }

    #[test]
    fn derivatives_match_dual_numbers_over_decades_of_scale() {
        for scale in [1e-4, 1e-2, 1.0, 1e2] {
            let edge = Vector3::new(0.7, -1.1, 0.4) * scale;
            let (stiffness, natural) = (3.0e3, 1.2 * scale);
            let (value, gradient, hessian) = hessian(|e| energy(e, stiffness, natural), &edge);
            let (length, tangent) = (edge.norm(), edge.normalize());
            assert!((stretching_energy(stiffness, length, natural) / value - 1.0).abs() < 1e-12);
            let ours = stretching_gradient(stiffness, &tangent, length, natural);
            assert!((ours - gradient).norm() < 1e-12 * gradient.norm());
            let ours = stretching_hessian(stiffness, &tangent, length, natural);
            assert!((ours - hessian).norm() < 1e-12 * hessian.norm());
        }
    }
}
