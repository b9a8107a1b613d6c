//! Why a step or an equilibrium fails, and what is reported of it.

use super::report::SimulationError;
use crate::mechanics::Overlap;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, Stage, System};
use std::fmt;

/// Why one attempt at a step fails.
#[derive(Debug)]
pub(super) enum Failure {
    /// Newton's method does not converge.
    Newton(Divergence),
    /// Surfaces overlap by more than is allowed.
    Penetration { iterations: usize, overlap: Overlap },
    /// Where the motion leads, or must lead, surfaces would cross.
    Crossing {
        iterations: usize,
        what: &'static str,
    },
}

impl Failure {
    /// Newton iterations that were spent.
    pub fn iterations(&self) -> usize {
        match self {
            Self::Newton(divergence) => divergence.iterations,
            Self::Penetration { iterations, .. } | Self::Crossing { iterations, .. } => *iterations,
        }
    }

    /// The error of a run whose step of a size (s) from `time` (s) fails so; `trial` is where Newton's method ended.
    pub fn into_error(
        self,
        system: &mut System,
        trial: &[f64],
        stage: &Stage,
        [time, step]: [f64; 2],
    ) -> SimulationError {
        match self {
            Self::Newton(divergence) => {
                let place = Place::of(system, trial, Some(stage), divergence.unknown);
                SimulationError::NoConvergence {
                    time,
                    step,
                    residual: divergence.residual,
                    term: place.term,
                    rod: place.rod,
                    node: place.node,
                }
            }
            Self::Penetration { .. } | Self::Crossing { .. } => {
                SimulationError::Unphysical(format!("at t = {time:.6e} s {self}"))
            }
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Newton(divergence) => write!(
                formatter,
                "no convergence in {} iterations, residual {:.3e} N",
                divergence.iterations, divergence.residual
            ),
            Self::Penetration { overlap, .. } => overlap.fmt(formatter),
            Self::Crossing { what, .. } => formatter.write_str(what),
        }
    }
}

/// Where Newton's method fails.
struct Place {
    /// The term of the residual that is largest there.
    term: &'static str,
    rod: String,
    /// Node along the rod.
    node: usize,
}

impl Place {
    fn of(system: &mut System, trial: &[f64], stage: Option<&Stage>, unknown: usize) -> Self {
        let term = system.largest_term(trial, stage, unknown);
        let (rod, node) = system.assembly.locate(unknown / STRIDE);
        Self {
            term,
            rod: system.assembly.names[rod].clone(),
            node,
        }
    }
}

/// The error of a search for an equilibrium that ended at `trial`.
pub(super) fn no_equilibrium(
    system: &mut System,
    trial: &[f64],
    divergence: &Divergence,
) -> SimulationError {
    let place = Place::of(system, trial, None, divergence.unknown);
    SimulationError::NoEquilibrium {
        iterations: divergence.iterations,
        residual: divergence.residual,
        term: place.term,
        rod: place.rod,
        node: place.node,
    }
}
