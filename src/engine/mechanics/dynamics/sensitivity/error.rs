//! Unsupported scenes and failures.

use crate::mechanics::SceneError;
use crate::mechanics::dynamics::report::SimulationError;

/// Reason why there are no derivatives.
#[derive(Debug, thiserror::Error)]
pub enum SensitivityError {
    /// The simulation itself failed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The scene contains a feature without derivatives.
    #[error("{0}")]
    Unsuitable(&'static str),
    /// The neighbours of a parameter cannot take the step, so its derivative is not defined.
    #[error(
        "at t = {time:.6e} s the step has no derivative: {reason}; shorten time.end or reduce time.step"
    )]
    NotRepeated {
        /// Time at the end of the step, s.
        time: f64,
        /// Why.
        reason: &'static str,
    },
    /// The Newton matrix is singular: the solution is at a limit point, or is not unique.
    #[error(
        "at t = {time:.6e} s the equations are singular, so that the solution has no derivative"
    )]
    Singular {
        /// Time, s.
        time: f64,
    },
}

impl From<SceneError> for SensitivityError {
    fn from(error: SceneError) -> Self {
        Self::Simulation(error.into())
    }
}
