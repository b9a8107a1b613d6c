//! Experiments: a scenario becomes a scene, is run, and gives an outcome.

mod prepared;

pub use prepared::{Mode, OutputPlan, PreparedRun};
