//! Roots of several equations, for shooting.

use nalgebra::{SMatrix, SVector};

/// Step of difference quotients.
const DIFFERENCE: f64 = 1e-6;
const ITERATIONS: usize = 30;

/// Finds a root of a function by Newton's method with central differences, from a start near it.
pub(super) fn root<const N: usize>(
    start: [f64; N],
    function: impl Fn([f64; N]) -> [f64; N],
) -> [f64; N] {
    let value = |at: SVector<f64, N>| SVector::<f64, N>::from(function(at.into()));
    let mut here = SVector::<f64, N>::from(start);
    for _ in 0..ITERATIONS {
        let columns: [SVector<f64, N>; N] = std::array::from_fn(|axis| {
            let mut change = SVector::<f64, N>::zeros();
            change[axis] = DIFFERENCE;
            (value(here + change) - value(here - change)) / (2.0 * DIFFERENCE)
        });
        let Some(inverse) = SMatrix::<f64, N, N>::from_columns(&columns).try_inverse() else {
            break;
        };
        let step = inverse * value(here);
        here -= step;
        if step.norm() < 1e-12 {
            break;
        }
    }
    here.into()
}
