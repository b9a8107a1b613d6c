//! Performs runs, several at a time, each in its own results directory.

use super::{ReproduceError, ReproduceOptions, Result};
use rodlab_files::results::{CaseRecord, MAIN_CASE, Manifest};
use rodlab_lab::experiment::{from_table, prepare};
use rodlab_lab::run::{PreparedRun, RunError, RunOptions, RunStatus, run, thread_pools};
use serde::Serialize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use toml::{Table, Value};

/// Folder of the runs of all artefacts.
const CASES: &str = "cases";
/// Number of digits of the scenario's hash in the name of a run's directory.
const HASH_DIGITS: usize = 8;

/// A run of an artefact.
pub(super) trait Run: Clone + Sync + Send {
    /// Name of the run, for directories.
    fn id(&self) -> String;
    /// Prepares the run.
    fn prepare(&self) -> PreparedRun;
    /// Simulated time, s; `None` for solutions without time.
    fn end(&self) -> f64 {
        0.0
    }
    /// Rough cost on one core, s.
    fn cost(&self) -> f64;
    /// A short version of the run with a few steps.
    #[cfg(test)]
    fn shortened(&self) -> Self;
    /// Extent of the run, for the text of a quick version.
    fn extent(&self) -> String {
        format!("{} s were simulated", self.end())
    }
}

/// Prepares the run of a scenario file with overrides; `id` is its name.
///
/// # Panics
/// If the scenario is invalid, since the scenarios of artefacts are built in.
pub(super) fn prepared(id: &str, file: &str, overrides: &[String]) -> PreparedRun {
    prepared_table(id, table_of(file), overrides)
}

/// Prepares the run of a scenario with overrides; `id` is its name.
///
/// # Panics
/// If the scenario is invalid, since the scenarios of artefacts are built in.
pub(super) fn prepared_table(id: &str, scenario: Table, overrides: &[String]) -> PreparedRun {
    let loaded = from_table(id, scenario, Path::new(""), overrides);
    let loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
    prepare(&loaded.scenario).unwrap_or_else(|issues| panic!("{issues:?}"))
}

/// The keys of a built-in file.
pub(super) fn table_of(file: &str) -> Table {
    file.parse().expect("the files of the program are TOML")
}

/// Converts numbers to a value in a scenario.
pub(super) fn value(numbers: impl Serialize) -> Value {
    Value::try_from(numbers).expect("numbers are TOML")
}

/// A finished run.
#[derive(Clone, Debug)]
pub(super) struct Case<R> {
    /// The run.
    pub run: R,
    /// Results directory.
    pub directory: PathBuf,
    /// Outcome; the status shows whether the simulated time was reached.
    pub record: CaseRecord,
    /// Manifest.
    pub manifest: Manifest,
    /// Whether an earlier call has finished the run.
    pub was_finished: bool,
}

/// End of a run.
type Ended<R> = Result<Case<R>>;

/// Performs all unfinished runs in order, `options.jobs` at a time.
pub(super) fn run_all<R: Run>(
    runs: &[R],
    options: &ReproduceOptions,
    report: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Case<R>>> {
    let results: Vec<OnceLock<Ended<R>>> = runs.iter().map(|_| OnceLock::new()).collect();
    thread_pools::for_each(runs.len(), options.jobs, |index| {
        let result = run_one(&runs[index], options);
        let flow = match &result {
            Ok(case) => {
                report(&case.in_a_line());
                ControlFlow::Continue(())
            }
            Err(_) => ControlFlow::Break(()),
        };
        // Each index occurs once.
        let _ = results[index].set(result);
        flow
    })
    .map_err(|error| ReproduceError::Threads(error.to_string()))?;
    // Runs are started in order, so that an earlier run has failed if one was not started.
    results
        .into_iter()
        .map_while(OnceLock::into_inner)
        .collect()
}

fn run_one<R: Run>(asked: &R, options: &ReproduceOptions) -> Result<Case<R>> {
    let prepared = asked.prepare();
    // Another version of the program may resolve the scenario differently, which is a different
    // run.
    let hash = blake3::hash(prepared.scenario_toml.as_bytes()).to_hex();
    let name = format!("{}-{}", asked.id(), &hash[..HASH_DIGITS]);
    let directory = options.directory.join(CASES).join(name);
    let run_options = RunOptions {
        command_line: options.command_line.clone(),
        progress: false,
        ..RunOptions::new(&directory)
    };
    let was_finished = match run(&prepared, &run_options) {
        Ok(outcome) => outcome.status == RunStatus::AlreadyFinished,
        // A failure of the mechanics is a result, since the simulations of the thesis also end
        // there.
        Err(RunError::Simulation { .. }) => false,
        Err(error) => return Err(error.into()),
    };
    let manifest = Manifest::read(&directory)?.expect("a run leaves its manifest");
    Ok(Case {
        run: asked.clone(),
        directory,
        record: manifest.cases[MAIN_CASE].clone(),
        manifest,
        was_finished,
    })
}

impl<R: Run> Case<R> {
    /// The end of the run in one line, for progress reports.
    fn in_a_line(&self) -> String {
        let Self { run, record, .. } = self;
        let how = if self.was_finished {
            "had been run before".to_owned()
        } else {
            format!("{:.1} s of wall time", record.wall_time)
        };
        let at = match record.outcome.simulated_time {
            0.0 => String::new(),
            end => format!(" at {end} s"),
        };
        format!("{}: {}{at}, {how}", run.id(), self.status())
    }

    /// The status as text.
    pub fn status(&self) -> &'static str {
        self.record.status.in_words()
    }

    /// Processor time of the steps with contact, s: their wall time, times the ratio of processor
    /// time to wall time of the whole run.
    pub fn cpu_time_with_contact(&self) -> Option<f64> {
        let share = self.record.wall_time_with_contact / self.record.wall_time;
        Some(share * self.record.cpu_time?).filter(|time| time.is_finite())
    }

    /// Processor time per step with contact, s.
    pub fn cpu_time_per_step_with_contact(&self) -> Option<f64> {
        let steps = self.record.outcome.steps_with_contact;
        let time = self.cpu_time_with_contact()?;
        (steps > 0).then(|| time / steps as f64)
    }
}
