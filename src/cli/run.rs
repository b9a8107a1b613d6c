//! `rodlab run`.

use super::candidates::keys;
use super::common::refuse_too_many_threads;
use super::log_directory::results_directory;
use super::prelude::*;
use super::run_watch::Watch;
use super::sweep;
use super::watchdog;
use rodlab_files::results::PAGE;
use rodlab_lab::experiment::{self, try_scene};
use rodlab_lab::report::write_page;
use rodlab_lab::run::{PreparedRun, RunOptions, RunOutcome, RunStatus};
use rodlab_lab::scenario::CaseSet;
use rodlab_lab::sweep::{Shard, SweepOptions};
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// Largest number of outputs on the page of a task in simulation.
const OUTPUTS: usize = 2500;

/// Arguments of `rodlab run`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab run scenarios/flagella_quick.toml
  rodlab run flagella_m2 --set flagella.count=4 --set time.end=\"1 min\" --out results/m4
  rodlab run scenarios/flagella_m10.toml --timeout 8h     ends with exit code 5; run again to resume
  rodlab run beam.toml --vary rods.beam.radius=\"2 mm:8 mm:1 mm\" --jobs 4
  rodlab run scenarios/pile.toml --watch                  see it in the browser while it runs
  rodlab run sweep.toml --shard 2/8                       the second eighth of the cases

Run the same command again to resume an interrupted run; a finished run is not repeated. The same
holds for each case of a sweep. Several processes may work on one results directory and share its
cases.")]
pub struct RunArguments {
    /// The scenario file
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    pub scenario: PathBuf,
    /// Set a key of the scenario, such as rods.beam.radius="7 mm"; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    pub overrides: Vec<String>,
    /// Directory for the results [default: results/<name of the scenario>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Start over and discard earlier results
    #[arg(long)]
    pub force: bool,
    /// Print the resolved scenario, or the cases of a sweep with their estimated cost, and run nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Run a case for each value of a key, FROM:TO:STEP or A,B,C; several keys give every combination
    #[arg(long, value_name = "KEY=VALUES", add = keys("="))]
    pub vary: Vec<String>,
    /// Number of cases at a time; they share the threads [default: one per thread]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: Option<u16>,
    /// Run only the K-th of N shares of the cases
    #[arg(long, value_name = "K/N", default_value = "1/1", value_parser = shard)]
    pub shard: Shard,
    /// Run failed cases again
    #[arg(long, hide_short_help = true)]
    pub retry_failed: bool,
    /// Start no further case after one has failed
    #[arg(long, hide_short_help = true)]
    pub fail_fast: bool,
    /// Allow more than 100000 cases
    #[arg(long, hide_short_help = true)]
    pub yes: bool,
    /// Open the 3-D page of `rodlab view` in the browser, and update it until the run ends
    #[arg(long, conflicts_with = "dry_run")]
    pub watch: bool,
    /// Print the results as JSON
    #[arg(long, conflicts_with = "dry_run")]
    pub json: bool,
    /// Stop with a checkpoint this long after the start of the program, such as 90, "10 min" or 8h
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub timeout: Option<Duration>,
}

impl RunArguments {
    fn sweep_options(&self, run: RunOptions) -> SweepOptions {
        let jobs = self.jobs.map(usize::from);
        let jobs = jobs.unwrap_or_else(rayon::current_num_threads);
        SweepOptions {
            run,
            jobs: NonZeroUsize::new(jobs).unwrap_or(NonZeroUsize::MIN),
            shard: self.shard,
            retry_failed: self.retry_failed,
            fail_fast: self.fail_fast,
        }
    }
}

