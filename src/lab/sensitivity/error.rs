//! Errors of derivatives.

use crate::scenario::ScenarioError;
use rodlab_engine::mechanics::dynamics::{SimulationError, sensitivity};

/// Reason why there are no derivatives.
#[derive(Debug, thiserror::Error)]
pub enum SensitivityError {
    /// The scenario, or a copy with a slightly changed key, is wrong.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A key that does not suit.
    #[error("`{key}`: {reason}")]
    Key {
        /// The key.
        key: String,
        /// The reason.
        reason: String,
    },
    /// A probe or column that the scenario does not have.
    #[error("there is no probe or column `{name}`; {known}")]
    Probe {
        /// Name of the probe.
        name: String,
        /// The existing ones.
        known: String,
    },
    /// A kind of run without derivatives.
    #[error("{0}")]
    Unsuitable(&'static str),
    /// A request to stop.
    #[error("interrupted")]
    Interrupted,
    /// The mechanics.
    #[error(transparent)]
    Engine(#[from] sensitivity::SensitivityError),
}

impl From<SimulationError> for SensitivityError {
    fn from(error: SimulationError) -> Self {
        Self::Engine(error.into())
    }
}
