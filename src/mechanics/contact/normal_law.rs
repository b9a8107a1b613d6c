//! The normal force law of one contact: that of the contact model, for its size and the present stiffness.

use super::normal_response::NormalResponse;
use super::parameters::{ContactModel, ContactParameters};
use super::{barrier, potential};

/// Why complementarity never asks for a law.
const RIGID: &str = "the forces of rigid contact are constraints, no functions of the gap";

/// A normal force law N(g).
#[derive(Clone, Copy, Debug)]
pub(super) struct NormalLaw {
    model: ContactModel,
    /// Mean radius h̄ of the two surfaces, m.
    scale: f64,
    /// Distance tolerance δ, m.
    tolerance: f64,
    /// Contact stiffness k, J.
    stiffness: f64,
}

impl NormalLaw {
    /// The law between surfaces of mean radius `scale` (m).
    pub fn new(parameters: &ContactParameters, scale: f64, stiffness: f64) -> Self {
        Self {
            model: parameters.model,
            scale,
            tolerance: parameters.distance_tolerance,
            stiffness,
        }
    }

    /// Energy and force at a surface gap, m.
    pub fn response(&self, gap: f64) -> NormalResponse {
        let (scale, tolerance, stiffness) = (self.scale, self.tolerance, self.stiffness);
        match self.model {
            ContactModel::ImplicitContact => {
                potential::normal_response(gap, scale, tolerance, stiffness)
            }
            ContactModel::IncrementalPotential => {
                barrier::normal_response(gap, scale, tolerance, stiffness)
            }
            ContactModel::Complementarity => unreachable!("{RIGID}"),
        }
    }

    /// The surface gap (m) at which the force is `force` (N), positive.
    pub fn gap_of_force(&self, force: f64) -> f64 {
        let (scale, tolerance, stiffness) = (self.scale, self.tolerance, self.stiffness);
        match self.model {
            ContactModel::ImplicitContact => {
                potential::gap_of_force(force, scale, tolerance, stiffness)
            }
            ContactModel::IncrementalPotential => {
                barrier::gap_of_force(force, scale, tolerance, stiffness)
            }
            ContactModel::Complementarity => unreachable!("{RIGID}"),
        }
    }
}
