//! Why a sweep could not be run, and the exit code of each reason.

use crate::results::ResultsError;
use crate::scenario::ScenarioError;
use std::path::PathBuf;

/// Why a sweep could not begin, or had to be given up.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The scenario is wrong, or one of the values (exit code 2).
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// Two cases are the same (exit code 2).
    #[error("the case `{id}` occurs twice; give each value once")]
    RepeatedCase {
        /// Its id.
        id: String,
    },
    /// A directory that is not that of a sweep (exit code 2).
    #[error("`{}` does not hold the results of a sweep", directory.display())]
    NoSweep {
        /// The directory.
        directory: PathBuf,
    },
    /// Results could not be written or read (exit code 1, or 2 where another directory must be chosen).
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The system could not start the threads (exit code 1).
    #[error("cannot start the threads of the cases: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A search has no outcome to look at (exit code 2).
    #[error("there is no column `{column}` to search by; there are {known}")]
    UnknownObjective {
        /// The column that was asked for.
        column: String,
        /// Those that exist.
        known: String,
    },
}

impl SweepError {
    /// Exit code of the program.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scenario(_)
            | Self::RepeatedCase { .. }
            | Self::NoSweep { .. }
            | Self::UnknownObjective { .. } => 2,
            Self::Results(error) => error.exit_code(),
            Self::Threads(_) => 1,
        }
    }
}
