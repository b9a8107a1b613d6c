//! Calling `sbatch`.

use super::jobs::{Jobs, LOGS};
use super::script::{Program, script};
use super::{ClusterError, Request};
use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

/// Submits a job array of the given tasks (counted from 1, ascending), adds it to `jobs` and
/// records them in the results directory; returns the number of the job.
///
/// # Errors
/// [`ClusterError::Missing`] or [`ClusterError::Failed`] with the message of `sbatch`; then nothing is recorded.
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
        // `sbatch` may fail before it has read the whole script, and then prints the reason.
        let _ = input.write_all(script.as_bytes());
    }
    let output = child.wait_with_output().map_err(missing)?;
    let said = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(failed(&String::from_utf8_lossy(&output.stderr)));
    }
    // The output is `number` or, between clusters, `number;cluster`.
    let number = said.trim().split(';').next().unwrap_or_default();
    number.parse().map_err(|_| ClusterError::NoNumber {
        said: said.trim().to_owned(),
    })
}
