//! Eigenpairs of the Hessian, H v = μ B v, by inverse iteration (Golub & Van Loan, Matrix
//! Computations, 4th ed., sec. 8.2.2). B weights angles by the square of the shortest edge, so
//! that μ is in N/m.

use super::inner_product::{inner, normalise, scale_angles};
use super::neutral::NeutralModes;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::System;

/// Most iterations. The lowest two eigenvalues of a rod are seldom closer than a tenth of the
/// lowest; if they coincide, any vector of their plane is accepted.
const ITERATIONS: usize = 60;
/// Relative change below which an eigenvalue counts as found.
const TOLERANCE: f64 = 1e-10;
/// The same for an eigenvalue whose zero is sought: it converges the faster, the closer to zero.
const ROUGH: f64 = 1e-4;
/// Largest eigenvalue of a motion without stiffness, relative to the shift of the Hessian.
const LARGEST_NEUTRAL_EIGENVALUE: f64 = 0.1;
/// Growth factor of the shift until the Hessian is positive.
const SHIFT_GROWTH: f64 = 2.0;
/// Most increases of the shift, after which it exceeds every stiffness.
const GROWTHS: usize = 100;

/// The lowest eigenvalue at `unknowns`, except those of motions without stiffness, N/m; the search
/// begins below `−shift`. `None` if the Hessian cannot be factored.
pub(super) fn lowest_eigenvalue(
    system: &mut System,
    unknowns: &[f64],
    neutral: &NeutralModes,
    mut shift: f64,
    scratch: &mut [f64],
) -> Option<f64> {
    // Shift below the lowest eigenvalue, which is then the nearest one.
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

/// The eigenvalue (N/m) nearest to zero of the Hessian whose factors `system` holds; zero if it is
/// singular.
pub(crate) fn nearest_eigenvalue(system: &mut System) -> f64 {
    let mut vector = vec![0.0; system.assembly.unknowns.len()];
    let neutral = NeutralModes::new(system.assembly.shortest_edge.powi(2));
    iterate(system, &mut vector, &neutral, ROUGH).unwrap_or(0.0)
}

/// The eigenvalue (N/m) nearest to zero of the matrix whose factors `system` holds. Leaves its
/// vector, of B-norm 1 and B-orthogonal to `neutral`, in `vector`. `None` if the matrix is
/// singular.
pub(super) fn inverse_iteration(
    system: &mut System,
    vector: &mut [f64],
    neutral: &NeutralModes,
) -> Option<f64> {
    iterate(system, vector, neutral, TOLERANCE)
}

/// Inverse iteration until the eigenvalue changes by less than the relative `tolerance`.
fn iterate(
    system: &mut System,
    vector: &mut [f64],
    neutral: &NeutralModes,
    tolerance: f64,
) -> Option<f64> {
    let weight = neutral.weight();
    let units = [1.0, 1.0, 1.0, 1.0 / weight.sqrt()];
    for (k, entry) in vector.iter_mut().enumerate() {
        // A start vector that is orthogonal to no symmetric motion; the same on every machine and
        // in every unit of length.
        let number = ((k + 1) as f64 * 0.618_033_988_75).fract() - 0.4;
        *entry = units[k % STRIDE] * number;
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
        if (inverse - before).abs() <= tolerance * inverse.abs() {
            break;
        }
    }
    neutral.remove_from(vector);
    normalise(vector, weight);
    Some(1.0 / inverse)
}

/// Finds all motions without stiffness with the factors of the Hessian at an equilibrium, to which `shift` (N/m) was
/// added; discards earlier ones.
pub(super) fn find_neutral_modes(
    neutral: &mut NeutralModes,
    system: &mut System,
    unknowns: usize,
    shift: f64,
) {
    neutral.clear();
    while neutral.count() < unknowns {
        let mut vector = vec![0.0; unknowns];
        let Some(eigenvalue) = inverse_iteration(system, &mut vector, neutral) else {
            return;
        };
        if (eigenvalue - shift).abs() > LARGEST_NEUTRAL_EIGENVALUE * shift {
            return;
        }
        neutral.push(vector);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Vector3;
    use crate::mechanics::scene::{RodDescription, Scene};
    use crate::mechanics::statics::equilibrium::find_equilibrium;
    use crate::mechanics::test_support::{free_rods, section};
    use std::f64::consts::TAU;

    const EDGES: usize = 24;

    /// A free ring that is naturally straight.
    fn ring(bending: [f64; 2]) -> Scene {
        let node = |k: usize| {
            let angle = TAU * k as f64 / EDGES as f64;
            Vector3::new(angle.cos(), angle.sin(), 0.0)
        };
        let centreline = (0..EDGES).map(node).collect();
        let stiffness = section(1e4, bending, 1.0);
        free_rods(vec![RodDescription {
            closed: true,
            first_director: Some(Vector3::z()),
            ..RodDescription::uniform("ring", centreline, stiffness, 1e-2, 1.0)
        }])
    }

    #[test]
    fn a_round_ring_moves_rigidly_and_rolls_and_a_flat_one_does_not_roll() {
        for (bending, expected) in [([1.0, 1.0], 7), ([1.0, 5.0], 6)] {
            let mut system = System::new(&ring(bending)).unwrap();
            let mut unknowns = system.assembly.unknowns.clone();
            find_equilibrium(&mut system, &mut unknowns, 1e-9).unwrap();
            let (shift, weight) = (1e-6, system.assembly.shortest_edge.powi(2));
            system.linearize(&unknowns, None);
            system.shift(shift, shift * weight);
            assert_eq!(system.factor().unwrap().unwrap().negative, 0);
            let mut modes = NeutralModes::new(weight);
            find_neutral_modes(&mut modes, &mut system, unknowns.len(), shift);
            assert_eq!(modes.count(), expected);
            // A translation of the whole ring is one of these motions or a combination of them.
            let mut rigid: Vec<f64> = (0..unknowns.len()).map(|k| f64::from(k % 4 == 1)).collect();
            modes.remove_from(&mut rigid);
            assert!(rigid.iter().all(|entry| entry.abs() < 1e-6));
        }
    }
}
