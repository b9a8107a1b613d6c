//! Errors of results directories.

use std::io;
use std::path::PathBuf;

/// Reason why results could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// The directory holds the results of another scenario.
    #[error(
        "`{}` holds results of another scenario, which differs in\n{}\nchoose another directory with --out, or start over \
         with --force",
        directory.display(),
        indented(keys)
    )]
    AnotherScenario {
        /// The directory.
        directory: PathBuf,
        /// The differing keys.
        keys: Vec<String>,
    },
    /// The directory holds results of another kind.
    #[error(
        "`{}` holds {held}, but this is {asked}; choose another directory with --out, or start over with --force",
        directory.display()
    )]
    AnotherKind {
        /// The directory.
        directory: PathBuf,
        /// The kind of its results.
        held: String,
        /// The requested kind.
        asked: String,
    },
    /// The directory holds the output of another command.
    #[error("`{}` holds the output of `{command}`; choose another directory with --out", directory.display())]
    AnotherCommand {
        /// The directory.
        directory: PathBuf,
        /// The command.
        command: String,
    },
    /// The directory holds files that are not results.
    #[error(
        "`{}` is not empty and not a results directory (it holds `{found}`, but no manifest.json \
         of rodlab); choose another with --out",
        directory.display()
    )]
    NotResults {
        /// The directory.
        directory: PathBuf,
        /// A file or folder that does not belong to a run.
        found: String,
    },
    /// A folder of the results is a link; files elsewhere would be written or removed through it.
    #[error("`{}` is a link; results are neither written nor removed through links: put a folder \
             in its place", path.display())]
    Link {
        /// The link.
        path: PathBuf,
    },
    /// The file at a path chosen by the user must not be replaced.
    #[error("`{}` is {what} and is not replaced; choose another path or remove it", path.display())]
    NotOwn {
        /// The place.
        path: PathBuf,
        /// Kind of the directory.
        what: &'static str,
    },
    /// Another process is writing to the directory.
    #[error("another process is writing to `{}`; wait for it or choose another directory with --out", directory.display())]
    Locked {
        /// The directory.
        directory: PathBuf,
    },
    /// The directory cannot be created or written.
    #[error("cannot write to the results directory `{}`: {source}; choose another with --out", directory.display())]
    NotWritable {
        /// The directory.
        directory: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A file of the directory is damaged.
    #[error("`{}` is damaged: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The error.
        reason: String,
    },
    /// A file differs from what the run wrote.
    #[error(
        "`{}` {what}: it was changed after rodlab wrote it; restore it, or start over with --force \
         (of a sweep: remove the folder of the case)",
        path.display()
    )]
    Altered {
        /// The file, or the folder of a series.
        path: PathBuf,
        /// The error.
        what: String,
    },
    /// Reading or writing failed during a run, for example because the disk is full.
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// The failed action: `write`, `read`, ...
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

fn indented(lines: &[String]) -> String {
    let lines: Vec<String> = lines.iter().map(|line| format!("  {line}")).collect();
    lines.join("\n")
}

impl ResultsError {
    /// Converts an error of the operating system to one that names the file.
    pub fn io(action: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io {
            action,
            path,
            source,
        }
    }
}
