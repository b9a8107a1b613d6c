//! Matrices of small motions about an equilibrium: the mass matrix, and the Jacobian with a multiple of it.

use super::{Stage, System};
use crate::linalg::SingularMatrix;
use crate::mechanics::Vector3;

/// Largest number of unknowns for which the mass matrix is set up: it is first built as a dense
/// matrix, of 0.3 GB at this size.
pub(crate) const MOST_UNKNOWNS: usize = 6000;

impl System {
    /// Entries (row, column, kg or kg m²) of the mass matrix at `unknowns`, which were evaluated
    /// last; `None` for more than [`MOST_UNKNOWNS`] unknowns.
    pub(crate) fn mass_entries(&self, unknowns: &[f64]) -> Option<Vec<(usize, usize, f64)>> {
        if unknowns.len() > MOST_UNKNOWNS {
            return None;
        }
        let dense = self.assembly.mass_matrix_at(unknowns);
        let mut entries = Vec::new();
        for column in 0..unknowns.len() {
            for row in 0..unknowns.len() {
                let mass = dense[(row, column)];
                if mass != 0.0 {
                    entries.push((row, column, mass));
                }
            }
        }
        Some(entries)
    }

    /// Factors K + `scale` M (`scale` in 1/s²) at `unknowns`, with the Jacobian K of the equilibrium, without dashpots and
    /// drag.
    ///
    /// # Errors
    /// The unknown at which the matrix is singular.
    pub(crate) fn factor_with_masses(
        &mut self,
        unknowns: &[f64],
        scale: f64,
    ) -> Result<(), SingularMatrix> {
        self.undamp();
        let step = scale.sqrt().recip();
        let mut positions = vec![Vector3::zeros(); self.assembly.rods.nodes];
        super::copy_positions(unknowns, &mut positions);
        let stage = Stage {
            step,
            acceleration_step: step,
            keeps_spin: false,
            start: unknowns.to_vec(),
            velocity: vec![0.0; unknowns.len()],
            drag: Vec::new(),
            drag_velocity: Vec::new(),
            resistance: Vec::new(),
            flow_torque: Vec::new(),
            positions,
            angles: super::angles_of(unknowns),
        };
        let drag = std::mem::take(&mut self.terms.drag.coefficients);
        self.terms.cross_flow.set_still(true);
        self.linearize(unknowns, Some(&stage));
        self.terms.cross_flow.set_still(false);
        self.terms.drag.coefficients = drag;
        self.factor().map(drop)
    }
}
