//! Eigenpairs of the Hessian, H v = μ B v, by inverse iteration (Golub & Van Loan, Matrix Computations,
//! 4th ed., sec. 8.2.2). B weighs angles by the square of the shortest edge, so that μ is in N/m.

use super::neutral::NeutralModes;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::System;

/// Most iterations. The lowest two eigenvalues of a rod are seldom closer than a tenth of the lowest;
/// where they coincide any vector of their plane will do.
const ITERATIONS: usize = 60;
/// Relative change at which the eigenvalue counts as found.
const TOLERANCE: f64 = 1e-10;
/// Growth of the shift until the Hessian is positive.
const SHIFT_GROWTH: f64 = 2.0;
/// Most growths: by then the shift is beyond every stiffness.
const GROWTHS: usize = 100;

/// The lowest eigenvalue at `unknowns` but those of motions without stiffness, N/m; the search begins below
/// `−shift`. `None` where the Hessian cannot be factored.
pub(super) fn lowest_eigenvalue(
    system: &mut System,
    unknowns: &[f64],
    neutral: &NeutralModes,
    mut shift: f64,
    scratch: &mut [f64],
) -> Option<f64> {
    // Below the lowest eigenvalue, so that it is the one that is nearest.
    for _ in 0..GROWTHS {
        system.linearize(unknowns, None);
        system.shift(shift, shift * neutral.weight());
        if system.factor().ok()??.negative == 0 {
            break;
        }
        shift *= SHIFT_GROWTH;
    }
    Some(inverse_iteration(system, scratch, neutral)? - shift)
}

/// The eigenvalue (N/m) that is nearest to zero of the matrix whose factors `system` holds; leaves its vector, of
/// B-norm 1 and B-orthogonal to `neutral`, in `vector`. `None` where that matrix is singular.
pub(super) fn inverse_iteration(
    system: &mut System,
    vector: &mut [f64],
    neutral: &NeutralModes,
) -> Option<f64> {
    let weight = neutral.weight();
    for (k, entry) in vector.iter_mut().enumerate() {
        // Any start that no symmetry is orthogonal to; the same on every machine.
        *entry = ((k + 1) as f64 * 0.618_033_988_75).fract() - 0.4;
    }
    let mut inverse = f64::NAN;
    for _ in 0..ITERATIONS {
        neutral.remove_from(vector);
        normalise(vector, weight);
        let before = inverse;
        let old = vector.to_vec();
        scale_angles(vector, weight);
        system.solve(vector).ok()?;
        inverse = inner(&old, vector, weight);
        if (inverse - before).abs() <= TOLERANCE * inverse.abs() {
            break;
        }
    }
    neutral.remove_from(vector);
    normalise(vector, weight);
    Some(1.0 / inverse)
}

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

fn normalise(vector: &mut [f64], weight: f64) {
    let norm = inner(vector, vector, weight).sqrt();
    vector.iter_mut().for_each(|entry| *entry /= norm);
}
