//! Observers: what an experiment watches while a scene runs.
//!
//! The run loop knows no experiment. It asks each observer whether it is due after a step, lets it look, writes the
//! values of its columns at each output, and at the end asks what the run came to.

use super::saved::saved_object;
use rodlab_engine::mechanics::dynamics::{Exchange, Simulation};
use rodlab_files::results::{CaseOutcome, Ending, NamedValues, SeriesRow, Value};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::fmt::Debug;

/// What an observer sees: the simulation after a step, an equilibrium, or at an output.
#[derive(Clone, Copy)]
pub struct Sample<'a> {
    /// The simulation.
    pub simulation: &'a Simulation,
    /// Accepted steps, equilibria or points of a path so far; 0 at the start of a motion, where no forces are known yet.
    pub steps: u64,
    /// Work of the clamps and losses to friction and drag since the start.
    pub exchange: Exchange,
}

impl Sample<'_> {
    /// Time, s; on a path of equilibria its parameter.
    pub fn time(&self) -> f64 {
        self.simulation.time()
    }
}

/// What follows from what an observer saw.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Nothing: the run continues.
    GoOn,
    /// All has been seen: the run ends with the next output, or with this one, as it should.
    End(Ending),
    /// A physics check failed, in a sentence: the run ends here (exit code 4).
    Fail(String),
}

/// What an experiment watches while a scene runs.
///
/// An observer is a value that can be saved: what it remembers are its fields, and a checkpoint holds all of them. The
/// times at which it is due must not depend on those of outputs, so that results do not change with the output interval.
pub trait Observer: ObserverObject + Debug + Send + Sync {
    /// Its name: a word for messages and checkpoints.
    fn name(&self) -> &str;

    /// Names of the columns that it adds to `series.csv`, with the unit as suffix. They never change.
    fn columns(&self) -> Vec<String> {
        Vec::new()
    }

    /// Whether a sample is due after the step that ended at `time`, s.
    fn is_due(&self, _time: f64) -> bool {
        false
    }

    /// Looks at the simulation between outputs.
    fn sample(&mut self, _sample: &Sample<'_>) -> Finding {
        Finding::GoOn
    }

    /// The values of its columns at an output of which `row` is the row; the row is written whatever the finding.
    fn measure(&mut self, sample: &Sample<'_>, row: &SeriesRow) -> (Vec<Value>, Finding);

    /// What the run came to so far: further columns of `summary.csv`.
    fn outcomes(&self) -> NamedValues {
        NamedValues::default()
    }

    /// What else people should know at the end, a sentence each.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// What people want to see first of an outcome, which may be that of an earlier call: names and texts, a line each.
    fn highlights(&self, _outcome: &CaseOutcome) -> Vec<(String, String)> {
        Vec::new()
    }
}

saved_object! {
    /// What every [`Observer`] can do because it is a plain value.
    ObserverObject for Observer
}
