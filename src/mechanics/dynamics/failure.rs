//! Why a step fails, and what is said of it.

use super::Simulation;
use super::report::SimulationError;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, Stage};

pub(super) enum Failure {
    Newton(Divergence),
    Penetration {
        iterations: usize,
        what: String,
    },
    /// Where the motion leads, or must lead, surfaces would cross.
    Crossing {
        iterations: usize,
        what: String,
    },
}

impl Failure {
    pub fn iterations(&self) -> usize {
        match self {
            Self::Newton(divergence) => divergence.iterations,
            Self::Penetration { iterations, .. } | Self::Crossing { iterations, .. } => *iterations,
        }
    }
}

impl Simulation {
    /// Returns to the last accepted state and says why the step failed.
    pub(super) fn give_up(&mut self, step: f64, failure: Failure) -> SimulationError {
        let error = match failure {
            Failure::Newton(divergence) => self.no_convergence(step, &divergence),
            Failure::Penetration { what, .. } => {
                SimulationError::Unphysical(format!("at t = {:.6e} s {what}", self.time))
            }
            Failure::Crossing { what, .. } => {
                SimulationError::Unphysical(format!("at t = {:.6e} s {what}", self.time))
            }
        };
        self.system.drive(self.time, &mut self.unknowns);
        self.system.update_geometry(&self.unknowns);
        error
    }

    /// Term, rod and node of the largest residual at a failed configuration.
    fn culprit(&mut self, stage: Option<&Stage>, unknown: usize) -> (&'static str, String, usize) {
        let term = self.system.largest_term(&self.trial, stage, unknown);
        let (rod, node) = self.system.assembly.locate(unknown / STRIDE);
        (term, self.system.assembly.names[rod].clone(), node)
    }

    fn no_convergence(&mut self, step: f64, divergence: &Divergence) -> SimulationError {
        let stage = self.stage.clone();
        let (term, rod, node) = self.culprit(Some(&stage), divergence.unknown);
        SimulationError::NoConvergence {
            time: self.time,
            step,
            residual: divergence.residual,
            term,
            rod,
            node,
        }
    }

    pub(super) fn no_equilibrium(&mut self, divergence: &Divergence) -> SimulationError {
        let (term, rod, node) = self.culprit(None, divergence.unknown);
        SimulationError::NoEquilibrium {
            iterations: divergence.iterations,
            residual: divergence.residual,
            term,
            rod,
            node,
        }
    }
}
