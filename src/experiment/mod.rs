//! Experiments: a scenario becomes a scene, is run, and gives an outcome.

mod curve;
mod derived;
mod flagella;
mod plot;
mod prepared;
pub mod reproduce;
mod run;
mod scene;
pub mod sweep;
pub mod verify;
mod workers;

pub use derived::{DerivedNumbers, DerivedRod, derived_numbers};
pub use plot::plot_results;
pub use prepared::{Mode, OutputPlan, PreparedRun};
pub use run::{AmongBars, RunError, RunOptions, RunOutcome, RunStatus, StopRequest, run};
pub use scene::{prepare, try_scene};
