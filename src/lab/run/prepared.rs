//! A run that is ready to start, built by every experiment from its scenario.

use super::stop::StopRequests;
use super::{Controller, Observer, RunError, RunOptions, RunOutcome};
use rodlab_engine::mechanics::dynamics::IntegrationParameters;
use rodlab_engine::mechanics::scene::Scene;
use rodlab_engine::mechanics::statics::PathPlan;
use std::fmt::Debug;
use std::sync::Arc;

/// A scenario turned into mechanics, with all data for the run loop.
#[derive(Clone, Debug)]
pub struct PreparedRun {
    /// Short name for directories: the stem of the scenario file.
    pub name: String,
    /// Name of the experiment, such as `scene` or `flagella`.
    pub experiment: String,
    /// Title for readers.
    pub title: String,
    /// The resolved scenario as TOML, runnable without changes; its hash identifies the run.
    pub scenario_toml: String,
    /// The mechanics.
    pub scene: Scene,
    /// Dynamic or static.
    pub mode: Mode,
    /// Parameters of time integration and Newton's method.
    pub integration: IntegrationParameters,
    /// Which files are written, and how often.
    pub output: OutputPlan,
    /// Observers in their state at the start.
    pub observers: Vec<Box<dyn Observer>>,
    /// Controllers in their state at the start.
    pub controllers: Vec<Box<dyn Controller>>,
    /// Job that fills a table instead of moving the scene, which is then that of the first row.
    pub table: Option<Arc<dyn TableRun>>,
    /// Names of the files that kinds of experiments add to those of every run. A run that starts
    /// from scratch removes them, too.
    pub own_files: Vec<&'static str>,
    /// Warnings about the scenario, a sentence each: the run logs them, and repeats them as
    /// remarks at its end.
    pub warnings: Vec<String>,
    /// The file with the start state, if the scene does not start as placed. The results hold a
    /// copy of it.
    pub start: Option<Arc<[u8]>>,
}

impl PreparedRun {
    /// The first observer of a type.
    pub fn observer<T: Observer + 'static>(&self) -> Option<&T> {
        let mut observers = self.observers.iter();
        observers.find_map(|observer| (**observer).as_any().downcast_ref())
    }
}

/// Job that fills a table: a [`TableJob`](super::TableJob) with any type of row.
pub trait TableRun: Debug + Send + Sync {
    /// Number of rows.
    fn rows(&self) -> usize;
    /// Computes the missing rows and finishes the table.
    ///
    /// # Errors
    /// See [`RunError`].
    fn run(
        &self,
        prepared: &PreparedRun,
        options: &RunOptions,
        stop_requested: StopRequests<'_>,
    ) -> Result<RunOutcome, RunError>;
}

/// Whether the scene moves in time or rests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// Time steps from zero to `end`, s.
    Dynamic {
        /// End of the simulated time, s.
        end: f64,
        /// Whether the scene is brought to equilibrium first, at time zero.
        settles: bool,
    },
    /// Equilibrium by Newton's method without inertia.
    Static,
    /// Equilibria along a path.
    Continuation(PathPlan),
}

/// Output of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputPlan {
    /// Time between outputs, s.
    pub interval: f64,
    /// Whether `nodes.csv` is written.
    pub nodes: bool,
    /// Whether velocities, fluid and contact forces of the nodes are written (`node_forces.csv`).
    pub forces: bool,
    /// Whether the places of contacts are written (`contacts.csv`).
    pub contacts: bool,
    /// Whether a VTK PolyData series is written.
    pub vtk: bool,
}
