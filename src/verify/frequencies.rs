//! Frequencies of a rod scene about an equilibrium.

use super::GroupError;
use nalgebra::DMatrix;
use rodlab_engine::mechanics::dynamics::Simulation;

/// Angular frequencies of a simulation about its state, ascending.
pub(super) fn frequencies(simulation: &mut Simulation) -> Result<Vec<f64>, GroupError> {
    let stiffness = simulation.stiffness_matrix();
    frequencies_of(stiffness, &simulation.mass_matrix())
}

/// Angular frequencies, ascending. The eigenproblem K v = ω² M v has 1/ω² as the eigenvalues of
/// L⁻¹ M L⁻ᵀ with K = L Lᵀ, so that joints need no mass.
pub(super) fn frequencies_of(
    stiffness: DMatrix<f64>,
    masses: &DMatrix<f64>,
) -> Result<Vec<f64>, GroupError> {
    let factor = stiffness.cholesky().ok_or("not stable")?.unpack();
    let half = factor.solve_lower_triangular(masses).ok_or("not stable")?;
    let matrix = factor.solve_lower_triangular(&half.transpose());
    let eigenvalues = matrix.ok_or("not stable")?.symmetric_eigenvalues();
    let frequency = |inverse: &f64| 1.0 / inverse.max(0.0).sqrt();
    Ok(ascending(eigenvalues.iter().map(frequency)))
}

/// Numbers from the least to the largest.
pub(super) fn ascending(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = numbers.collect();
    all.sort_by(f64::total_cmp);
    all
}

/// The frequency nearest to a given one; NaN if there is none.
pub(super) fn nearest(frequencies: &[f64], to: f64) -> f64 {
    let distance = |one: &f64| (one - to).abs();
    let found = frequencies.iter().copied();
    found
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(f64::NAN)
}
