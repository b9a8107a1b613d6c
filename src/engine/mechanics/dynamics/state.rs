//! The state of motion: the start of a step, and all that it passes on to the next.

use super::history::{History, LENGTH};

/// Configuration and velocities of all rods.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Time, s.
    pub time: f64,
    /// Unknowns, 4 per node: m and rad.
    pub unknowns: Vec<f64>,
    /// Velocities of the unknowns, m/s and rad/s.
    pub velocity: Vec<f64>,
    /// The states at the starts of the last steps, for predictors and multistep schemes.
    pub history: History,
}

impl State {
    /// The start of a motion at time zero.
    pub(crate) fn new(unknowns: &[f64], velocity: &[f64]) -> Self {
        Self {
            time: 0.0,
            history: History::begin(unknowns, velocity),
            unknowns: unknowns.to_vec(),
            velocity: velocity.to_vec(),
        }
    }

    /// Completes a step: sets the state at `time` and moves the previous one to the history.
    pub(crate) fn advance_to(&mut self, time: f64, unknowns: &[f64], velocity: &[f64]) {
        let now = [&mut self.unknowns, &mut self.velocity];
        self.history.remember(time - self.time, now);
        self.time = time;
        self.unknowns.copy_from_slice(unknowns);
        self.velocity.copy_from_slice(velocity);
    }

    /// Unknowns and velocities now, and at the starts of the last steps.
    pub(crate) fn motions(&mut self) -> [[&mut [f64]; 2]; 1 + LENGTH] {
        let [a, b, c] = &mut self.history.steps;
        let [a, b, c] = [a, b, c].map(|past| [&mut past.unknowns[..], &mut past.velocity[..]]);
        [[&mut self.unknowns, &mut self.velocity], a, b, c]
    }

    /// Starts a new motion here: earlier steps are no longer extrapolated.
    pub(crate) fn begin_anew(&mut self) {
        self.history = History::begin(&self.unknowns, &self.velocity);
    }

    /// Sets the state to rest at `unknowns`, a configuration that no motion reached.
    pub(crate) fn rest_at(&mut self, unknowns: &[f64]) {
        self.unknowns.copy_from_slice(unknowns);
        self.velocity.fill(0.0);
        self.history.forget();
    }
}
