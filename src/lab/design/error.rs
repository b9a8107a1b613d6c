//! What cannot be designed.

use crate::identify::IdentifyError;
use crate::scenario::ScenarioError;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_engine::mechanics::statics;
use rodlab_files::results::ResultsError;

/// Reason why there is no design.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// The scenario is wrong.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A curve or a key that cannot be used.
    #[error("{0}")]
    Input(String),
    /// No natural shape holds the curve.
    #[error(transparent)]
    Engine(#[from] statics::DesignError),
    /// The equilibrium of the designed rod was not found.
    #[error("equilibrium of the designed rod: {0}")]
    Simulation(#[from] SimulationError),
    /// The keys could not be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// A result could not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}
