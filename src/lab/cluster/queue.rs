//! States of the tasks of a job array, from `scontrol`.

use super::ClusterError;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::process::Command;

/// A task of a job array as Slurm sees it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Task {
    /// The job.
    pub job: u64,
    /// Number of the task, from 1.
    pub number: usize,
    /// State of the task.
    pub state: TaskState,
    /// State and reason in Slurm's words, such as `PENDING (Resources)`.
    pub words: String,
    /// Node on which it runs or ran.
    pub nodes: String,
    /// Time for which it runs or ran, as `HH:MM:SS`.
    pub run_time: String,
    /// Number of times it was requeued.
    pub restarts: u32,
}

/// State of a task as far as it matters for its cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TaskState {
    /// It is pending.
    Waiting,
    /// The task runs, or is about to end.
    Running,
    /// The task has ended, for any reason.
    Ended,
}

impl fmt::Display for TaskState {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Waiting => "waiting",
            Self::Running => "running",
            Self::Ended => "ended",
        })
    }
}

/// The tasks of the given jobs, by number; if several jobs have the same task, the last job counts. Slurm drops tasks some
/// minutes after their end; these are missing.
///
/// # Errors
/// [`ClusterError::Missing`] if there is no `scontrol`; [`ClusterError::Failed`] if it fails for a
/// reason other than an unknown job.
pub fn tasks(jobs: &[u64]) -> Result<BTreeMap<usize, Task>, ClusterError> {
    let mut tasks = BTreeMap::new();
    for job in jobs {
        let output = Command::new("scontrol")
            .args(["--oneliner", "show", "job", &job.to_string()])
            .output()
            .map_err(|source| ClusterError::Missing {
                program: "scontrol",
                source,
            })?;
        let message = String::from_utf8_lossy(&output.stderr);
        if !output.status.success() {
            if message.contains("Invalid job id") {
                continue;
            }
            return Err(ClusterError::Failed {
                program: "scontrol",
                message: message.trim().to_owned(),
            });
        }
        let text = String::from_utf8_lossy(&output.stdout);
        for task in text.lines().flat_map(|line| parse(*job, line)) {
            tasks.insert(task.number, task);
        }
    }
    Ok(tasks)
}

/// The tasks of one line of `scontrol --oneliner`. Waiting tasks share a line.
fn parse(job: u64, line: &str) -> Vec<Task> {
    let fields: BTreeMap<&str, &str> = line
        .split_whitespace()
        .filter_map(|field| field.split_once('='))
        .collect();
    let field = |name: &str| fields.get(name).copied().unwrap_or_default();
    let words = match field("Reason") {
        "" | "None" => field("JobState").to_owned(),
        reason => format!("{} ({reason})", field("JobState")),
    };
    let state = match field("JobState") {
        "PENDING" | "REQUEUED" | "REQUEUE_HOLD" | "SUSPENDED" => TaskState::Waiting,
        "RUNNING" | "CONFIGURING" | "COMPLETING" | "STAGE_OUT" | "RESIZING" => TaskState::Running,
        _ => TaskState::Ended,
    };
    let task = |number| Task {
        job,
        number,
        state,
        words: words.clone(),
        nodes: field("NodeList").to_owned(),
        run_time: field("RunTime").to_owned(),
        restarts: field("Restarts").parse().unwrap_or_default(),
    };
    numbers(field("ArrayTaskId"))
        .into_iter()
        .map(task)
        .collect()
}

/// The numbers of `1,3-6%2`.
fn numbers(text: &str) -> Vec<usize> {
    let list = text.split('%').next().unwrap_or_default();
    list.split(',')
        .filter_map(|part| {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            Some(first.parse().ok()?..=last.parse().ok()?)
        })
        .flatten()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_tasks_share_a_line() {
        let line = "JobId=1 ArrayJobId=1 ArrayTaskId=1,3-5%2 JobName=a b JobState=PENDING Reason=Resources \
                    Restarts=0 RunTime=00:00:00 NodeList= ";
        let tasks = parse(1, line);
        let found: Vec<usize> = tasks.iter().map(|task| task.number).collect();
        assert_eq!(found, [1, 3, 4, 5]);
        assert_eq!(tasks[0].state, TaskState::Waiting);
        assert_eq!(tasks[0].words, "PENDING (Resources)");
    }

    #[test]
    fn states_come_down_to_three() {
        let state = |state: &str| {
            let line = format!(
                "JobId=7 ArrayTaskId=2 JobState={state} Reason=None Restarts=3 NodeList=rod1"
            );
            let task = parse(6, &line).remove(0);
            assert_eq!(
                (task.job, task.restarts, task.nodes.as_str()),
                (6, 3, "rod1")
            );
            task.state
        };
        assert_eq!(state("RUNNING"), TaskState::Running);
        assert_eq!(state("COMPLETING"), TaskState::Running);
        for ended in [
            "COMPLETED",
            "FAILED",
            "CANCELLED",
            "TIMEOUT",
            "NODE_FAIL",
            "OUT_OF_MEMORY",
        ] {
            assert_eq!(state(ended), TaskState::Ended);
        }
        assert!(parse(1, "JobId=1 JobState=RUNNING").is_empty());
    }
}
