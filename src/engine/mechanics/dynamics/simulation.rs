//! A scene in motion or at rest: the entry point of dynamics and statics.

use super::flow_overlaps::FlowOverlaps;
use super::integrator::{Begun, Integrator};
use super::parameters::{IntegrationParameters, Scheme};
use super::report::{SimulationError, StepReport};
use super::state::State;
use super::validity::Validity;
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::Scene;
use crate::mechanics::system::{Demand, System, copy_positions};

/// A scene in motion.
pub struct Simulation {
    pub(super) system: System,
    pub(super) state: State,
    pub(super) integrator: Integrator,
    pub(super) published: Published,
    pub(super) validity: Validity,
}

/// The state as arrays over nodes, for observers.
pub(super) struct Published {
    pub positions: Vec<Vector3>,
    pub velocities: Vec<Vector3>,
    pub edge_angles: Vec<f64>,
}

impl Simulation {
    /// Sets up a simulation at time zero.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] for an invalid scene, with the reason.
    pub fn new(scene: &Scene, parameters: &IntegrationParameters) -> Result<Self, SimulationError> {
        let mut system = System::new(scene)?;
        system.admit(match parameters.scheme {
            Scheme::ImplicitEuler => Demand::ImplicitEuler,
            Scheme::ImplicitMidpoint => Demand::ImplicitMidpoint,
            Scheme::BackwardDifferences => Demand::BackwardDifferences,
        })?;
        let mut state = State::new(&system.assembly.unknowns, &system.assembly.velocity);
        let mut integrator = Integrator::new(scene, &system, &state, parameters)?;
        system.drive(0.0, &mut state.unknowns);
        system.update_geometry(&state.unknowns);
        integrator.check_first_drag(scene, &state)?;
        let nodes = system.assembly.rods.nodes;
        let overlaps = FlowOverlaps::of(scene, &system, &state.unknowns);
        let mut simulation = Self {
            system,
            state,
            integrator,
            validity: (Validity::new(scene).with_steps(&parameters.step)).with_overlaps(overlaps),
            published: Published {
                positions: vec![Vector3::zeros(); nodes],
                velocities: vec![Vector3::zeros(); nodes],
                edge_angles: vec![0.0; nodes],
            },
        };
        simulation.publish();
        Ok(simulation)
    }

    /// Takes one step that ends no later than `until` (exactly there if `until` is within the
    /// step).
    ///
    /// If `until` differs from the current time by rounding only, no step is taken and the time is
    /// set to `until`. A velocity is a difference divided by the step; over such a tiny step it
    /// would be noise.
    ///
    /// # Errors
    /// [`SimulationError::NoConvergence`] and [`SimulationError::Unphysical`]; the state is then that of
    /// the last accepted step.
    pub fn advance(&mut self, until: f64) -> Result<StepReport, SimulationError> {
        let taken = self.advance_while(until, &|| true)?;
        Ok(taken.expect("it is never stopped"))
    }

    /// As [`Self::advance`], but stops and returns `None` once `goes_on`, called at every Newton
    /// iteration, returns false. The step is then incomplete: call [`Self::restore`] before
    /// anything else.
    ///
    /// # Errors
    /// The errors of [`Self::advance`].
    pub fn advance_while(
        &mut self,
        until: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        if self.integrator.is_same_time(self.state.time, until) {
            self.state.time = self.state.time.max(until);
            return Ok(Some(StepReport {
                time: self.state.time,
                ..StepReport::default()
            }));
        }
        let begun = self.begin(until);
        self.complete(begun, goes_on)
    }

    /// Begins the next step, to end no later than `until`.
    pub(super) fn begin(&mut self, until: f64) -> Result<Begun, SimulationError> {
        self.integrator.begin(&mut self.system, &self.state, until)
    }

    /// Takes the step that was begun.
    pub(super) fn complete(
        &mut self,
        begun: Result<Begun, SimulationError>,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        let result = begun.and_then(|begun| {
            let (system, state) = (&mut self.system, &mut self.state);
            self.integrator.complete(system, state, begun, goes_on)
        });
        self.publish();
        if let Ok(Some(report)) = &result {
            let mut validity = std::mem::take(&mut self.validity);
            let unknowns = &self.state.unknowns;
            let ruined = validity.after_step(&self.system, report, unknowns, || self.energies());
            if self.integrator.rings {
                validity.note_ringing(report.time);
            }
            if let Some(row) = self.integrator.small_row.take() {
                validity.note_small_steps(row);
            }
            self.validity = validity;
            let State {
                time,
                unknowns,
                velocity,
                ..
            } = &mut self.state;
            if self.system.break_joints(*time, unknowns, velocity) {
                self.begin_anew();
            }
            if let Some(reason) = ruined {
                return Err(SimulationError::Unphysical(reason));
            }
        }
        result.map_err(|error| self.explain(error))
    }

    /// Replaces an error of convergence if rods are crushed or about to be.
    fn explain(&self, error: SimulationError) -> SimulationError {
        let Published {
            positions,
            velocities,
            ..
        } = &self.published;
        let SimulationError::NoConvergence { time, .. } = &error else {
            return error;
        };
        let impact = self
            .validity
            .fast_impact(&self.system, positions, velocities);
        let crushed = || self.validity.crushed(&self.system, &self.state.unknowns);
        match impact.or_else(crushed) {
            Some(reason) => SimulationError::Unphysical(format!("at t = {time:.6e} s {reason}")),
            None => error,
        }
    }

    /// Copies the state into the arrays for observers.
    pub(super) fn publish(&mut self) {
        copy_positions(&self.state.unknowns, &mut self.published.positions);
        copy_positions(&self.state.velocity, &mut self.published.velocities);
        for (node, angle) in self.published.edge_angles.iter_mut().enumerate() {
            *angle = self.state.unknowns[STRIDE * node + 3];
        }
    }
}
