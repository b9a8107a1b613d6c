//! The time step: predict, solve, repeat where that fails, accept.

use super::drag::FluidDrag;
use super::exchange::AcceptedStep;
use super::failure::Failure;
use super::parameters::{IntegrationParameters, StepSize};
use super::report::{SimulationError, StepReport};
use super::scheme::largest_step;
use super::stage::{Attempt, Setting, Workspace};
use super::state::State;
use super::step_control::{Decision, StepControl};
use crate::mechanics::SceneError;
use crate::mechanics::fluid::{FluidError, FluidModel};
use crate::mechanics::scene::Scene;
use crate::mechanics::system::System;
use tracing::{debug, trace_span};

/// Factor by which the contact stiffness grows when a step ends with too much penetration.
const STIFFENING: f64 = 10.0;
/// Such growths before the step is halved instead.
const STIFFENINGS: usize = 3;

/// Advances a state in time.
pub(super) struct Integrator {
    pub setting: Setting,
    pub control: StepControl,
    pub fluid: FluidDrag,
    workspace: Workspace,
}

impl Integrator {
    /// For motions of `scene` from `state`.
    ///
    /// # Errors
    /// [`SceneError::Fluid`] where the fluid or a rod in it is beyond the theory.
    pub fn new(
        scene: &Scene,
        system: &System,
        state: &State,
        parameters: &IntegrationParameters,
    ) -> Result<Self, SceneError> {
        let mut parameters = *parameters;
        let begins_small = parameters.scheme.rules().begins_small();
        if begins_small {
            let largest = largest_step(system.assembly.steady_turning());
            parameters.step = parameters.step.limited(largest);
        }
        let fluid = FluidDrag::new(scene, &system.assembly)?;
        let free_rods = scene.rods.iter().filter(|rod| !rod.held);
        Ok(Self {
            control: if begins_small {
                StepControl::beginning_small(&parameters.step)
            } else {
                StepControl::new(&parameters.step)
            },
            workspace: Workspace::new(state, system.assembly.rods.nodes, fluid.nodes()),
            setting: Setting {
                parameters,
                radius: free_rods
                    .map(|rod| rod.radius)
                    .fold(f64::INFINITY, f64::min),
            },
            fluid,
        })
    }

    /// The motion begins anew: schemes that need steps before begin with small ones.
    pub fn begin_anew(&mut self) {
        let parameters = &self.setting.parameters;
        if parameters.scheme.rules().begins_small() {
            self.control = StepControl::beginning_small(&parameters.step);
        }
    }

    /// Rods too thick for resistive force theory show in the first forces, which leave no trace.
    ///
    /// # Errors
    /// [`SceneError::Fluid`].
    pub fn check_first_drag(&mut self, scene: &Scene, state: &State) -> Result<(), SceneError> {
        if let Some(FluidModel::Resistive { .. }) = scene.fluid {
            self.drag_at_the_start(state)?;
        }
        Ok(())
    }

    fn drag_at_the_start(&mut self, state: &State) -> Result<usize, FluidError> {
        let stage = &mut self.workspace.stage;
        self.fluid.of_start(stage, &state.unknowns, &state.velocity)
    }

