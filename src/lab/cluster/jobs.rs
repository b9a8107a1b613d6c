//! The record of the jobs in the results directory.

use super::ClusterError;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// The record of the jobs, in the results directory.
pub const JOBS: &str = "slurm.json";
/// Folder of the output of the tasks, in the results directory.
pub const LOGS: &str = "slurm";

/// The jobs that run the cases of a results directory.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Jobs {
    /// Number of tasks. A later job may repeat some of these tasks; it never adds tasks.
    pub tasks: usize,
    /// Numbers of the jobs in the order in which they were submitted.
    pub jobs: Vec<u64>,
}

impl Jobs {
    /// The jobs of a results directory; `None` if none were submitted.
    ///
    /// # Errors
    /// [`ClusterError::Io`], [`ClusterError::Damaged`].
    pub fn read(directory: &Path) -> Result<Option<Self>, ClusterError> {
        let path = directory.join(JOBS);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => {
                return Err(ClusterError::Io {
                    action: "read",
                    path,
                    source,
                });
            }
        };
        serde_json::from_slice(&bytes)
            .map(Some)
            .map_err(|error| ClusterError::Damaged {
                path,
                reason: error.to_string(),
            })
    }

    /// Writes the record.
    ///
    /// # Errors
    /// [`ClusterError::Io`].
    pub(super) fn write(&self, directory: &Path) -> Result<(), ClusterError> {
        let path = directory.join(JOBS);
        let text = serde_json::to_string_pretty(self).expect("jobs have string keys only");
        // A crash between two writes must not lose a job number: write a second file, then rename
        // it.
        let aside = directory.join(format!("{JOBS}.new"));
        fs::write(&aside, text + "\n")
            .and_then(|()| fs::rename(&aside, &path))
            .map_err(|source| ClusterError::Io {
                action: "write",
                path,
                source,
            })
    }
}
