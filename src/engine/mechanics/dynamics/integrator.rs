//! The time step: predict, solve, repeat after a failure, accept.

use super::advice::Means;
use super::drag::FluidDrag;
use super::exchange::AcceptedStep;
use super::failure::Failure;
use super::parameters::{IntegrationParameters, Scheme, StepSize};
use super::report::{SimulationError, StepReport};
use super::scheme::largest_step;
use super::stage::{Attempt, Setting, Workspace};
use super::state::State;
use super::step_control::{Decision, StepControl};
use super::validity_memory::SmallSteps;
use crate::mechanics::SceneError;
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::{RodDescription, Scene};
use crate::mechanics::system::System;
use tracing::{debug, trace_span};

/// Factor by which the contact stiffness grows when a step ends with too much penetration.
pub(super) const STIFFENING: f64 = 10.0;
/// Fraction of the current time below which a step is lost in the rounding of times.
const RESOLVED_TIME: f64 = 64.0 * f64::EPSILON;
/// Fraction of the largest step below which two times count as equal.
const SAME_TIME: f64 = 1e-6;
/// Number of such increases before the step is halved, or accepted if contacts are only deep. If
/// it cannot be halved, an increase may add any amount of energy.
const STIFFENINGS: usize = 3;

/// Fraction of a step of the grid below which a step counts as far smaller than requested.
const SMALL_PART: f64 = 0.125;
/// Number of consecutive such steps after which a run warns.
const SMALL_STEPS: usize = 100;

/// Reason why a step failed.
struct LastFailure {
    reason: String,
    advice: String,
}

/// A step whose stage is set up.
pub(super) struct Begun {
    /// Its end, s.
    pub goal: f64,
    /// Contact stiffness at its start.
    stiffness: f64,
    /// Krylov iterations of the drag.
    fluid_iterations: usize,
}

/// Advances a state in time.
pub(super) struct Integrator {
    pub setting: Setting,
    pub control: StepControl,
    pub fluid: FluidDrag,
    pub workspace: Workspace,
    /// Number of steps far smaller than requested since the last whole step.
    small_steps: usize,
    /// The last failure of a step, with advice.
    last_failure: Option<LastFailure>,
    /// Whether velocities of the last step ring.
    pub rings: bool,
    /// Whether velocities jumped in the last step, and the next one forgets the steps before.
    pub is_cut: bool,
    /// A series of steps far smaller than requested, kept until the caller takes it.
    pub small_row: Option<SmallSteps>,
}

