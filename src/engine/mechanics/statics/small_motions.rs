//! Stability of an equilibrium whose forces have no potential, by its small motions M ü + K u = 0.
//!
//! With loads that rotate with the rod, and with moments of fixed direction, K is not symmetric,
//! and the signs of its pivots do not determine stability. The motions u ∝ e^{λt} have λ² = −μ
//! with the eigenvalues μ of M⁻¹K. The equilibrium is stable if all of them are real and positive.
//! A negative one diverges; two that have met and are no longer real **flutter**, oscillations
//! that grow (Bolotin 1963; Langthjem & Sugiyama 2000). Damping is not included, although it may
//! destabilise such loads further (Ziegler 1952).
//!
//! The eigenvalues nearest to zero are found by Arnoldi's method on (K + σM)⁻¹M, whose eigenvalues
//! are 1/(μ + σ), in the inner product of M (Saad, Numerical Methods for Large Eigenvalue
//! Problems, 2nd ed., sec. 8.1). Only converged eigenvalues are used: the lowest ten or more.
//! Motions that lose stability are among the lowest in all known cases.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::System;
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Most vectors of the Krylov space.
const DIMENSION: usize = 40;
/// Eigenvalues of the inverse below this fraction of the largest belong to high modes and are
/// ignored.
const HIGH: f64 = 1e-5;
/// Relative residual of an eigenvalue at which it counts as converged.
const CONVERGED: f64 = 1e-9;
/// Imaginary part, relative to |μ + σ|, above which an eigenvalue is not real. Rounding causes
/// smaller ones in pairs that are equal by symmetry, as those of a round rod are.
const NOT_REAL: f64 = 1e-6;
/// Bound, as a fraction of σ, by which a negative eigenvalue must lie below zero; that of a motion
/// without stiffness does not.
const NEGATIVE: f64 = 1e-7;
/// Norm of a new vector, relative to that before orthogonalisation, below which the space is
/// complete.
const EXHAUSTED: f64 = 1e-13;
/// σ in the unit EI/L³ over the mass of all rods, in which the lowest μ of a cantilever is 12.4.
const SHIFT: f64 = 10.0;

/// Number of growing small motions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unstable {
    /// Growing motions without oscillation; for forces with a potential, directions in which it
    /// decreases.
    pub divergent: usize,
    /// Growing oscillations, in pairs of conjugate eigenvalues.
    pub flutter: usize,
}

impl Unstable {
    /// Number of eigenvalues.
    pub(crate) fn total(&self) -> usize {
        self.divergent + 2 * self.flutter
    }
}

/// The small motions about an equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SmallMotions {
    /// The growing motions.
    pub unstable: Unstable,
    /// Rate at which the fastest of them grows, 1/s; 0 if none does.
    pub growth_rate: f64,
    /// Frequency of the fastest growing motion, or the lowest frequency if none grows, Hz.
    pub frequency: f64,
}

/// The small motions at an equilibrium; `None` if there are too many unknowns, no free unknowns,
/// or K + σM is singular.
pub(crate) fn small_motions(system: &mut System, unknowns: &[f64]) -> Option<SmallMotions> {
    let shift = SHIFT * lowest_scale(system, unknowns)?;
    system.factor_with_masses(unknowns, shift).ok()?;
    let masses = system.mass_entries(unknowns)?;
    let (projected, last) = project(system, &masses, unknowns.len())?;
    let mut found = SmallMotions::default();
    let mut lowest = f64::INFINITY;
    let inverses = projected.complex_eigenvalues();
    let sizes = inverses.iter().map(|one| libm::hypot(one.re, one.im));
    let largest = sizes.fold(0.0, f64::max);
    for inverse in inverses.iter() {
        let size = libm::hypot(inverse.re, inverse.im);
        if !(size > HIGH * largest) || residual(&projected, last, *inverse) > CONVERGED * size {
            continue;
        }
        // 1/θ − σ
        let real = inverse.re / (size * size) - shift;
        let imaginary = -inverse.im / (size * size);
        if imaginary.abs() > NOT_REAL / size {
            // Count only one of a conjugate pair.
            if imaginary > 0.0 {
                found.unstable.flutter += 1;
                let modulus = libm::hypot(real, imaginary);
                let growth = (0.5 * (modulus - real)).max(0.0).sqrt();
                let frequency = (0.5 * (modulus + real)).max(0.0).sqrt() / TAU;
                found.note(growth, frequency);
            }
        } else if real < -NEGATIVE * shift {
            found.unstable.divergent += 1;
            found.note((-real).sqrt(), 0.0);
        } else {
            lowest = lowest.min(real.max(0.0));
        }
    }
    if found.unstable.total() == 0 && lowest.is_finite() {
        found.frequency = lowest.sqrt() / TAU;
    }
    Some(found)
}

impl SmallMotions {
    /// Keeps the fastest-growing motion.
    fn note(&mut self, growth_rate: f64, frequency: f64) {
        if growth_rate > self.growth_rate {
            (self.growth_rate, self.frequency) = (growth_rate, frequency);
        }
    }

