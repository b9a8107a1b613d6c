//! The run loop: a prepared run goes in, a results directory comes out.

mod error;

pub use error::RunError;

use super::PreparedRun;
use crate::results::CaseOutcome;
use std::path::PathBuf;
use std::time::Duration;

/// How to run, as opposed to what.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Where the results go.
    pub directory: PathBuf,
    /// Start over where results exist, whatever scenario they are of.
    pub force: bool,
    /// The command line, for the manifest.
    pub command_line: Vec<String>,
    /// Show a progress bar on standard error (none appears where that is no terminal).
    pub progress: bool,
    /// Wall time after which the run stops with a checkpoint.
    pub timeout: Option<Duration>,
    /// Wall time between checkpoints.
    pub checkpoint_every: Duration,
}

impl RunOptions {
    /// The usual options for a run into `directory`: no time limit, a checkpoint every minute.
    pub fn new(directory: impl Into<PathBuf>) -> Self {
        Self {
            directory: directory.into(),
            force: false,
            command_line: std::env::args().collect(),
            progress: true,
            timeout: None,
            checkpoint_every: Duration::from_secs(60),
        }
    }
}

/// A run that reached its end.
#[derive(Clone, Debug)]
pub struct RunOutcome {
    /// Where the results lie.
    pub directory: PathBuf,
    /// Whether there was anything left to do.
    pub status: RunStatus,
    /// Steps, iterations, contacts.
    pub case: CaseOutcome,
    /// Wall time of this call and of the interrupted ones before it.
    pub wall_time: Duration,
}

/// What a successful call of [`run`] did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RunStatus {
    /// Ran from the beginning.
    Finished,
    /// Continued from a checkpoint at this simulated time, s.
    Resumed {
        /// Simulated time of the checkpoint, s.
        from: f64,
    },
    /// The results were there already; nothing was run.
    AlreadyFinished,
}

/// Runs to the end and writes the results directory.
///
/// Idempotent: finished results of the same scenario are left alone, interrupted ones are continued
/// from their last checkpoint, bit for bit.
///
/// # Errors
/// See [`RunError`]; its [`exit_code`](RunError::exit_code) is that of the program.
pub fn run(_prepared: &PreparedRun, _options: &RunOptions) -> Result<RunOutcome, RunError> {
    todo!()
}
