//! Errors of calls to Slurm.

use std::io;
use std::path::PathBuf;

/// Failure of a call to Slurm.
#[derive(Debug, thiserror::Error)]
pub enum ClusterError {
    /// A program of Slurm is missing (exit code 1).
    #[error("cannot call `{program}`: {source}; is Slurm on this machine, and on the PATH?")]
    Missing {
        /// The program.
        program: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A program of Slurm failed (exit code 1).
    #[error("`{program}` failed: {message}")]
    Failed {
        /// The program.
        program: &'static str,
        /// Message of the command.
        message: String,
    },
    /// `sbatch` accepted a job and printed no job number (exit code 1).
    #[error(
        "`sbatch` printed `{said}` instead of a job number; `squeue` shows whether the job exists"
    )]
    NoNumber {
        /// Output of the command.
        said: String,
    },
    /// A file of the results directory could not be read or written (exit code 1).
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// The operation, as a verb.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A text that must fit on one line of the batch script does not (exit code 2).
    #[error(
        "the {what} {text:?} is not allowed in a batch script; leave out line breaks, other control characters and, in the name of the results directory, quotes and backslashes"
    )]
    NotOneLine {
        /// Name of the text.
        what: &'static str,
        /// The text.
        text: String,
    },
    /// The value of an option has blanks, quotes or other characters that end it early (exit code 2).
    #[error(
        "the {what} {text:?} is not one word; leave out blanks, quotes, backslashes and number signs"
    )]
    NotOneWord {
        /// Name of the text.
        what: &'static str,
        /// The text.
        text: String,
    },
    /// The record of the jobs is damaged (exit code 1).
    #[error("`{}` cannot be understood: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Description of the fault.
        reason: String,
    },
}

impl ClusterError {
    /// Whether the failure proves that no job was submitted.
    pub fn is_refusal(&self) -> bool {
        !matches!(self, Self::NoNumber { .. } | Self::Io { .. })
    }
}
