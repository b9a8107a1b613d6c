//! The last steps: what predictors extrapolate from and backward differences go through.

use serde::{Deserialize, Serialize};

/// Steps that are remembered.
pub const LENGTH: usize = 3;

/// The motion at the last steps, the latest first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History {
    pub(super) moments: [Moment; LENGTH],
}

/// The motion at the start of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// Size of the step, s; 0 where there was none.
    pub(super) step: f64,
    /// Unknowns, 4 per node.
    pub(super) unknowns: Vec<f64>,
    /// Their velocities.
    pub(super) velocity: Vec<f64>,
}

impl History {
    /// Of a motion that begins.
    pub fn begin(unknowns: &[f64], velocity: &[f64]) -> Self {
        let moment = Moment {
            step: 0.0,
            unknowns: unknowns.to_vec(),
            velocity: velocity.to_vec(),
        };
        Self {
            moments: std::array::from_fn(|_| moment.clone()),
        }
    }

    /// Adds the start of a step.
    pub fn remember(&mut self, step: f64, unknowns: &[f64], velocity: &[f64]) {
        self.moments.rotate_right(1);
        let moment = &mut self.moments[0];
        moment.step = step;
        moment.unknowns.copy_from_slice(unknowns);
        moment.velocity.copy_from_slice(velocity);
    }

    /// What follows does not go on with what was: the state was put to rest elsewhere.
    pub fn forget(&mut self) {
        for moment in &mut self.moments {
            moment.step = 0.0;
            moment.velocity.fill(0.0);
        }
    }
}
