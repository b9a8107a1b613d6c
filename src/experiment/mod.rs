//! Experiments: a scenario becomes a scene, is run, and gives an outcome.

mod case_folders;
mod curve;
mod derived;
mod flagella;
mod gripper_motion;
mod helix_manipulation;
mod helix_stability;
mod knot_course;
mod knot_observer;
mod knot_tightening;
mod plot;
mod prepared;
pub mod reproduce;
mod run;
mod scene;
pub mod sweep;
mod tied_knot;
pub mod verify;
mod view;
mod workers;

pub use derived::{DerivedNumbers, DerivedRod, derived_numbers};
pub use helix_stability::{discrete_critical_distance, estimated_critical_distance};
pub use knot_observer::{KnotGlance, KnotObserver};
pub use plot::{CustomFigure, PlotError, custom_figure, plot_results, write_figure};
pub use prepared::{Mode, OutputPlan, PreparedRun};
pub use run::{AmongBars, Reached, RunError, RunOptions, RunOutcome, RunStatus, StopRequest, run};
pub use scene::{prepare, try_scene};
pub use view::{ViewError, WrittenPage, write_page};
