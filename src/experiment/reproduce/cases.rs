//! Runs, some at a time, each in its own results directory.

use super::bundling::Bundling;
use super::{ReproduceError, ReproduceOptions};
use crate::experiment::{PreparedRun, RunError, RunOptions, RunStatus, run};
use crate::results::{CaseRecord, CaseStatus, MAIN_CASE, Manifest, scenario_hash};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Folder of the runs of all artefacts.
const CASES: &str = "cases";
/// Digits of the scenario's hash in the name of a run's directory.
const HASH_DIGITS: usize = 8;

/// What an artefact asks to be run.
pub(super) trait Run: Clone + Sync + Send {
    /// Its name, for directories.
    fn id(&self) -> String;
    /// The run, ready to start.
    fn prepare(&self) -> PreparedRun;
    /// Simulated time, s.
    fn end(&self) -> f64;
}

/// A run that came to an end.
#[derive(Clone, Debug)]
pub(super) struct Case<R = Bundling> {
    /// What was run.
    pub run: R,
    /// Its results directory.
    pub directory: PathBuf,
    /// What came out; the status tells whether the simulated time was reached.
    pub record: CaseRecord,
    /// Its manifest.
    pub manifest: Manifest,
    /// Whether an earlier call had finished it.
    pub was_finished: bool,
}

/// How a run came to an end.
type Ended<R> = Result<Case<R>, ReproduceError>;

/// Threads of a run when `jobs` of them share those of the program.
pub(super) fn threads_of_a_run(jobs: usize) -> usize {
    (rayon::current_num_threads() / jobs).max(1)
}

/// Runs whatever has not been run yet, `options.jobs` at a time, in order.
///
/// Each run has a thread pool to itself: in a common one a thread that waits for others of its own run
/// could take up another run, and time would be counted where it was not spent.
pub(super) fn run_all<R: Run>(
    runs: &[R],
    options: &ReproduceOptions,
    report: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Case<R>>, ReproduceError> {
    let next = AtomicUsize::new(0);
    let stopped = AtomicBool::new(false);
    let results: Vec<Mutex<Option<Ended<R>>>> = runs.iter().map(|_| Mutex::new(None)).collect();
    let threads = threads_of_a_run(options.jobs);
    let work = || {
        while !stopped.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(asked) = runs.get(index) else {
                break;
            };
            let result = run_one(asked, options, threads);
            match &result {
                Ok(case) => report(&case.in_a_line()),
                Err(_) => stopped.store(true, Ordering::Relaxed),
            }
            *results[index].lock().expect("no run panics") = Some(result);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..options.jobs.min(runs.len()) {
            scope.spawn(work);
        }
    });
    // Runs are begun in order: before one that was not, another has failed.
    results
        .into_iter()
        .map_while(|result| result.into_inner().expect("no run panics"))
        .collect()
}

fn run_one<R: Run>(
    asked: &R,
    options: &ReproduceOptions,
    threads: usize,
) -> Result<Case<R>, ReproduceError> {
    let prepared = asked.prepare();
    // Another version of the program may resolve the scenario to something else: that is another run.
    let hash = scenario_hash(&prepared.scenario_toml);
    let name = format!("{}-{}", asked.id(), &hash[..HASH_DIGITS]);
    let directory = options.directory.join(CASES).join(name);
    let run_options = RunOptions {
        command_line: options.command_line.clone(),
        progress: false,
        ..RunOptions::new(&directory)
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| ReproduceError::Threads(error.to_string()))?;
    let was_finished = match pool.install(|| run(&prepared, &run_options)) {
        Ok(outcome) => outcome.status == RunStatus::AlreadyFinished,
        // Where the mechanics gives up, the thesis' simulations end, too: a result.
        Err(RunError::Simulation { .. }) => false,
        Err(error) => return Err(error.into()),
    };
    let manifest = Manifest::read(&directory)?.expect("a run leaves its manifest");
    Ok(Case {
        run: asked.clone(),
        directory,
        record: manifest.cases[MAIN_CASE],
        manifest,
        was_finished,
    })
}

impl<R: Run> Case<R> {
    /// How it ended, for progress reports.
    fn in_a_line(&self) -> String {
        let Self { run, record, .. } = self;
        let how = if self.was_finished {
            "had been run before".to_owned()
        } else {
            format!("{:.1} s of wall time", record.wall_time)
        };
        let end = record.outcome.simulated_time;
        format!("{}: {} at {end} s, {how}", run.id(), self.status())
    }

    /// Its status in words.
    pub fn status(&self) -> &'static str {
        match self.record.status {
            CaseStatus::Finished => "finished",
            CaseStatus::NoConvergence => "no convergence",
            CaseStatus::Unphysical => "a physics check failed",
            CaseStatus::Running
            | CaseStatus::Interrupted
            | CaseStatus::TimeLimit
            | CaseStatus::Failed => "stopped",
        }
    }

    /// Wall time per step with contact, s.
    pub fn time_per_step_with_contact(&self) -> Option<f64> {
        let steps = self.record.outcome.steps_with_contact;
        (steps > 0).then(|| self.record.wall_time_with_contact / steps as f64)
    }
}
