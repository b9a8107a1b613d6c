//! Experiments: a scenario becomes a scene, is run, and gives an outcome.

mod plot;
mod prepared;
mod scene;

pub use plot::plot_results;
pub use prepared::{Mode, OutputPlan, PreparedRun};
pub use scene::prepare;
