//! Reason why parameters could not be identified.

use crate::scenario::ScenarioError;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_files::results::ResultsError;
use std::path::PathBuf;

/// Reason why parameters could not be identified.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// The scenario, or a value of one of its keys, is wrong.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A data file, or the request, is wrong.
    #[error("{0}")]
    Input(String),
    /// A row of a data file is wrong.
    #[error("{}, line {line}: {message}", file.display())]
    Row {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The fault, and what is allowed.
        message: String,
    },
    /// A simulation failed at the start values, or at all values near an estimate.
    #[error("{scenario}: {source}")]
    Simulation {
        /// Name of the scenario.
        scenario: String,
        /// The failure.
        source: SimulationError,
    },
    /// The user asked to stop.
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// A result could not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}
