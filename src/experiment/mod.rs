//! Experiments: a scenario becomes a scene, is run, and gives an outcome.

mod prepared;
mod run;

pub use prepared::{Mode, OutputPlan, PreparedRun};
pub use run::{RunError, RunOptions, RunOutcome, RunStatus, run};
