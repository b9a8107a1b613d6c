//! Frequencies of a rod scene about an equilibrium.

use super::GroupError;
use nalgebra::DMatrix;
use rodlab_engine::mechanics::dynamics::Simulation;

/// Angular frequencies, ascending: K v = ω² M v has 1/ω² as the eigenvalues of L⁻¹ M L⁻ᵀ with K = L Lᵀ, where joints need no
/// mass.
pub(super) fn frequencies(simulation: &mut Simulation) -> Result<Vec<f64>, GroupError> {
    let (stiffness, masses) = (simulation.stiffness_matrix(), simulation.mass_matrix());
    let factor = stiffness.cholesky().ok_or("not stable")?.unpack();
    let half: Option<DMatrix<f64>> = factor.solve_lower_triangular(&masses);
    let matrix = factor.solve_lower_triangular(&half.ok_or("not stable")?.transpose());
    let eigenvalues = matrix.ok_or("not stable")?.symmetric_eigenvalues();
    let mut all: Vec<f64> = eigenvalues
        .iter()
        .map(|inverse| 1.0 / inverse.max(0.0).sqrt())
        .collect();
    all.sort_by(f64::total_cmp);
    Ok(all)
}
