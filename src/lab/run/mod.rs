//! The run loop: from a prepared run to a results directory.

mod advance;
mod controller;
mod counters;
mod decimals;
mod end_state;
mod error;
mod interruption;
mod linking;
mod live;
mod observer;
mod output_times;
#[cfg(test)]
mod participant_tests;
mod participants;
mod path;
mod prepared;
pub mod probes;
mod progress;
mod records;
mod saved;
mod session;
mod stop;
mod table;
#[cfg(test)]
mod tests;
pub mod thread_pools;
mod trial;
mod work;

pub use controller::{Controller, ControllerObject};
pub use decimals::decimals;
pub use end_state::start_from;
pub use error::RunError;
pub use interruption::{Interruption, is_attended};
pub use linking::LinkingGuard;
pub use live::{LiveRun, LiveState};
pub use observer::{Finding, Observer, ObserverObject, Sample};
pub use output_times::OutputTimes;
pub use prepared::{Mode, OutputPlan, PreparedRun, TableRun};
pub use progress::AmongBars;
pub use records::rod_records;
pub use stop::StopRequest;
pub use stop::StopRequests;
pub use table::TableJob;
pub use trial::{Forecast, forecast};
pub use work::is_deaf;

use advance::Advance;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_files::results::{
    CaseOutcome, MAIN_CASE, Manifest, Opened, ResultsDirectory, ResultsError, scenario_hash,
};
use session::Session;
use std::fmt;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use work::Work;

/// Options of a run, apart from its scenario.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// The results directory.
    pub directory: PathBuf,
    /// Start from scratch if results exist, even those of another scenario.
    pub force: bool,
    /// The command line, recorded in the manifest.
    pub command_line: Vec<String>,
    /// Show a progress bar on standard error (only if that is a terminal).
    pub progress: bool,
    /// The group of bars in which the bar of this run appears, if there are several runs.
    pub among: Option<AmongBars>,
    /// Moment at which the run stops with a checkpoint. The run takes a minimum number of steps
    /// first.
    pub deadline: Option<Instant>,
    /// Wall time between checkpoints.
    pub checkpoint_every: Duration,
}

impl RunOptions {
    /// The usual options for a run into `directory`: no time limit, a checkpoint every minute.
    pub fn new(directory: impl Into<PathBuf>) -> Self {
        Self {
            directory: directory.into(),
            force: false,
            command_line: std::env::args_os()
                .map(|argument| argument.to_string_lossy().into_owned())
                .collect(),
            progress: true,
            among: None,
            deadline: None,
            checkpoint_every: Duration::from_secs(60),
        }
    }
}

/// A run that reached its end.
#[derive(Clone, Debug)]
pub struct RunOutcome {
    /// The results directory.
    pub directory: PathBuf,
    /// Whether there was anything left to do.
    pub status: RunStatus,
    /// Numbers of steps, iterations and contacts.
    pub case: CaseOutcome,
    /// Wall time of this call and of the interrupted calls before it.
    pub wall_time: Duration,
    /// Main observations for the user: names and texts, a line each.
    pub highlights: Vec<(String, String)>,
}

/// What a successful call of [`run`] did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RunStatus {
    /// Ran from the beginning.
    Finished,
    /// Continued from the end of an interrupted call.
    Resumed {
        /// Progress of the earlier call.
        from: Reached,
    },
    /// The results existed already; nothing was run.
    AlreadyFinished,
}

/// Progress of a run.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum Reached {
    /// At the start, of a run that searches for an equilibrium.
    Start,
    /// Simulated time, s.
    Time(f64),
    /// Parameter of a path of equilibria.
    Parameter(f64),
    /// Rows of a table.
    Rows(usize),
}

impl fmt::Display for Reached {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start => write!(f, "the start"),
            Self::Time(time) => write!(f, "t = {} s", decimals(*time, 6)),
            Self::Parameter(parameter) => write!(f, "parameter {parameter:.6}"),
            Self::Rows(rows) => write!(f, "row {rows}"),
        }
    }
}

/// Runs to the end and writes the results directory.
///
/// Idempotent: finished results of the same scenario are kept, and interrupted runs resume from
/// their last checkpoint, bit for bit.
///
/// # Errors
/// See [`RunError`].
pub fn run(prepared: &PreparedRun, options: &RunOptions) -> Result<RunOutcome, RunError> {
    let interruption = Interruption::watch();
    run_until(prepared, options, &|| interruption.requested())
}

/// Minimum duration of the work after its setup, even past the time limit, so that each call makes
/// progress.
const LEAST: Duration = Duration::from_millis(20);

/// The moment at which work that begins now must stop.
pub fn not_at_once(deadline: Instant) -> Instant {
    deadline.max(Instant::now() + LEAST)
}

/// Runs like [`run`], until `stop_requested` returns a reason. This callback is called between
/// steps and during long ones.
///
/// # Errors
/// See [`RunError`].
pub fn run_until(
    prepared: &PreparedRun,
    options: &RunOptions,
    stop_requested: StopRequests<'_>,
) -> Result<RunOutcome, RunError> {
    let deadline = options.deadline.map(not_at_once);
    let work = Work::begin();
    let stop_requested = || {
        let late = || deadline.is_some_and(|at| Instant::now() >= at);
        let request = stop_requested().or_else(|| late().then_some(StopRequest::TimeLimit));
        request.inspect(|_| work.is_told())
    };
    if let Some(table) = &prepared.table {
        return table.run(prepared, options, &stop_requested);
    }
    let mut simulation =
        Simulation::new(&prepared.scene, &prepared.integration).map_err(RunError::Scene)?;
    run_simulation(&mut simulation, prepared, options, &stop_requested)
}

/// Opens the results directory of a run.
fn open_results(prepared: &PreparedRun, options: &RunOptions) -> Result<Opened, ResultsError> {
    ResultsDirectory::open(
        &options.directory,
        &scenario_hash(&prepared.scenario_toml),
        &prepared.scenario_toml,
        &prepared.own_files,
        options.force,
    )
}

/// Runs a simulation from time zero to the end of the prepared run, or until `stop_requested`
/// returns a reason.
fn run_simulation(
    simulation: &mut impl Advance,
    prepared: &PreparedRun,
    options: &RunOptions,
    stop_requested: StopRequests<'_>,
) -> Result<RunOutcome, RunError> {
    match open_results(prepared, options)? {
        Opened::Finished(manifest) => {
            Ok(RunOutcome::already_finished(&manifest, prepared, options))
        }
        Opened::Ready(directory) => {
            let mut session = Session::begin(directory, simulation, prepared, options)?;
            let result = session.proceed(simulation, prepared.mode, stop_requested);
            session.conclude(simulation, result)
        }
    }
}

impl RunOutcome {
    fn already_finished(manifest: &Manifest, prepared: &PreparedRun, options: &RunOptions) -> Self {
        let record = manifest.cases.get(MAIN_CASE);
        let case = record.map(|record| record.outcome.clone());
        let case = case.unwrap_or_default();
        Self {
            directory: options.directory.clone(),
            status: RunStatus::AlreadyFinished,
            highlights: participants::highlights(&prepared.observers, &case),
            case,
            wall_time: record
                .map(|record| record.usage().wall_time)
                .unwrap_or_default(),
        }
    }
}