    /// Describes the fastest growth of an unstable equilibrium; `None` if it is stable.
    pub(crate) fn in_words(&self) -> Option<String> {
        let Self {
            unstable,
            growth_rate,
            frequency,
        } = self;
        if unstable.total() == 0 {
            return None;
        }
        Some(if *frequency > 0.0 {
            format!(
                "flutter, oscillations at {frequency:.4} Hz grow by a factor of e in {:.4} s",
                1.0 / growth_rate
            )
        } else {
            format!(
                "divergence, deviations grow by a factor of e in {:.4} s",
                1.0 / growth_rate
            )
        })
    }
}

/// EI/L³ of the softest rod over the mass of all that is free, 1/s².
fn lowest_scale(system: &System, unknowns: &[f64]) -> Option<f64> {
    let assembly = &system.assembly;
    let of_nodes = (0..STRIDE * assembly.rods.nodes).step_by(STRIDE);
    let free = of_nodes.filter(|k| !assembly.held[*k]);
    let mass: f64 = free.map(|k| assembly.masses[k]).sum();
    let stiffness = assembly.softest_scale / super::equilibrium::extent(unknowns);
    let scale = stiffness / mass;
    (scale > 0.0 && scale.is_finite()).then_some(scale)
}

/// Projects (K + σM)⁻¹M, of which `system` holds the factors, on a Krylov space. Returns its
/// matrix there, and the norm of the part of the last vector outside the space.
fn project(
    system: &mut System,
    masses: &[(usize, usize, f64)],
    unknowns: usize,
) -> Option<(DMatrix<f64>, f64)> {
    let weigh = |vector: &[f64]| {
        let mut weighed = vec![0.0; unknowns];
        for (row, column, mass) in masses {
            weighed[*row] += mass * vector[*column];
        }
        weighed
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    // A start vector that is orthogonal to no symmetric motion; the same on every machine.
    let mut next: Vec<f64> = (0..unknowns)
        .map(|k| ((k + 1) as f64 * 0.618_033_988_75).fract() - 0.4)
        .collect();
    for (entry, held) in next.iter_mut().zip(&system.assembly.held) {
        if *held {
            *entry = 0.0;
        }
    }
    next = weigh(&next);
    system.solve(&mut next).ok()?;
    let (mut basis, mut weighed): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let mut matrix = DMatrix::zeros(DIMENSION, DIMENSION);
    let mut last = 0.0;
    let mut size = 0.0;
    while basis.len() < DIMENSION {
        let image = weigh(&next);
        let norm = dot(&next, &image).max(0.0).sqrt();
        if basis.is_empty() {
            size = norm;
        }
        let column = basis.len();
        if !(norm > EXHAUSTED * size) {
            last = 0.0;
            break;
        }
        if column > 0 {
            matrix[(column, column - 1)] = norm;
        }
        basis.push(next.iter().map(|entry| entry / norm).collect());
        weighed.push(image.iter().map(|entry| entry / norm).collect());
        next.clone_from(&weighed[column]);
        system.solve(&mut next).ok()?;
        size = dot(&next, &weigh(&next)).max(0.0).sqrt();
        // Orthogonalising twice is enough (Parlett).
        for _ in 0..2 {
            for row in 0..=column {
                let part = dot(&weighed[row], &next);
                matrix[(row, column)] += part;
                for (entry, own) in next.iter_mut().zip(&basis[row]) {
                    *entry -= part * own;
                }
            }
        }
        last = dot(&next, &weigh(&next)).max(0.0).sqrt();
    }
    let dimension = basis.len();
    (dimension > 0).then(|| {
        (
            matrix.view((0, 0), (dimension, dimension)).into_owned(),
            last,
        )
    })
}

/// Residual, in the full space, of an eigenvalue θ of the projected matrix: the last entry of its
/// vector times the part outside the space.
fn residual(projected: &DMatrix<f64>, last: f64, value: Complex<f64>) -> f64 {
    if last == 0.0 {
        return 0.0;
    }
    let size = projected.nrows();
    // Shifted slightly from the eigenvalue, where the matrix is not singular.
    let beside = value * (1.0 + 1e-10);
    let shifted = DMatrix::from_fn(size, size, |row, column| {
        let entry = Complex::new(projected[(row, column)], 0.0);
        if row == column { entry - beside } else { entry }
    });
    let factors = shifted.lu();
    let mut vector = DVector::from_element(size, Complex::new(1.0, 0.0));
    for _ in 0..2 {
        if !factors.solve_mut(&mut vector) {
            return f64::INFINITY;
        }
        let norm = vector
            .iter()
            .map(|y| y.re * y.re + y.im * y.im)
            .sum::<f64>();
        let scale = norm.sqrt().recip();
        vector.iter_mut().for_each(|y| *y *= scale);
    }
    let end = vector[size - 1];
    last * libm::hypot(end.re, end.im)
}
