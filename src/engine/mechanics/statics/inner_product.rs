//! The inner product a·B b of motions. B weights angles by the square of the shortest edge, so
//! that eigenvalues of the Hessian are in N/m.

use crate::mechanics::rod::STRIDE;

/// B v.
pub(super) fn scale_angles(vector: &mut [f64], weight: f64) {
    let angles = vector.iter_mut().skip(STRIDE - 1).step_by(STRIDE);
    angles.for_each(|angle| *angle *= weight);
}

/// a·B b.
pub(super) fn inner(a: &[f64], b: &[f64], weight: f64) -> f64 {
    let terms = a.iter().zip(b).enumerate();
    terms
        .map(|(k, (a, b))| a * b * if k % STRIDE == 3 { weight } else { 1.0 })
        .sum()
}

/// Scales a vector to B-norm 1.
pub(super) fn normalise(vector: &mut [f64], weight: f64) {
    let norm = inner(vector, vector, weight).sqrt();
    vector.iter_mut().for_each(|entry| *entry /= norm);
}
