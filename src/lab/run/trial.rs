//! Estimated cost of a run, from a trial of its beginning.
//!
//! The run starts in a directory of its own, with all its outputs and observers, for two stages of
//! half a second of processor time each. The second stage continues from the checkpoint of the
//! first. The estimate extrapolates the pace of the second stage, since the first steps may be
//! smaller and contacts have to settle. The estimate does not include later events that cost more,
//! such as a first contact after the trial; contacts double or triple the cost of a step.

use super::{Mode, PreparedRun, Reached, RunError, RunOptions, StopRequest, run_until};
use rodlab_files::results::UsageMeter;
use serde::Serialize;
use std::fmt;
use std::path::Path;
use std::sync::{Mutex, mpsc};
use std::time::{Duration, Instant};

/// Processor time of a stage, and the wall time after which the stage ends even if other programs
/// use the processor.
const STAGE: Duration = Duration::from_millis(500);
const PATIENCE: Duration = Duration::from_secs(2);
/// Wall time after which the whole trial is abandoned, even if it has not checked its time limit.
const LONGEST: Duration = Duration::from_secs(8);
/// Time between two readings of the processor clock.
const LOOK: Duration = Duration::from_millis(5);

/// Estimated cost of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Forecast {
    /// Processor time of the whole run, s; `None` if the trial gives no estimate.
    pub processor_time: Option<f64>,
    /// Processor time of the trial, s.
    pub trial_time: f64,
    /// Fraction of the run that the trial completed: 1 if it reached the end.
    pub part: f64,
    /// Reason why the trial failed, if it did.
    pub failure: Option<String>,
}

/// Outcome of a stage.
enum Stage {
    Finished,
    At(Reached),
    Failed(String),
}

/// Tries a run for a second, and abandons the trial if a step does not end.
pub fn forecast(prepared: &PreparedRun) -> Forecast {
    let unknown = |failure: Option<String>, trial_time: f64| Forecast {
        processor_time: None,
        trial_time,
        part: 0.0,
        failure,
    };
    let directory = match tempfile::tempdir() {
        Ok(directory) => directory,
        Err(error) => return unknown(Some(error.to_string()), 0.0),
    };
    let threads = rayon::ThreadPoolBuilder::new().num_threads(rayon::current_num_threads());
    let pool = match threads.build() {
        Ok(pool) => pool,
        Err(error) => return unknown(Some(error.to_string()), 0.0),
    };
    let (tell, told) = mpsc::channel();
    let (prepared, path) = (prepared.clone(), directory.path().to_owned());
    pool.spawn(move || {
        let silent = tracing::subscriber::NoSubscriber::default();
        let found = tracing::subscriber::with_default(silent, || try_run(&prepared, &path));
        // The receiver may be gone.
        let _ = tell.send(found);
    });
    // An abandoned trial continues until the program ends, but its directory is gone.
    match told.recv_timeout(LONGEST) {
        Ok(forecast) => forecast,
        Err(mpsc::RecvTimeoutError::Timeout) => unknown(None, LONGEST.as_secs_f64()),
        Err(mpsc::RecvTimeoutError::Disconnected) => {
            unknown(Some("an internal error of rodlab ended it".to_owned()), 0.0)
        }
    }
}

fn try_run(prepared: &PreparedRun, directory: &Path) -> Forecast {
    let mut forecast = Forecast {
        processor_time: None,
        trial_time: 0.0,
        part: 0.0,
        failure: None,
    };
    // Searches for an equilibrium start from scratch in each call.
    let stages = if prepared.mode == Mode::Static { 1 } else { 2 };
    for _ in 0..stages {
        let (stage, seconds) = try_stage(prepared, directory);
        forecast.trial_time += seconds;
        match stage {
            Stage::Finished => {
                forecast.part = 1.0;
                forecast.processor_time = Some(forecast.trial_time);
                return forecast;
            }
            Stage::At(reached) => {
                let part = part_of(prepared, reached).clamp(0.0, 1.0);
                let done = part - forecast.part;
                if done > 0.0 {
                    let rest = (1.0 - part) * seconds / done;
                    forecast.processor_time = Some(forecast.trial_time + rest);
                }
                forecast.part = part;
            }
            Stage::Failed(reason) => {
                forecast.processor_time = None;
                forecast.failure = Some(reason);
                return forecast;
            }
        }
    }
    forecast
}

