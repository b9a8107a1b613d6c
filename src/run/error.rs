//! Why a run ended early, and the exit code of each reason.

use super::Reached;
use crate::mechanics::dynamics::SimulationError;
use crate::results::ResultsError;
use std::path::PathBuf;

/// Why a run did not reach its end.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene cannot be set up; nothing was written (exit code 2).
    #[error(transparent)]
    Scene(SimulationError),
    /// The mechanics stopped: no convergence (exit code 3) or a physics check failed (4).
    #[error("{source}\nresults up to there are in `{}`", directory.display())]
    Simulation {
        /// What the simulation said.
        source: SimulationError,
        /// Where the results lie.
        directory: PathBuf,
    },
    /// The time limit was reached; a checkpoint was written (exit code 5).
    #[error(
        "time limit reached at {reached}; the same command continues from there, in `{}`",
        directory.display()
    )]
    TimeLimit {
        /// How far the run had come.
        reached: Reached,
        /// Where the results lie.
        directory: PathBuf,
    },
    /// Ctrl-C or SIGTERM; a checkpoint was written (exit code 130).
    #[error(
        "interrupted at {reached}; the same command continues from there, in `{}`",
        directory.display()
    )]
    Interrupted {
        /// How far the run had come.
        reached: Reached,
        /// Where the results lie.
        directory: PathBuf,
    },
    /// Results could not be written or read (exit code 1, or 2 where another directory must be chosen).
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl RunError {
    /// Exit code of the program.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(_) => 2,
            Self::Simulation { source, .. } => match source {
                SimulationError::BadScene(_) => 2,
                SimulationError::NoConvergence { .. }
                | SimulationError::NoContactForces { .. }
                | SimulationError::NoEquilibrium { .. } => 3,
                SimulationError::Unphysical(_) => 4,
            },
            Self::TimeLimit { .. } => 5,
            Self::Interrupted { .. } => 130,
            Self::Results(error) => error.exit_code(),
        }
    }
}
