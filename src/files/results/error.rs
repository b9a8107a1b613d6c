//! What can go wrong with a results directory.

use std::io;
use std::path::PathBuf;

/// Why results could not be written or read.
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
        /// In what it differs, a key each.
        keys: Vec<String>,
    },
    /// The directory holds results of another kind.
    #[error(
        "`{}` holds {held}, and this is {asked}; choose another directory with --out, or start over with --force",
        directory.display()
    )]
    AnotherKind {
        /// The directory.
        directory: PathBuf,
        /// What it holds.
        held: String,
        /// What is to be written.
        asked: String,
    },
    /// The directory holds what another command wrote.
    #[error("`{}` holds what `{command}` wrote; choose another directory with --out", directory.display())]
    AnotherCommand {
        /// The directory.
        directory: PathBuf,
        /// The command.
        command: String,
    },
    /// The directory holds files that are no results.
    #[error(
        "`{}` is not empty and not a results directory (it holds `{found}`, but no manifest.json of rodlab); choose another with --out",
        directory.display()
    )]
    NotResults {
        /// The directory.
        directory: PathBuf,
        /// A file or folder that no run writes.
        found: String,
    },
    /// A folder of results is a link, through which files elsewhere would be written or removed.
    #[error("`{}` is a link; results are neither written nor removed through links: put a folder in its place", path.display())]
    Link {
        /// The link.
        path: PathBuf,
    },
    /// What stands at a place that the user chose is not to be replaced.
    #[error("`{}` is {what}, which is not replaced; choose another place or remove it", path.display())]
    NotOwn {
        /// The place.
        path: PathBuf,
        /// What stands there.
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
        /// What the operating system said.
        source: io::Error,
    },
    /// A file of the directory is damaged.
    #[error("`{}` cannot be understood: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file is not what the run wrote.
    #[error(
        "`{}` {what}: these are no longer the results that were written; put it back as it was, or start over with --force \
         (of a sweep: remove the folder of the case)",
        path.display()
    )]
    Altered {
        /// The file, or the folder of a series.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// Reading or writing failed during a run, for example because the disk is full.
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// What was tried: `write`, `read`, ...
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
}

fn indented(lines: &[String]) -> String {
    let lines: Vec<String> = lines.iter().map(|line| format!("  {line}")).collect();
    lines.join("\n")
}

impl ResultsError {
    /// Turns an error of the operating system into one that names the file.
    pub fn io(action: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io {
            action,
            path,
            source,
        }
    }
}
