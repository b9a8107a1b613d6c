//! `rodlab status`.

use super::prelude::*;
use rodlab_files::results::{CaseRecord, CaseStatus};
use rodlab_lab::cluster::{self, ClusterError, Jobs, Task};
use rodlab_lab::scenario::Case;
use rodlab_lab::sweep::{self, CaseCounts, Shard};
use std::collections::BTreeMap;

/// Arguments of `rodlab status`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab status results/beam
  rodlab status results/beam --json")]
pub struct StatusArguments {
    /// The results directory of a sweep
    pub directory: PathBuf,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
}

/// Status of a sweep.
#[derive(Serialize)]
struct Status {
    counts: CaseCounts,
    cases: Vec<CaseLine>,
    tasks: Vec<TaskLine>,
}

#[derive(Serialize)]
struct CaseLine {
    case: String,
    status: CaseStatus,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// A task with its state in Slurm and the cases of its share.
#[derive(Serialize)]
struct TaskLine {
    number: usize,
    finished: usize,
    cases: usize,
    /// State in Slurm; `None` if Slurm has no record of the task.
    slurm: Option<Task>,
}

/// Prints the status of the cases of a sweep, and the tasks that run them.
pub fn status(arguments: &StatusArguments) -> Result<(), Failure> {
    let records = sweep::case_records(&arguments.directory)?;
    let jobs = Jobs::read(&arguments.directory)?;
    let queue = match &jobs {
        None => BTreeMap::new(),
        Some(jobs) => match cluster::tasks(&jobs.jobs) {
            // Report the cases on a machine without Slurm, too.
            Err(error @ ClusterError::Missing { .. }) => {
                tracing::warn!("{error}");
                BTreeMap::new()
            }
            tasks => tasks?,
        },
    };
    let status = status_of(&records, jobs.map_or(0, |jobs| jobs.tasks), queue);
    if arguments.json {
        return print_json(&status);
    }
    print(&in_words(&status))
}

fn status_of(
    records: &[(Case, CaseRecord)],
    tasks: usize,
    mut queue: BTreeMap<usize, Task>,
) -> Status {
    let mut counts = CaseCounts::default();
    records
        .iter()
        .for_each(|(_, record)| counts.add(record.status));
    let task = |number: usize| {
        let shard = Shard { number, of: tasks };
        let indices: Vec<usize> = shard.indices(records.len()).collect();
        let finished = |index: &&usize| records[**index].1.status == CaseStatus::Finished;
        TaskLine {
            number,
            finished: indices.iter().filter(finished).count(),
            cases: indices.len(),
            slurm: queue.remove(&number),
        }
    };
    let case = |(case, record): &(Case, CaseRecord)| CaseLine {
        case: case.id.clone(),
        status: record.status,
        error: record.error.clone(),
    };
    Status {
        counts,
        cases: records.iter().map(case).collect(),
        tasks: (1..=tasks).map(task).collect(),
    }
}

fn in_words(status: &Status) -> String {
    let mut text = format!("{}\n", status.counts);
    // Writing to a string cannot fail.
    for task in &status.tasks {
        let share = format!("{}/{} cases", task.finished, task.cases);
        let _ = match &task.slurm {
            Some(slurm) => writeln!(
                text,
                "task {:<5} {share:<16} job {}_{}  {}  {}  {}",
                task.number, slurm.job, task.number, slurm.words, slurm.run_time, slurm.nodes
            ),
            None => writeln!(
                text,
                "task {:<5} {share:<16} not found by Slurm",
                task.number
            ),
        };
    }
    for case in status
        .cases
        .iter()
        .filter(|case| is_remarkable(case.status))
    {
        let error = case.error.as_deref().unwrap_or_default();
        let _ = writeln!(text, "{}: {}  {error}", case.case, case.status.in_words());
    }
    text
}

fn is_remarkable(status: CaseStatus) -> bool {
    !matches!(status, CaseStatus::Finished | CaseStatus::Pending)
}
