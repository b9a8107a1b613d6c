//! Experiments: a scenario becomes a scene, is run, and gives an outcome.

mod curve;
mod derived;
mod flagella;
mod knot_observer;
mod knot_tightening;
mod plot;
mod prepared;
pub mod reproduce;
mod run;
mod scene;
pub mod verify;

pub use derived::{DerivedNumbers, DerivedRod, derived_numbers};
pub use knot_observer::KnotObserver;
pub use plot::plot_results;
pub use prepared::{Mode, OutputPlan, PreparedRun};
pub use run::{RunError, RunOptions, RunOutcome, RunStatus, run};
pub use scene::{prepare, try_scene};
