//! Why parameters could not be identified.

use crate::scenario::ScenarioError;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_files::results::ResultsError;
use std::path::PathBuf;

/// Why parameters could not be identified.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// A scenario is wrong, or one of the values of its keys.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A file of data, or the request, is at fault.
    #[error("{0}")]
    Input(String),
    /// A row of a file of data is at fault.
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
