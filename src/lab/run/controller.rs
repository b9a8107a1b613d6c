//! Controllers, which act on a scene while it runs.
//!
//! A scenario prescribes motions and loads as functions of time. A controller decides while the scene runs: a gripper
//! that grasps a node, carries it and releases it, a robot that follows its measurements, another solver that
//! adds its forces.

use super::saved::saved_object;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::fmt::Debug;

/// Acts on a simulation before each of its time steps; a search for an equilibrium and a path have none.
///
/// A controller is a value that can be saved: its memory is its fields, and a checkpoint holds all of them. Its effect
/// on the simulation (motions of clamps, nodes grasped and released, external forces, factors of loads) is part of
/// the state of the simulation. [`Controller::act`] may be called more than once at one time, after a restart: it must
/// then have no further effect.
pub trait Controller: ControllerObject + Debug + Send + Sync {
    /// Its name: a word for messages and checkpoints.
    fn name(&self) -> &str;

    /// Acts before a step.
    ///
    /// # Errors
    /// An action that the simulation refuses; the run then ends as after a failed step with this error.
    fn act(&mut self, simulation: &mut Simulation) -> Result<(), SimulationError>;

    /// Latest time of its next action, s: the next step ends there or before. Times that have passed do not count.
    fn next_time(&self) -> f64 {
        f64::INFINITY
    }
}

saved_object! {
    /// Methods of every [`Controller`] that follow from its being a plain value.
    ControllerObject for Controller
}
