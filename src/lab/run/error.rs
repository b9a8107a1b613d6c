//! Why a run ended early.

use super::Reached;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_files::results::ResultsError;
use std::path::PathBuf;

/// Reason why a run did not reach its end.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene is invalid; nothing was written.
    #[error(transparent)]
    Scene(SimulationError),
    /// The mechanics failed: no convergence, or a failed physics check.
    #[error("{source}\nresults up to there are in `{}`", directory.display())]
    Simulation {
        /// The error of the simulation.
        source: SimulationError,
        /// The results directory.
        directory: PathBuf,
    },
    /// The time limit was reached; a checkpoint was written.
    #[error(
        "time limit reached at {reached}; run the same command again to resume, in `{}`",
        directory.display()
    )]
    TimeLimit {
        /// Progress of the run.
        reached: Reached,
        /// The results directory.
        directory: PathBuf,
    },
    /// Ctrl-C or SIGTERM; a checkpoint was written.
    #[error(
        "interrupted at {reached}; run the same command again to resume, in `{}`",
        directory.display()
    )]
    Interrupted {
        /// Progress of the run.
        reached: Reached,
        /// The results directory.
        directory: PathBuf,
    },
    /// Results could not be written or read.
    #[error(transparent)]
    Results(#[from] ResultsError),
}
