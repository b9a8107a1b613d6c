//! Observers: measurements of an experiment while a scene runs.
//!
//! The run loop is independent of experiments. After a step it asks each observer whether a sample
//! is due, and calls it. At each output it writes the values of the observer's columns, and at the
//! end it requests the outcome of the run.

use super::saved::saved_object;
use rodlab_engine::mechanics::dynamics::{Exchange, Simulation};
use rodlab_files::results::{CaseOutcome, Ending, NamedValues, SeriesRow, Value};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::fmt::Debug;

/// Input of an observer: the simulation at an output, or after a step or an equilibrium.
#[derive(Clone, Copy)]
pub struct Sample<'a> {
    /// The simulation.
    pub simulation: &'a Simulation,
    /// Number of accepted steps, equilibria or points of a path so far; 0 at the start of a
    /// motion, before forces are computed.
    pub steps: u64,
    /// Work of the clamps and losses to friction and drag since the start.
    pub exchange: Exchange,
}

impl Sample<'_> {
    /// Time, s, or the parameter on a path of equilibria.
    pub fn time(&self) -> f64 {
        self.simulation.time()
    }
}

/// Consequence of an observation.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Nothing: the run continues.
    GoOn,
    /// The observation is complete: the run ends normally with the next output, or with the
    /// current one.
    End(Ending),
    /// A physics check failed, for the reason stated: the run ends here (exit code 4).
    Fail(String),
}

/// A measurement of an experiment while a scene runs.
///
/// An observer is a value that can be saved: its memory is its fields, and a checkpoint holds all
/// of them. The times of its samples must not depend on those of outputs, so that results do not
/// change with the output interval.
pub trait Observer: ObserverObject + Debug + Send + Sync {
    /// Name of the observer: a word for messages and checkpoints.
    fn name(&self) -> &str;

    /// Names of the columns that the observer adds to `series.csv`, with the unit as suffix. They
    /// never change.
    fn columns(&self) -> Vec<String> {
        Vec::new()
    }

    /// Whether a sample is due after the step that ended at `time`, s.
    fn is_due(&self, _time: f64) -> bool {
        false
    }

    /// Observes the simulation between outputs.
    fn sample(&mut self, _sample: &Sample<'_>) -> Finding {
        Finding::GoOn
    }

    /// The values of its columns at an output; `row` is the row of that output. The row is written
    /// whatever the finding.
    fn measure(&mut self, sample: &Sample<'_>, row: &SeriesRow) -> (Vec<Value>, Finding);

    /// Outcome of the run so far, as further columns of `summary.csv`.
    fn outcomes(&self) -> NamedValues {
        NamedValues::default()
    }

    /// Further remarks for the user at the end, a sentence each.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// Main results of an outcome for the user, possibly from an earlier call: names and texts, a
    /// line each.
    fn highlights(&self, _outcome: &CaseOutcome) -> Vec<(String, String)> {
        Vec::new()
    }
}

saved_object! {
    /// Methods of every [`Observer`] that follow from its serialisable state.
    ObserverObject for Observer
}
