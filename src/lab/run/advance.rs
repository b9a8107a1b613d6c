//! Interface of a simulation to the run loop.

use rodlab_engine::mechanics::contact::Proximity;
use rodlab_engine::mechanics::dynamics::{
    Energies, Simulation, SimulationError, SimulationState, StepReport, Touch,
};
use rodlab_engine::mechanics::scene::Start;
use rodlab_engine::mechanics::statics::{PathPlan, PathPoint, Tracer};
use rodlab_files::results::{ContactRecord, Frame};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Interface of a simulation that advances in time; tests replace [`Simulation`] by a test double.
pub trait Advance {
    /// The complete state: everything that determines the further steps.
    type State: Serialize + DeserializeOwned;

    /// Takes one step that ends no later than `until`.
    fn advance(&mut self, until: f64) -> Result<StepReport, SimulationError>;
    /// Takes one step that ends no later than `until`. `None` if `goes_on` returned false; then a
    /// state must be restored before any other call.
    fn advance_while(
        &mut self,
        until: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError>;
    /// Finds the equilibrium; `None` if `goes_on` returned false.
    fn find_equilibrium(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError>;
    /// A path of equilibria that begins at the present configuration.
    fn path(&self, plan: PathPlan) -> Result<Tracer, SimulationError>;
    /// Computes the next point of a path; `None` after the last.
    fn next_point(&mut self, path: &mut Tracer) -> Result<Option<PathPoint>, SimulationError>;
    /// Time, s.
    fn time(&self) -> f64;
    /// Energies, J.
    fn energies(&self) -> Energies;
    /// The bodies that are nearest to touching; `None` if none is near.
    fn nearest(&self) -> Option<Proximity>;
    /// Mean gap between surfaces in contact, weighted by their forces, m; `None` without contact.
    fn mean_gap(&self) -> Option<f64>;
    /// Remarks for the user so far, a sentence each.
    fn remarks(&self) -> Vec<String>;
    /// The current nodes; with velocities and forces if requested.
    fn frame(&self, with_forces: bool) -> Frame;

    /// Places at which surfaces press on each other in the last step.
    fn contacts(&self) -> Vec<ContactRecord> {
        Vec::new()
    }
    /// The simulation that observers measure; `None` in a test double, which has no observers.
    fn simulation(&self) -> Option<&Simulation>;
    /// The simulation on which controllers act.
    fn simulation_mut(&mut self) -> Option<&mut Simulation>;
    /// The state as the start of another run; `None` in a test double.
    fn as_start(&self) -> Option<Start>;
    /// Contents of a checkpoint.
    fn state(&self) -> Self::State;
    /// Continues from a checkpoint.
    fn restore(&mut self, state: Self::State) -> Result<(), SimulationError>;
}

impl Advance for Simulation {
    type State = SimulationState;

    fn advance(&mut self, until: f64) -> Result<StepReport, SimulationError> {
        self.advance(until)
    }

    fn advance_while(
        &mut self,
        until: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        self.advance_while(until, goes_on)
    }

    fn find_equilibrium(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        self.find_equilibrium_while(goes_on)
    }

    fn path(&self, plan: PathPlan) -> Result<Tracer, SimulationError> {
        self.path(plan)
    }

    fn next_point(&mut self, path: &mut Tracer) -> Result<Option<PathPoint>, SimulationError> {
        self.next_point(path)
    }

    fn time(&self) -> f64 {
        self.time()
    }

    fn energies(&self) -> Energies {
        self.energies()
    }

    fn nearest(&self) -> Option<Proximity> {
        self.nearest()
    }

    fn mean_gap(&self) -> Option<f64> {
        self.mean_gap()
    }

    fn remarks(&self) -> Vec<String> {
        self.remarks()
    }

    fn frame(&self, with_forces: bool) -> Frame {
        let mut frame = Frame {
            time: self.time(),
            positions: self.positions().to_vec(),
            edge_angles: self.edge_angles().to_vec(),
            ..Frame::default()
        };
        if with_forces {
            frame.twist_rates = self.twist_rates();
            frame.velocities = self.velocities().to_vec();
            frame.fluid_forces = self.fluid_forces();
            frame.contact_forces = self.contact_forces();
        }
        frame
    }

    fn contacts(&self) -> Vec<ContactRecord> {
        let record = |one: Touch| ContactRecord {
            names: one.names,
            nodes: one.nodes,
            place: one.place,
            normal: one.normal,
            gap: one.gap,
            normal_force: one.normal_force,
            friction: one.friction,
        };
        self.touches().into_iter().map(record).collect()
    }

    fn simulation(&self) -> Option<&Simulation> {
        Some(self)
    }

    fn simulation_mut(&mut self) -> Option<&mut Simulation> {
        Some(self)
    }

    fn as_start(&self) -> Option<Start> {
        Some(self.as_start())
    }

    fn state(&self) -> SimulationState {
        self.state()
    }

    fn restore(&mut self, state: SimulationState) -> Result<(), SimulationError> {
        self.restore(state)
    }
}
