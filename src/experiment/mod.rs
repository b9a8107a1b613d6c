//! Experiments: a scenario becomes a scene, is run, and gives an outcome.

mod curve;
mod flagella;
mod prepared;
mod scene;
pub mod verify;

pub use prepared::{Mode, OutputPlan, PreparedRun};
pub use scene::prepare;
