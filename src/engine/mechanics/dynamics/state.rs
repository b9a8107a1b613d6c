//! The state of motion: what a step starts from, and all that it hands on.

use super::history::{History, LENGTH};

/// Configuration and velocities of all rods.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Time, s.
    pub time: f64,
    /// Unknowns, 4 per node: m and rad.
    pub unknowns: Vec<f64>,
    /// Their velocities, m/s and rad/s.
    pub velocity: Vec<f64>,
    /// The states at the starts of the last steps, for predictors and schemes of several steps.
    pub history: History,
}

impl State {
    /// A motion that begins at time zero.
    pub(crate) fn new(unknowns: &[f64], velocity: &[f64]) -> Self {
        Self {
            time: 0.0,
            history: History::begin(unknowns, velocity),
            unknowns: unknowns.to_vec(),
            velocity: velocity.to_vec(),
        }
    }

    /// The end of a step: the state becomes that at `time`, the one before goes to the history.
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

    /// Starts a motion here: earlier steps are not extrapolated.
    pub(crate) fn begin_anew(&mut self) {
        self.history = History::begin(&self.unknowns, &self.velocity);
    }

    /// At rest at `unknowns`, where no motion led.
    pub(crate) fn rest_at(&mut self, unknowns: &[f64]) {
        self.unknowns.copy_from_slice(unknowns);
        self.velocity.fill(0.0);
        self.history.forget();
    }
}
