//! `rodlab submit`.

use super::candidates::keys;
use super::log_directory::results_directory;
use super::prelude::*;
use super::sweep::refuse_too_many;
use rodlab_files::results::{CaseRecord, SCENARIO};
use rodlab_lab::cluster::{self, Jobs, Program, Request, Task, TaskState};
use rodlab_lab::experiment::case_set;
use rodlab_lab::run::RunOptions;
use rodlab_lab::scenario::{Case, CaseSet};
use rodlab_lab::sweep::{self, Shard};

/// Default number of tasks of a job array.
const TASKS: usize = 64;

/// Arguments of `rodlab submit`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab submit sweep.toml --partition short --time 2:00:00 --memory 2G --cores 4 --tasks 32
  rodlab submit sweep.toml --array-limit 10 --extra=--constraint=avx2 --prologue \"module load gcc\"
  rodlab submit sweep.toml --wrapper \"apptainer exec rodlab.sif\" --print    the script only

Each task of the job array runs one share of the cases. A minute before its time limit it writes
checkpoints and queues itself again. The same command submits the tasks that are neither finished
nor queued, for example after `scancel`. `rodlab status DIR` shows the progress, and
`rodlab gather DIR` makes the tables of the whole sweep.")]
pub struct SubmitArguments {
    /// Scenario file with a sweep, or with --vary
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    pub scenario: PathBuf,
    /// Set a key of the scenario; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    pub overrides: Vec<String>,
    /// Run a case for each value of a key, as in `rodlab run`
    #[arg(long, value_name = "KEY=VALUES", add = keys("="))]
    pub vary: Vec<String>,
    /// Directory for the results, shared by all machines [default: results/<name of the scenario>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of tasks, among which the cases are divided [default: one per case, at most 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub tasks: Option<u32>,
    /// Largest number of tasks that run at a time
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub array_limit: Option<u32>,
    /// The partition
    #[arg(long, value_name = "NAME")]
    pub partition: Option<String>,
    /// Time limit of a task in Slurm's format, such as 8:00:00
    #[arg(long, value_name = "TIME")]
    pub time: Option<String>,
    /// Memory of a task, such as 2G
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<String>,
    /// Cores of a task, which runs as many cases at a time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub cores: u16,
    /// Account to charge
    #[arg(long, value_name = "NAME")]
    pub account: Option<String>,
    /// Further option of sbatch, such as --extra=--constraint=avx2; repeatable
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub extra: Vec<String>,
    /// Line of shell before the program starts, such as "module load gcc"; repeatable
    #[arg(long, value_name = "LINE")]
    pub prologue: Vec<String>,
    /// Command that runs the program, such as "apptainer exec rodlab.sif"
    #[arg(long, value_name = "WORDS")]
    pub wrapper: Option<String>,
    /// Allow more than 100000 cases
    #[arg(long)]
    pub yes: bool,
    /// Print the batch script instead of submitting it
    #[arg(long)]
    pub print: bool,
}

/// Submits the tasks that are neither finished nor in the queue.
pub fn submit(arguments: &SubmitArguments) -> Result<(), Failure> {
    let case_set = case_set(&arguments.scenario, &arguments.overrides, &arguments.vary)?;
    refuse_too_many(&case_set, arguments.yes)?;
    if !case_set.is_sweep() {
        return Err(Failure::Input(
            "nothing is varied: a job array needs a [sweep] or --vary".to_owned(),
        ));
    }
    if case_set.search().is_some() {
        return Err(Failure::Input(
            "a search runs its cases one after the other: use `rodlab run`".to_owned(),
        ));
    }
    let directory = results_directory(arguments.out.as_deref(), case_set.name());
    let directory = std::path::absolute(&directory)
        .map_err(|error| Failure::System(format!("{}: {error}", directory.display())))?;
    let known = Jobs::read(&directory)?;
    let mut jobs = known.unwrap_or_else(|| Jobs {
        tasks: tasks_of(&case_set, arguments.tasks),
        jobs: Vec::new(),
    });
    let executable = std::env::current_exe().map_err(|error| {
        Failure::System(format!("cannot find the path of this program: {error}"))
    })?;
    let program = Program {
        executable,
        scenario: directory.join(SCENARIO),
        directory: directory.clone(),
        tasks: jobs.tasks,
    };
    let request = request(arguments, case_set.name());
    if arguments.print {
        let all: Vec<usize> = (1..=jobs.tasks).collect();
        return print(&cluster::script(&program, &request, &all)?);
    }
    let is_new = !directory.exists();
    sweep::establish(&case_set, &RunOptions::new(&directory))?;
    let queue = cluster::tasks(&jobs.jobs)?;
    let mut left = unfinished_tasks(&sweep::case_records(&directory)?, jobs.tasks);
    let has_ended = |task: &Task| task.state == TaskState::Ended;
    left.retain(|number| queue.get(number).is_none_or(has_ended));
    if left.is_empty() {
        return print("nothing to submit: every task is finished, or in the queue\n");
    }
    let job = cluster::submit(&program, &request, &left, &mut jobs);
    let job = job.inspect_err(|error| {
        if is_new && error.is_refusal() {
            // Remove the files for the job; the rejection is reported.
            let _ = std::fs::remove_dir_all(&directory);
        }
    })?;
    print(&format!(
        "{:<24}{job}\n{:<24}{} of {}\n{:<24}{}\n",
        "job",
        "tasks",
        left.len(),
        jobs.tasks,
        "results",
        directory.display()
    ))
}

fn tasks_of(case_set: &CaseSet, asked: Option<u32>) -> usize {
    let cases = usize::try_from(case_set.count()).unwrap_or(usize::MAX);
    if let Some(asked) = asked.filter(|tasks| *tasks as usize > cases) {
        tracing::warn!(
            "--tasks {asked}: the sweep has {cases} cases, and as many tasks are submitted"
        );
    }
    asked.map_or(TASKS, |tasks| tasks as usize).min(cases)
}

/// Tasks with unfinished cases.
fn unfinished_tasks(records: &[(Case, CaseRecord)], tasks: usize) -> Vec<usize> {
    let is_over = |index: usize| records[index].1.status.is_final();
    let is_left = |number: &usize| {
        let (number, of) = (*number, tasks);
        !Shard { number, of }.indices(records.len()).all(is_over)
    };
    (1..=tasks).filter(is_left).collect()
}

fn request(arguments: &SubmitArguments, name: &str) -> Request {
    Request {
        name: name.to_owned(),
        partition: arguments.partition.clone(),
        time: arguments.time.clone(),
        memory: arguments.memory.clone(),
        cores: arguments.cores,
        account: arguments.account.clone(),
        array_limit: arguments.array_limit,
        extra: arguments.extra.clone(),
        prologue: arguments.prologue.clone(),
        wrapper: arguments.wrapper.clone(),
    }
}