    /// Takes one step that ends no later than `until` (hit exactly when it is within the step).
    ///
    /// # Errors
    /// [`SimulationError::NoConvergence`] and [`SimulationError::Unphysical`]; the state is then that of
    /// the last accepted step.
    pub fn step(
        &mut self,
        system: &mut System,
        state: &mut State,
        until: f64,
    ) -> Result<StepReport, SimulationError> {
        let _span = trace_span!("step", time = state.time).entered();
        let mut report = StepReport::default();
        let without_drag = |error: FluidError, time: f64| {
            SimulationError::Unphysical(format!("at t = {time:.6e} s {error}"))
        };
        if !self.setting.parameters.scheme.rules().predicts_drag() {
            report.fluid_iterations = self
                .drag_at_the_start(state)
                .map_err(|error| without_drag(error, state.time))?;
        }
        system.update_candidates(&state.unknowns);
        let sizes = self.setting.parameters.step;
        let mut goal = self.control.goal(&sizes, state.time, until);
        let (mut stiffenings, mut crosses) = (0, false);
        loop {
            let step = goal - state.time;
            report.fluid_iterations += self
                .workspace
                .prepare(&self.setting, system, &mut self.fluid, state, goal)
                .map_err(|error| without_drag(error, state.time))?;
            let smaller = match self.workspace.attempt(&self.setting, system, state, goal) {
                Ok(attempt) => {
                    report.newton_iterations += attempt.iterations;
                    match self.decide(step, &attempt) {
                        Decision::Accept => break,
                        Decision::Repeat(smaller) => {
                            debug!(
                                time = state.time,
                                step,
                                iterations = attempt.iterations,
                                reason = "the local error is too large",
                                error = attempt.error,
                                "step rejected"
                            );
                            smaller
                        }
                    }
                }
                Err(failure @ Failure::Penetration { .. }) if stiffenings < STIFFENINGS => {
                    stiffenings += 1;
                    debug!(time = state.time, step, reason = %failure, "contact stiffened");
                    stiffen_contact(system);
                    step
                }
                Err(failure) => {
                    report.newton_iterations += failure.iterations();
                    crosses |= matches!(failure, Failure::Crossing { .. });
                    debug!(
                        time = state.time,
                        step,
                        iterations = failure.iterations(),
                        reason = %failure,
                        "step rejected"
                    );
                    if 0.5 * step < self.setting.parameters.minimum_step {
                        return Err(self.give_up(system, state, step, failure));
                    }
                    0.5 * step
                }
            };
            report.retries += 1;
            if smaller < step {
                if crosses || self.keeps_failed_step(system) {
                    self.control.failed(smaller);
                }
                goal = state.time + smaller;
            }
        }
        report.step = self.control.size(&sizes, goal - state.time);
        report.exchange = self.accepted(system, state, goal).exchange();
        self.accept(system, state, goal);
        report.time = state.time;
        report_contacts(system, &mut report);
        debug!(
            time = report.time,
            step = report.step,
            iterations = report.newton_iterations,
            contacts = report.contacts,
            retries = report.retries,
            fluid_iterations = report.fluid_iterations,
            "step accepted"
        );
        Ok(report)
    }

    /// Whether the steps after a failed one begin small: where the step is automatic, and with friction, since the
    /// slip that fails one step fails many. (So do steps that lead through a contact, of which more follow.) Steps of a
    /// fixed grid that fail for another reason are over when they are done.
    fn keeps_failed_step(&self, system: &System) -> bool {
        matches!(self.setting.parameters.step, StepSize::Auto { .. }) || system.has_friction()
    }

    /// Whether a solved step is accurate enough.
    fn decide(&mut self, step: f64, attempt: &Attempt) -> Decision {
        let Setting { parameters, radius } = &self.setting;
        let tolerance = match parameters.step {
            StepSize::Auto { tolerance, .. } => tolerance,
            StepSize::Fixed(whole) => {
                self.control.recover(whole);
                return Decision::Accept;
            }
        };
        if step <= parameters.minimum_step {
            return Decision::Accept;
        }
        let error = attempt.error / (tolerance * radius);
        let law = parameters.scheme.rules().error_law();
        self.control.decide(step, error, law, attempt.iterations)
    }

    fn accepted<'a>(&'a self, system: &'a System, state: &'a State, goal: f64) -> AcceptedStep<'a> {
        AcceptedStep {
            system,
            before: &state.unknowns,
            after: &self.workspace.trial.unknowns,
            velocity: &self.workspace.next_velocity,
            step: goal - state.time,
            scheme: self.setting.parameters.scheme,
        }
    }

    fn accept(&mut self, system: &mut System, state: &mut State, goal: f64) {
        let Workspace {
            stage,
            trial,
            next_velocity,
            ..
        } = &self.workspace;
        self.fluid.accept(stage, next_velocity);
        state.advance_to(goal, &trial.unknowns, next_velocity);
        system.accept();
    }

    /// Returns to the last accepted state; the error says why the step failed.
    fn give_up(
        &self,
        system: &mut System,
        state: &mut State,
        step: f64,
        failure: Failure,
    ) -> SimulationError {
        let Workspace { stage, trial, .. } = &self.workspace;
        let error = failure.into_error(system, &trial.unknowns, stage, [state.time, step]);
        system.drive(state.time, &mut state.unknowns);
        system.update_geometry(&state.unknowns);
        error
    }
}

/// Makes contact stiffer.
pub(super) fn stiffen_contact(system: &mut System) {
    if let Some(contact) = &mut system.contact {
        contact.set_stiffness(STIFFENING * contact.stiffness());
    }
}

/// Counts the contacts of the last evaluation and finds the nearest.
pub(super) fn report_contacts(system: &System, report: &mut StepReport) {
    let Some(contact) = &system.contact else {
        return;
    };
    report.contacts = contact.contact_count();
    report.nearest = contact
        .touching()
        .min_by(|a, b| a.ratio().total_cmp(&b.ratio()));
}
