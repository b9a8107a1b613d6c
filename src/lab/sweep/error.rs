//! Errors of sweeps.

use crate::scenario::ScenarioError;
use rodlab_files::results::ResultsError;
use std::path::PathBuf;

/// Reason why a sweep could not start or was aborted.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The scenario is wrong, or one of the values.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// Two cases are the same.
    #[error("the case `{id}` occurs twice; give each value once")]
    RepeatedCase {
        /// Id of the case.
        id: String,
    },
    /// A directory that does not hold a sweep.
    #[error("`{}` does not hold the results of a sweep", directory.display())]
    NoSweep {
        /// The directory.
        directory: PathBuf,
    },
    /// Results could not be written or read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The system could not start the threads.
    #[error("cannot start the threads of the cases: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The outcome that a search needs is missing.
    #[error("there is no column `{column}` to search by; columns: {known}")]
    UnknownObjective {
        /// The requested column.
        column: String,
        /// The existing columns.
        known: String,
    },
}
