//! Supervision of a stream: interruption, and the state of the motion for a display.

use super::bounds::Tolerance;
use crate::driver::JointState;
use std::time::{Duration, Instant};

/// Time between two states that are shown.
const INTERVAL: Duration = Duration::from_millis(200);

/// State of a motion in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamState {
    /// Time of the trajectory that the slowest part has reached, s.
    pub time: f64,
    /// Time by which the slowest part is late, s.
    pub lag: f64,
    /// Duration of the trajectory, s.
    pub duration: f64,
    /// Largest distance of a joint from its trajectory at the time of the last report; zero for
    /// parts that do not report.
    pub tracking: Tolerance,
    /// Present speed relative to the planned one; `None` if it cannot be changed, since a part
    /// receives its whole motion at once.
    pub pace: Option<f64>,
}

/// Supervises a stream. Every closure that returns whether to interrupt is a supervisor.
pub trait Supervisor {
    /// Whether the motion must end early.
    fn is_interrupted(&self) -> bool;

    /// The reason why nothing may move, whatever the joints report. This method is called before
    /// the start and in every cycle.
    fn forbids(&self) -> Option<String> {
        None
    }

    /// The reason why the report of a part must end the motion. `time` is that of the report on the
    /// clock of the motion, s. This method is called in every cycle with the last report.
    fn refuses(&self, _part: &str, _time: f64, _state: &JointState) -> Option<String> {
        None
    }

    /// The wanted speed relative to the planned one, from 0 (the motion is held) to 1. It has an
    /// effect only if all parts receive their motion in pieces ([`StreamBounds::horizon`]). This
    /// method is called in every cycle.
    ///
    /// [`StreamBounds::horizon`]: super::StreamBounds::horizon
    fn pace(&self) -> f64 {
        1.0
    }

    /// Shows the state of the motion. This method is called five times per second between two
    /// cycles, so it must return at once.
    fn show(&self, _state: &StreamState) {}
}

impl<F: Fn() -> bool> Supervisor for F {
    fn is_interrupted(&self) -> bool {
        self()
    }
}

/// Decides when a state is due.
#[derive(Default)]
pub(super) struct Shown(Option<Instant>);

impl Shown {
    /// Whether a state is due at a time.
    pub(super) fn is_due(&mut self, now: Instant) -> bool {
        let is_due = (self.0).is_none_or(|last| now.saturating_duration_since(last) >= INTERVAL);
        if is_due {
            self.0 = Some(now);
        }
        is_due
    }
}
