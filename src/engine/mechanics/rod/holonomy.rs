//! Derivative of the spin of a transported frame with respect to its edge: ∇c of the holonomy c =
//! −(s×t)/((1+s·t) l).

use super::vertex::{EdgeFrame, curvature_binormal};
use crate::mechanics::{Matrix3, Vector3};

/// ∇c with respect to the edge vector, 1/m²: [κb⊗(t̃ + t) − 2/χ s×]/2l², where κb, t̃ and χ belong
/// to the source tangent s and the present tangent t; see [`super::vertex`].
#[inline(always)]
pub(crate) fn holonomy_jacobian(source: &Vector3, frame: &EdgeFrame) -> Matrix3 {
    let tangent = &frame.tangent;
    let inverse_chi = 1.0 / (1.0 + source.dot(tangent));
    let binormal = curvature_binormal(source, tangent);
    let sum = (source + tangent) * inverse_chi + tangent;
    (binormal * sum.transpose() - source.cross_matrix() * (2.0 * inverse_chi))
        * (0.5 * frame.inverse_length * frame.inverse_length)
}

/// Symmetric part of (∂E/∂φ) ∇c of one edge; see [`super::vertex`].
#[inline(always)]
pub(super) fn holonomy_hessian(source: &Vector3, frame: &EdgeFrame, moment: f64) -> Matrix3 {
    let jacobian = holonomy_jacobian(source, frame);
    (jacobian + jacobian.transpose()) * (0.5 * moment)
}