impl Integrator {
    /// Creates an integrator for motions of `scene` from `state`.
    ///
    /// # Errors
    /// [`SceneError::Fluid`] if the fluid or a rod in it is outside the range of the theory.
    pub(crate) fn new(
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
            workspace: Workspace::new(state, system.assembly.rods.nodes, fluid.places()),
            setting: Setting {
                parameters,
                radius: free_rods
                    .map(RodDescription::least_radius)
                    .chain(scene.free_bodies.iter().map(|body| body.shape.radius))
                    .fold(f64::INFINITY, f64::min),
            },
            fluid,
            small_steps: 0,
            last_failure: None,
            rings: false,
            is_cut: false,
            small_row: None,
        })
    }

    /// Restarts the motion: schemes that need earlier steps begin with small ones.
    pub(crate) fn begin_anew(&mut self) {
        let parameters = &self.setting.parameters;
        if parameters.scheme.rules().begins_small() {
            self.control = StepControl::beginning_small(&parameters.step);
        }
    }

    /// Computes the first forces of the fluid, which detects rods too thick for resistive force
    /// theory; the state is unchanged.
    ///
    /// # Errors
    /// [`SceneError::Fluid`].
    pub(crate) fn check_first_drag(
        &mut self,
        scene: &Scene,
        state: &State,
    ) -> Result<(), SceneError> {
        if let Some(FluidModel::Resistive { .. }) = scene.fluid {
            (self.fluid).of_start(&mut self.workspace.stage, state, state.time)?;
        }
        Ok(())
    }

    /// Whether two times, s, differ by rounding only.
    pub(crate) fn is_same_time(&self, one: f64, other: f64) -> bool {
        (one - other).abs() <= same_time(&self.setting.parameters.step)
    }

    /// Begins one step that ends no later than `until` (exactly there if `until` is within the
    /// step): sets up its stage and predicts its solution.
    ///
    /// # Errors
    /// [`SimulationError::Unphysical`] without drag.
    pub(crate) fn begin(
        &mut self,
        system: &mut System,
        state: &State,
        until: f64,
    ) -> Result<Begun, SimulationError> {
        system.begin_damping(&state.unknowns);
        system.update_candidates(&state.unknowns);
        let extrapolates = self.setting.parameters.scheme.rules().extrapolates();
        system.note_start(&state.unknowns, extrapolates);
        let stiffness = system.contact_stiffness();
        let (setting, sizes) = (self.setting, self.setting.parameters.step);
        let until = earlier_event(system, &sizes, state.time, until);
        let goal = self.control.goal(&sizes, state.time, until);
        let fluid_iterations = self.prepare(&setting, system, state, goal)?;
        Ok(Begun {
            goal,
            stiffness,
            fluid_iterations,
        })
    }

    /// Sets up the stage of a step to `goal`.
    fn prepare(
        &mut self,
        setting: &Setting,
        system: &mut System,
        state: &State,
        goal: f64,
    ) -> Result<usize, SimulationError> {
        self.workspace
            .prepare(setting, system, &mut self.fluid, state, goal)
            .map_err(|error| {
                SimulationError::Unphysical(format!("at t = {:.6e} s {error}", state.time))
            })
    }

    /// Takes the step that was begun, as long as `goes_on` returns true; `None` once it returns
    /// false.
    ///
    /// # Errors
    /// [`SimulationError::NoConvergence`] and [`SimulationError::Unphysical`]; the state is then that of
    /// the last accepted step.
    pub(crate) fn complete(
        &mut self,
        system: &mut System,
        state: &mut State,
        begun: Begun,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        let _span = trace_span!("step", time = state.time).entered();
        let Begun {
            mut goal,
            stiffness,
            fluid_iterations,
        } = begun;
        let mut report = StepReport {
            fluid_iterations,
            ..StepReport::default()
        };
        let (mut setting, sizes) = (self.setting, self.setting.parameters.step);
        let mut is_prepared = true;
        let (mut deepenings, mut stiffenings, mut crosses) = (0, 0, false);
        loop {
            let step = goal - state.time;
            if !is_prepared {
                report.fluid_iterations += self.prepare(&setting, system, state, goal)?;
            }
            is_prepared = false;
            let (workspace, fluid) = (&mut self.workspace, &mut self.fluid);
            let attempt = workspace.attempt(&setting, system, fluid, state, goal, goes_on);
            if !goes_on() {
                return Ok(None);
            }
            let stage = &self.workspace.stage;
            let least = self.setting.parameters.minimum_step;
            let is_least = 0.5 * step < least.max(RESOLVED_TIME * goal);
            // The midpoint rule does not conserve energy exactly. If it extrapolates through a
            // soft contact, no smaller step helps.
            let scheme = setting.parameters.scheme.rules();
            let bound = (!is_least && !scheme.extrapolates()).then_some(stage);
            let smaller = match attempt {
                // Stiffen the contacts before their energy has grown, since it would increase with
                // their stiffness.
                Ok(attempt)
                    if attempt.is_deep
                        && deepenings < STIFFENINGS
                        && system.stiffen_contact(STIFFENING, Some(stage)) =>
                {
                    report.newton_iterations += attempt.iterations;
                    deepenings += 1;
                    debug!(
                        time = state.time,
                        step,
                        reason = "contacts are compressed too far",
                        "contact stiffened"
                    );
                    step
                }
                Ok(attempt) => {
                    report.newton_iterations += attempt.iterations;
                    report.fluid_iterations += attempt.fluid_iterations;
                    match self.decide(step, &attempt) {
                        Decision::Accept => {
                            self.rings = attempt.rings;
                            break;
                        }
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
                Err(failure @ Failure::Penetration { .. })
                    if stiffenings < STIFFENINGS && system.stiffen_contact(STIFFENING, bound) =>
                {
                    stiffenings += 1;
                    debug!(time = state.time, step, reason = %failure, "contact stiffened");
                    step
                }
                Err(failure) if scheme.extrapolates() && failure.is_work_of_contact() => {
                    report.newton_iterations += failure.iterations();
                    system.restore_contact_stiffness(stiffness);
                    setting = self.setting.dissipative();
                    debug!(time = state.time, step, reason = %failure, "an impact ends the step");
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
                    let has_fluid = self.fluid.places() > 0;
                    let means = Means::of(system, &self.setting.parameters, has_fluid);
                    self.last_failure = Some(LastFailure {
                        reason: failure.to_string(),
                        advice: failure.advice(&means),
                    });
                    if is_least {
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
        let scheme = setting.parameters.scheme;
        report.exchange = self.accepted(system, state, goal, scheme).exchange();
        (report.obstacle_work, report.contact_force) = system.work_of_obstacles();
        report.stiffening = system.energy_of_stiffening(stiffness);
        self.heed_events(system, state.time, goal);
        self.is_cut = self.jumps(system, state, goal);
        self.accept(system, state, goal);
        if self.is_cut {
            state.history.cut();
        }
        let long = system.long_rotations(&state.unknowns);
        system.begin_rotations_anew(&long, &mut state.motions());
        report.time = state.time;
        report_contacts(system, &mut report);
        self.watch_small_steps(&report);
        debug!(
            time = report.time,
            step = report.step,
            iterations = report.newton_iterations,
            contacts = report.contacts,
            retries = report.retries,
            fluid_iterations = report.fluid_iterations,
            "step accepted"
        );
        Ok(Some(report))
    }

    /// Whether velocities jump at contacts in the step from `state` to `goal`, from which the next
    /// ones would extrapolate.
    fn jumps(&self, system: &System, state: &State, goal: f64) -> bool {
        let rules = self.setting.parameters.scheme.rules();
        rules.begins_small() && self.workspace.jumps(system, state, goal)
    }

    /// Whether the steps after a failed one start small. They do if the step is automatic, and
    /// with friction, since a slip that fails one step fails many. (Steps through a contact are
    /// also followed by more failures.) On a fixed grid, the cause of other failures is over after
    /// the step.
    fn keeps_failed_step(&self, system: &System) -> bool {
        matches!(self.setting.parameters.step, StepSize::Auto { .. }) || system.has_friction()
    }

    /// Restarts with small steps after an event in the step from `start` to `goal`: a step that
    /// relies on earlier velocities errs by their jump.
    fn heed_events(&mut self, system: &System, start: f64, goal: f64) {
        let Setting { parameters, radius } = &self.setting;
        let StepSize::Auto { tolerance, maximum } = parameters.step else {
            return;
        };
        let snap = same_time(&parameters.step);
        let Some(jump) = system.largest_jump(start + snap, goal + snap) else {
            return;
        };
        let harmless = 2.0 * tolerance * radius / jump;
        let spacing = system.next_event(goal + snap) - goal;
        self.control.begin_again(maximum, harmless, spacing);
    }

    /// Records that steps of a fixed grid stay far smaller than requested, with the reason and the
    /// advice.
    fn watch_small_steps(&mut self, report: &StepReport) {
        let StepSize::Fixed(whole) = self.setting.parameters.step else {
            return;
        };
        let Some(LastFailure { reason, advice }) = &self.last_failure else {
            return;
        };
        if report.step >= whole {
            self.small_steps = 0;
        } else if report.step < SMALL_PART * whole {
            self.small_steps += 1;
            if self.small_steps == SMALL_STEPS {
                let message = format!(
                    "at t = {:.6e} s: {SMALL_STEPS} steps were far smaller than the requested {whole} s, the last one {:.3e} s: {reason}",
                    report.time, report.step
                );
                self.small_row = Some(SmallSteps::first(message, advice.clone()));
            }
        }
    }

    /// Decides whether a solved step is accurate enough.
    fn decide(&mut self, step: f64, attempt: &Attempt) -> Decision {
        let Setting { parameters, radius } = &self.setting;
        let tolerance = match parameters.step {
            StepSize::Auto { tolerance, .. } => tolerance,
            StepSize::Fixed(whole) => {
                self.control.recover(whole);
                return Decision::Accept;
            }
        };
        let error = attempt.error / (tolerance * radius);
        let law = parameters.scheme.rules().error_law();
        let decision = self.control.decide(step, error, law, attempt.iterations);
        // The smallest step is accepted with any error; the next ones grow as usual.
        if decision != Decision::Accept && step <= parameters.minimum_step {
            self.control.accept_least(step);
            return Decision::Accept;
        }
        decision
    }

    pub(super) fn accepted<'a>(
        &'a self,
        system: &'a System,
        state: &'a State,
        goal: f64,
        scheme: Scheme,
    ) -> AcceptedStep<'a> {
        AcceptedStep {
            system,
            before: &state.unknowns,
            after: &self.workspace.trial.unknowns,
            velocity: &self.workspace.next_velocity,
            step: goal - state.time,
            scheme,
        }
    }

    /// Accepts the step to `goal` that the workspace holds.
    pub(super) fn accept(&mut self, system: &mut System, state: &mut State, goal: f64) {
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

    /// Restores the last accepted state; the error gives the reason of the failure.
    fn give_up(
        &self,
        system: &mut System,
        state: &mut State,
        step: f64,
        failure: Failure,
    ) -> SimulationError {
        let Workspace { stage, trial, .. } = &self.workspace;
        let error = failure.into_error(system, &trial.unknowns, stage, [state.time, step]);
        system.begin_step(None);
        system.drive(state.time, &mut state.unknowns);
        system.update_geometry(&state.unknowns);
        error
    }
}

/// The end of a step from `time`: the next event before `until`, or else `until`. Events that
/// nearly coincide with either time are ignored.
fn earlier_event(system: &System, sizes: &StepSize, time: f64, until: f64) -> f64 {
    let snap = same_time(sizes);
    let event = system.next_event(time + snap);
    if event < until - snap { event } else { until }
}

/// Difference below which two times count as equal, s.
fn same_time(sizes: &StepSize) -> f64 {
    SAME_TIME * sizes.largest()
}

/// Counts the contacts of the last evaluation and finds the nearest.
pub(super) fn report_contacts(system: &System, report: &mut StepReport) {
    let Some(contact) = system.contact() else {
        return;
    };
    report.contacts = contact.contact_count();
    report.nearest = contact
        .touching()
        .min_by(|a, b| a.ratio().total_cmp(&b.ratio()));
}