/// Begins or continues the run. Also returns the processor time, s.
fn try_stage(prepared: &PreparedRun, directory: &Path) -> (Stage, f64) {
    let options = RunOptions {
        progress: false,
        ..RunOptions::new(directory)
    };
    let meter = UsageMeter::start();
    let spent = || {
        let usage = meter.usage();
        usage.cpu_time.unwrap_or(usage.wall_time)
    };
    // Time of the last check of the clocks; `None` once the time limit has passed, which is final.
    let looked = Mutex::new(Some(Instant::now()));
    let over = || {
        let mut looked = looked.lock().expect("no thread panics with this lock");
        if looked.is_some_and(|last| last.elapsed() >= LOOK) {
            let is_over = spent() >= STAGE || meter.wall_time() >= PATIENCE;
            *looked = (!is_over).then(Instant::now);
        }
        looked.is_none().then_some(StopRequest::TimeLimit)
    };
    let stage = match run_until(prepared, &options, &over) {
        Ok(_) => Stage::Finished,
        Err(RunError::TimeLimit { reached, .. } | RunError::Interrupted { reached, .. }) => {
            Stage::At(reached)
        }
        Err(RunError::Simulation { source, .. }) => Stage::Failed(source.to_string()),
        Err(error) => Stage::Failed(error.to_string()),
    };
    (stage, spent().as_secs_f64())
}

/// Fraction of the run that is complete at this point.
fn part_of(prepared: &PreparedRun, reached: Reached) -> f64 {
    match (reached, prepared.mode) {
        (Reached::Rows(rows), _) => {
            let all = prepared.table.as_ref().map_or(0, |table| table.rows());
            rows as f64 / all.max(1) as f64
        }
        (Reached::Time(time), Mode::Dynamic { end, .. }) => time / end,
        (Reached::Parameter(parameter), Mode::Continuation(plan)) => {
            (parameter - plan.from) / (plan.to - plan.from)
        }
        _ => 0.0,
    }
}

/// A time as text.
pub fn in_words(seconds: f64) -> String {
    match seconds {
        ..0.1 => "less than 0.1 s".to_owned(),
        ..10.0 => format!("about {seconds:.1} s"),
        ..120.0 => format!("about {seconds:.0} s"),
        ..7200.0 => format!("about {:.0} min", seconds / 60.0),
        _ => format!("about {:.0} h", seconds / 3600.0),
    }
}

impl fmt::Display for Forecast {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let trial = self.trial_time;
        if let Some(failure) = &self.failure {
            let reason = failure.lines().next().unwrap_or_default();
            return write!(
                formatter,
                "unknown: a trial of {trial:.1} s ended: {reason}"
            );
        }
        match self.processor_time {
            Some(time) if self.part >= 1.0 => {
                write!(
                    formatter,
                    "{}, measured by a trial that reached the end",
                    in_words(time)
                )
            }
            Some(time) => write!(
                formatter,
                "{}, by a trial of the first {:.2} % in {trial:.1} s",
                in_words(time),
                100.0 * self.part
            ),
            None => write!(formatter, "more than the {trial:.1} s of a trial"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{from_text, prepare};

    fn of(scenario: &str, overrides: &[&str]) -> Forecast {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        let loaded = from_text("trial", scenario, Path::new(""), &overrides).unwrap();
        forecast(&prepare(&loaded.scenario).unwrap())
    }

    const FLAGELLA: &str = include_str!("../../../scenarios/flagella_base.toml");

    #[test]
    fn a_short_run_is_tried_to_its_end() {
        let forecast = of(FLAGELLA, &["time.end=0.01"]);
        assert_eq!((forecast.part, forecast.failure), (1.0, None));
        assert_eq!(forecast.processor_time, Some(forecast.trial_time));
    }

    /// All steps have the same cost: ten times the simulated time takes ten times as long, however
    /// fast the machine.
    #[test]
    fn a_long_run_is_extrapolated_in_proportion() {
        let [short, long] = [500.0, 5000.0].map(|end| of(FLAGELLA, &[&format!("time.end={end}")]));
        for forecast in [&short, &long] {
            assert!(forecast.part > 0.0 && forecast.part < 0.2, "{forecast:?}");
            assert!(forecast.trial_time < 1.5 + 0.5, "{forecast:?}");
        }
        let ratio = long.processor_time.unwrap() / short.processor_time.unwrap();
        assert!((3.0..30.0).contains(&ratio), "{ratio}");
    }

    /// A rod that falls through the wall of its flow.
    const BEHIND: &str = r#"
        experiment = "scene"
        material = { youngs_modulus = 1e6, poissons_ratio = 0.5, density = 1000.0 }
        time = { step = 1e-4, end = 0.05 }
        fluid = { viscosity = 1e-3 }
        [[planes]]
        point = [0, 0, 0]
        [[rods]]
        name = "falling"
        radius = 1e-4
        edges = 4
        shape = { kind = "straight", start = [0, 0, 2e-3], end = [0.01, 0, 2e-3] }
        velocity = [0, 0, -1]
        [[loads]]
        kind = "gravity"
        acceleration = [0, 0, -1e4]
    "#;

    #[test]
    fn a_failed_trial_reports_the_reason() {
        let forecast = of(BEHIND, &[]);
        assert!(forecast.processor_time.is_none());
        let text = forecast.to_string();
        assert!(
            text.contains("unknown") && text.contains("of rod `falling` is at the wall"),
            "{text}"
        );
    }
}
