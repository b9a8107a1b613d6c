//! Runs, some at a time, each in its own results directory.

use super::bundling::Bundling;
use super::{ReproduceError, ReproduceOptions};
use crate::experiment::{RunError, RunOptions, RunStatus, run};
use crate::results::{CaseRecord, CaseStatus, MAIN_CASE, Manifest};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Folder of the runs of all artefacts.
const CASES: &str = "cases";

/// A run that came to an end.
#[derive(Clone, Debug)]
pub(super) struct Case {
    /// What was run.
    pub bundling: Bundling,
    /// Its results directory.
    pub directory: PathBuf,
    /// What came out; the status tells whether the simulated time was reached.
    pub record: CaseRecord,
    /// Its manifest.
    pub manifest: Manifest,
    /// Whether an earlier call had finished it.
    pub was_finished: bool,
}

/// Threads of a run when `jobs` of them share those of the program.
pub(super) fn threads_of_a_run(jobs: usize) -> usize {
    (rayon::current_num_threads() / jobs).max(1)
}

/// Runs whatever has not been run yet, `options.jobs` at a time, in order.
///
/// Each run has a thread pool to itself: in a common one a thread that waits for others of its own run
/// could take up another run, and time would be counted where it was not spent.
pub(super) fn run_all(
    runs: &[Bundling],
    options: &ReproduceOptions,
    report: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Case>, ReproduceError> {
    let next = AtomicUsize::new(0);
    let stopped = AtomicBool::new(false);
    let results: Vec<Mutex<Option<Result<Case, ReproduceError>>>> =
        runs.iter().map(|_| Mutex::new(None)).collect();
    let threads = threads_of_a_run(options.jobs);
    let work = || {
        while !stopped.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(bundling) = runs.get(index) else {
                break;
            };
            let result = run_one(bundling, options, threads);
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

fn run_one(
    bundling: &Bundling,
    options: &ReproduceOptions,
    threads: usize,
) -> Result<Case, ReproduceError> {
    let directory = options.directory.join(CASES).join(bundling.id());
    let run_options = RunOptions {
        command_line: options.command_line.clone(),
        progress: false,
        ..RunOptions::new(&directory)
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| ReproduceError::Threads(error.to_string()))?;
    let was_finished = match pool.install(|| run(&bundling.prepare(), &run_options)) {
        Ok(outcome) => outcome.status == RunStatus::AlreadyFinished,
        // Where the mechanics gives up, the thesis' simulations end, too: a result.
        Err(RunError::Simulation { .. }) => false,
        Err(error) => return Err(error.into()),
    };
    let manifest = Manifest::read(&directory)?.expect("a run leaves its manifest");
    Ok(Case {
        bundling: *bundling,
        directory,
        record: manifest.cases[MAIN_CASE],
        manifest,
        was_finished,
    })
}

impl Case {
    /// How it ended, for progress reports.
    fn in_a_line(&self) -> String {
        let Self {
            bundling, record, ..
        } = self;
        let how = if self.was_finished {
            "had been run before".to_owned()
        } else {
            format!("{:.1} s of wall time", record.wall_time)
        };
        let end = record.outcome.simulated_time;
        format!("{}: {} at {end} s, {how}", bundling.id(), self.status())
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