/// Runs a scenario.
pub fn run(arguments: &RunArguments, common: &Common) -> Result<(), Failure> {
    if let Some(jobs) = arguments.jobs {
        refuse_too_many_threads("--jobs", jobs)?;
    }
    // A deadline beyond the range of the clock means no limit.
    let deadline = arguments
        .timeout
        .and_then(|limit| Instant::now().checked_add(limit));
    watchdog::watch(deadline);
    let case_set =
        experiment::case_set(&arguments.scenario, &arguments.overrides, &arguments.vary)?;
    let directory = results_directory(arguments.out.as_deref(), case_set.name());
    let options = RunOptions {
        force: arguments.force,
        progress: !common.quiet,
        deadline,
        ..RunOptions::new(directory)
    };
    // Dropped when the run ends, even after an error.
    let watched = options.directory.clone();
    let watch = || arguments.watch.then(|| Watch::start(&watched)).transpose();
    if case_set.is_sweep() {
        sweep::refuse_too_many(&case_set, arguments.yes)?;
        let _watch = watch()?;
        let options = arguments.sweep_options(options);
        return if arguments.dry_run {
            sweep::list(&case_set, &options)
        } else {
            sweep::run(&case_set, &options, arguments.json)
        };
    }
    let prepared = prepare(&case_set)?;
    if arguments.dry_run {
        // Check that the scene can be built, too.
        try_scene(&prepared)?;
        return print(&prepared.scenario_toml);
    }
    let watch = watch()?;
    let outcome = rodlab_lab::run::run(&prepared, &options)?;
    drop(watch);
    if arguments.json {
        return print_json(&as_json(&outcome));
    }
    print(&summary(&outcome))
}

/// Results of a run as JSON; quantities in SI units.
fn as_json(outcome: &RunOutcome) -> serde_json::Value {
    let resumed_from = match outcome.status {
        RunStatus::Resumed { from } => Some(from.to_string()),
        RunStatus::Finished | RunStatus::AlreadyFinished => None,
    };
    serde_json::json!({
        "status": "finished",
        "results": outcome.directory,
        "already_finished": outcome.status == RunStatus::AlreadyFinished,
        "resumed_from": resumed_from,
        "wall_time_s": outcome.wall_time.as_secs_f64(),
        "outcome": outcome.case,
        "remarks": outcome.case.remarks,
    })
}

/// Builds the scene of a set with a single case.
pub fn prepare(case_set: &CaseSet) -> Result<PreparedRun, Failure> {
    let loaded = case_set.scenario_of(0)?;
    experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues).into())
}

/// Runs a task in plain simulation, writes its page, and prints the results. Returns the path of
/// the page.
pub(super) fn simulate(
    case_set: &CaseSet,
    options: RunOptions,
    common: &Common,
) -> Result<PathBuf, Failure> {
    let options = RunOptions {
        progress: !common.quiet,
        ..options
    };
    let outcome = rodlab_lab::run::run(&prepare(case_set)?, &options)?;
    let page = outcome.directory.join(PAGE);
    write_page(&outcome.directory, &page, OUTPUTS, &|_, _| {})?;
    print(&summary(&outcome))?;
    print(&format!("{:<24}{}\n", "page", page.display()))?;
    Ok(page)
}

/// Directory and results of a run, one per line.
fn summary(outcome: &RunOutcome) -> String {
    let case = &outcome.case;
    let mut text = match outcome.status {
        RunStatus::Finished => "finished\n".to_owned(),
        RunStatus::Resumed { from } => format!("finished, continued from {from}\n"),
        RunStatus::AlreadyFinished => {
            "already finished; nothing was run (--force starts over)\n".to_owned()
        }
    };
    let mut line = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<24}{value}");
    };
    line("results", outcome.directory.display().to_string());
    if case.simulated_time > 0.0 {
        line("simulated time", format!("{} s", case.simulated_time));
    }
    if case.steps > 1 {
        line("steps", case.steps.to_string());
    }
    if let Some(parameter) = case.critical_parameter {
        line(
            "first critical point",
            format!("at parameter {parameter:.6}"),
        );
    }
    if let Some(mean) = case.newton_iterations_mean() {
        line("Newton iterations", format!("{mean:.2} a step"));
    }
    if let Some(time) = case.first_contact {
        line("first contact", format!("{time:.3} s"));
        line("steps with contact", case.steps_with_contact.to_string());
    }
    if let Some(distance) = case.minimum_distance {
        line("smallest distance", format!("{:.4} mm", 1e3 * distance));
    }
    if let Some(gap) = case.mean_gap {
        // Adding zero removes the sign of a negative zero.
        let nanometres = (1e9 * gap).round() + 0.0;
        line(
            "mean gap of contacts",
            format!("{:.3} µm", 1e-3 * nanometres),
        );
    }
    for (name, value) in &outcome.highlights {
        line(name, value.clone());
    }
    if let Some(ending) = &case.ending {
        line("ended early", ending.sentence.clone());
    }
    line(
        "wall time",
        format!("{:.2} s", outcome.wall_time.as_secs_f64()),
    );
    for remark in &case.remarks {
        text += remark;
        text.push('\n');
    }
    text
}
