//! Calling `sbatch`, and the record of the jobs in the results directory.

use super::script::script;
use super::{ClusterError, Program, Request};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::{Command, Stdio};

/// The record of the jobs, in the results directory.
pub const JOBS: &str = "slurm.json";
/// Folder of what the tasks print, in the results directory.
pub const LOGS: &str = "slurm";

/// The jobs that run the cases of a results directory.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Jobs {
    /// Number of tasks; a later job may run some of them again, never others.
    pub tasks: usize,
    /// Numbers of the jobs in the order in which they were submitted.
    pub jobs: Vec<u64>,
}

impl Jobs {
    /// The jobs of a results directory; `None` where none were submitted.
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

    fn write(&self, directory: &Path) -> Result<(), ClusterError> {
        let path = directory.join(JOBS);
        let text = serde_json::to_string_pretty(self).expect("jobs have string keys only");
        // The number of a job must not be lost to a crash between two writes: aside first, then in place.
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

/// Submits a job array of the given tasks (counted from 1, growing), adds it to `jobs` and records them in
/// the results directory; returns the number of the job.
///
/// # Errors
/// [`ClusterError::Missing`] or [`ClusterError::Failed`] with what `sbatch` says; then nothing is recorded.
pub fn submit(
    program: &Program,
    request: &Request,
    tasks: &[usize],
    jobs: &mut Jobs,
) -> Result<u64, ClusterError> {
    let logs = program.directory.join(LOGS);
    fs::create_dir_all(&logs).map_err(|source| ClusterError::Io {
        action: "create",
        path: logs,
        source,
    })?;
    let job = sbatch(&script(program, request, tasks)?)?;
    jobs.jobs.push(job);
    jobs.write(&program.directory)?;
    Ok(job)
}

/// Hands a script to `sbatch`; returns the number of the job.
fn sbatch(script: &str) -> Result<u64, ClusterError> {
    let missing = |source| ClusterError::Missing {
        program: "sbatch",
        source,
    };
    let failed = |message: &str| ClusterError::Failed {
        program: "sbatch",
        message: message.trim().to_owned(),
    };
    let mut child = Command::new("sbatch")
        .arg("--parsable")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(missing)?;
    if let Some(mut input) = child.stdin.take() {
        // It may fail before it has read everything, and then says why.
        let _ = input.write_all(script.as_bytes());
    }
    let output = child.wait_with_output().map_err(missing)?;
    let said = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(failed(&String::from_utf8_lossy(&output.stderr)));
    }
    // `number` or, between clusters, `number;cluster`.
    let number = said.trim().split(';').next().unwrap_or_default();
    number
        .parse()
        .map_err(|_| failed(&format!("it said `{}`", said.trim())))
}
