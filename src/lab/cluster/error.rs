//! What can go wrong with Slurm.

use std::io;
use std::path::PathBuf;

/// Why Slurm did not do what it was asked to.
#[derive(Debug, thiserror::Error)]
pub enum ClusterError {
    /// A program of Slurm is missing (exit code 1).
    #[error("cannot call `{program}`: {source}; is Slurm on this machine, and on the PATH?")]
    Missing {
        /// The program.
        program: &'static str,
        /// What the operating system said.
        source: io::Error,
    },
    /// A program of Slurm failed (exit code 1).
    #[error("`{program}` failed: {message}")]
    Failed {
        /// The program.
        program: &'static str,
        /// What it said.
        message: String,
    },
    /// `sbatch` took a job and printed no number of it (exit code 1).
    #[error(
        "`sbatch` printed `{said}` instead of a job number; `squeue` shows whether the job exists"
    )]
    NoNumber {
        /// What it printed.
        said: String,
    },
    /// A file of the results directory could not be read or written (exit code 1).
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// Something that must stand on one line of the batch script does not (exit code 2).
    #[error(
        "the {what} {text:?} is not allowed in a batch script; leave out line breaks, other control characters and, in the name of the results directory, quotes and backslashes"
    )]
    NotOneLine {
        /// What it is.
        what: &'static str,
        /// What it reads.
        text: String,
    },
    /// The value of an option has blanks, quotes or other characters that end it early (exit code 2).
    #[error(
        "the {what} {text:?} is not one word; leave out blanks, quotes, backslashes and number signs"
    )]
    NotOneWord {
        /// What it is.
        what: &'static str,
        /// What it reads.
        text: String,
    },
    /// The record of the jobs is damaged (exit code 1).
    #[error("`{}` cannot be understood: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl ClusterError {
    /// Whether it is certain that there is no job.
    pub fn is_refusal(&self) -> bool {
        !matches!(self, Self::NoNumber { .. } | Self::Io { .. })
    }
}
