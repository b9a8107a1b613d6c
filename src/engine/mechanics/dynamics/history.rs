//! The last steps, used by predictors for extrapolation and by backward differences.

use serde::{Deserialize, Serialize};

/// Number of steps that are remembered.
pub(crate) const LENGTH: usize = 3;

/// The motion at the starts of the last steps, the latest first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History {
    pub(super) steps: [PastStep; LENGTH],
}

/// The motion at the start of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PastStep {
    /// Size of the step, s; 0 if there was none.
    pub(super) size: f64,
    /// Unknowns, 4 per node.
    pub(super) unknowns: Vec<f64>,
    /// Their velocities.
    pub(super) velocity: Vec<f64>,
}

impl History {
    /// History at the start of a motion.
    pub(crate) fn begin(unknowns: &[f64], velocity: &[f64]) -> Self {
        let step = PastStep {
            size: 0.0,
            unknowns: unknowns.to_vec(),
            velocity: velocity.to_vec(),
        };
        Self {
            steps: std::array::from_fn(|_| step.clone()),
        }
    }

    /// Adds the start of a step of `size` (s) with its unknowns and velocities; the arguments
    /// receive those of the oldest step, which is dropped.
    pub(crate) fn remember(&mut self, size: f64, [unknowns, velocity]: [&mut Vec<f64>; 2]) {
        self.steps.rotate_right(1);
        let step = &mut self.steps[0];
        step.size = size;
        std::mem::swap(&mut step.unknowns, unknowns);
        std::mem::swap(&mut step.velocity, velocity);
    }

    /// Drops the earlier steps: schemes no longer extrapolate from them.
    pub(crate) fn cut(&mut self) {
        for step in &mut self.steps {
            step.size = 0.0;
        }
    }

    /// Resets the history after the state was set to rest at another configuration.
    pub(crate) fn forget(&mut self) {
        self.cut();
        for step in &mut self.steps {
            step.velocity.fill(0.0);
        }
    }

    /// The previous step, and the ratio of `size` (s) to its size; 0 if there was none.
    pub(super) fn last(&self, size: f64) -> (&PastStep, f64) {
        let last = &self.steps[0];
        let growth = if last.size > 0.0 {
            size / last.size
        } else {
            0.0
        };
        (last, growth)
    }
}
