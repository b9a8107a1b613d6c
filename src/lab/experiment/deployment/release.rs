//! Release of the rod by the gripper.

use crate::run::Controller;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use serde::{Deserialize, Serialize};

/// Releases a clamp at a given time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Release {
    clamp: usize,
    time: f64,
    is_done: bool,
}

impl Release {
    /// The release of a clamp of the scene at a time, s.
    pub fn new(clamp: usize, time: f64) -> Self {
        Self {
            clamp,
            time,
            is_done: false,
        }
    }
}

impl Controller for Release {
    fn name(&self) -> &str {
        "release"
    }

    fn act(&mut self, simulation: &mut Simulation) -> Result<(), SimulationError> {
        if self.is_done || simulation.time() < self.time * (1.0 - 1e-12) {
            return Ok(());
        }
        self.is_done = true;
        simulation.release(self.clamp)
    }

    fn next_time(&self) -> f64 {
        if self.is_done {
            f64::INFINITY
        } else {
            self.time
        }
    }
}
