//! Controllers, which act on a scene while it runs.
//!
//! A scenario prescribes motions and loads as functions of time. A controller decides while the
//! scene runs. Examples are a gripper that grasps, carries and releases a node, a robot that
//! follows its measurements, and another solver that adds forces.

use super::saved::saved_object;
use rodlab_engine::mechanics::dynamics::{Simulation, SimulationError};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::fmt::Debug;

/// Acts on a simulation before each of its time steps, but not during searches for equilibria or
/// along paths of equilibria.
///
/// A controller is a value that can be saved: its memory is its fields, and a checkpoint holds all
/// of them. The effect of a controller on the simulation (motions of clamps, nodes grasped and
/// released, external forces, factors of loads) is part of the state of the simulation. After a
/// restart, [`Controller::act`] may be called again for the same time; it must then have no further
/// effect.
pub trait Controller: ControllerObject + Debug + Send + Sync {
    /// Name of the controller: a word for messages and checkpoints.
    fn name(&self) -> &str;

    /// Acts before a step.
    ///
    /// # Errors
    /// An action that the simulation rejects. The run then ends with this error, as after a
    /// failed step.
    fn act(&mut self, simulation: &mut Simulation) -> Result<(), SimulationError>;

    /// Latest time of the next action, s: the next step ends then or before. Times in the past are
    /// ignored.
    fn next_time(&self) -> f64 {
        f64::INFINITY
    }
}

saved_object! {
    /// Methods of every [`Controller`] that follow from its serialisable state.
    ControllerObject for Controller
}
