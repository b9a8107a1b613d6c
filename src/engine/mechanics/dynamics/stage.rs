//! One attempt at a step: the implicit stage with its predictor, Newton's method and contact.

use super::certificate::{Step, check_penetration};
use super::contact_passes::{NoForces, Pass, Passes};
use super::drag::FluidDrag;
use super::failure::{Crossing, Failure, Forces};
use super::newton::{Corrected, Newton, Stopping};
use super::parameters::{IntegrationParameters, StepSize};
use super::scheme::{Prediction, SolvedStep};
use super::state::State;
use crate::mechanics::fluid::FluidError;
use crate::mechanics::system::{Stage, System};
use crate::mechanics::{Matrix3, Vector3};

/// Predicted relative motion of rods near each other, in radii, above which contact forces are
/// first sought at the start of the step.
const FAST: f64 = 0.5;

/// Fraction of the free path that a shortened predictor covers: less than all, so that rounding
/// cannot cause contact.
pub(super) const PREDICTED_PART: f64 = 0.9;

/// Most corrections of the lengths that forces feed out of sheaths.
const MOST_PUSHES: usize = 12;

/// Fraction of the largest step below which Newton's method may use all its iterations and line
/// searches. Without this, halving could end below the smallest step.
const FULL_EFFORT_PART: f64 = 1.0 / 64.0;

/// Result of one attempt at a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attempt {
    /// Newton iterations.
    pub iterations: usize,
    /// Krylov iterations of the drag found within the step.
    pub fluid_iterations: usize,
    /// Whether velocities ring: the scheme does not damp motions that its steps do not resolve,
    /// and inertia is too small compared with the drag to resolve them.
    pub rings: bool,
    /// Local error of the positions, m.
    pub error: f64,
    /// Whether a contact is compressed beyond its design force.
    pub is_deep: bool,
}

/// Settings that stay the same in all steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    pub parameters: IntegrationParameters,
    /// Radius of the thinnest rod that is not held, m: the unit of tolerances of positions.
    pub radius: f64,
}

/// Scratch of a step; its results stay here until the step is accepted.
pub(super) struct Workspace {
    pub stage: Stage,
    /// Start and solution of Newton's method, later the end of the step.
    pub trial: Prediction,
    /// Velocity at the end of the step.
    pub next_velocity: Vec<f64>,
    newton: Newton,
    /// Corrections already made to the prediction; taken by the next attempt.
    pub corrected: Option<Corrected>,
    /// The prediction.
    pub prediction: Vec<f64>,
}

impl Workspace {
    /// Creates the scratch for motions from `state` of `nodes` nodes; the fluid acts on `wet` of
    /// them.
    pub(crate) fn new(state: &State, nodes: usize, wet: usize) -> Self {
        let (unknowns, velocity) = (&state.unknowns, &state.velocity);
        Self {
            stage: Stage {
                step: 0.0,
                acceleration_step: 0.0,
                keeps_spin: false,
                start: unknowns.clone(),
                velocity: velocity.clone(),
                drag: vec![Vector3::zeros(); wet],
                drag_velocity: vec![Vector3::zeros(); wet],
                resistance: vec![Matrix3::zeros(); wet],
                flow_torque: Vec::new(),
                positions: vec![Vector3::zeros(); nodes],
                angles: vec![0.0; nodes],
            },
            trial: Prediction {
                unknowns: unknowns.clone(),
                velocity: velocity.clone(),
            },
            next_velocity: velocity.clone(),
            prediction: unknowns.clone(),
            newton: Newton::new(unknowns.len()),
            corrected: None,
        }
    }

    /// Sets up the implicit stage of a step to `goal`, with the prediction in `trial`; returns the Krylov iterations
    /// of the drag.
    ///
    /// # Errors
    /// [`FluidError`] if the drag could not be computed.
    pub(crate) fn prepare(
        &mut self,
        setting: &Setting,
        system: &mut System,
        fluid: &mut FluidDrag,
        state: &State,
        goal: f64,
    ) -> Result<usize, FluidError> {
        let scheme = setting.parameters.scheme.rules();
        let turning = system.assembly.steady_turning();
        let step = goal - state.time;
        self.corrected = None;
        scheme.begin(step, state, turning, &mut self.stage, &mut self.trial);
        let time = scheme.stage_time(state.time, goal);
        let is_middle = scheme.extrapolates();
        system.begin_step(is_middle.then_some(&state.unknowns));
        system.drive(time, &mut self.trial.unknowns);
        system.set_obstacle_pace(if is_middle {
            1.0
        } else {
            self.stage.step / step
        });
        system.damp(
            self.stage.step,
            step,
            scheme.earlier_weights(step, state, turning),
        );
        let iterations = if scheme.predicts_drag() {
            fluid.of_prediction(&mut self.stage, &self.trial.unknowns, time)?
        } else {
            fluid.of_start(&mut self.stage, state, time)?
        };
        fluid.choose_local_part(&mut self.stage, scheme);
        Ok(iterations)
    }

    /// Solves the stage of a step to `goal` from its prediction; leaves the end of the step in
    /// `trial` and `next_velocity`. Fails once `goes_on` returns false.
    pub(crate) fn attempt(
        &mut self,
        setting: &Setting,
        system: &mut System,
        fluid: &mut FluidDrag,
        state: &State,
        goal: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Attempt, Failure> {
        let step = goal - state.time;
        let stopping = match self.corrected {
            Some(_) => stopping(setting, system, step),
            None => self.set_tolerances(setting, system, state, goal),
        };
        let scheme = setting.parameters.scheme.rules();
        let is_coupled = fluid.must_be_coupled();
        let (iterations, fluid_iterations) = if is_coupled {
            self.solve_with_drag(system, fluid, state, &stopping, goes_on)?
        } else {
            let iterations = self.solve_for_pushes(system, state, &stopping, goes_on)?;
            (iterations, 0)
        };
        check_penetration(system, iterations)?;
        if scheme.extrapolates() {
            self.extrapolate(system, state, goal, iterations)?;
        }
        let is_deep = !scheme.extrapolates() && system.is_contact_deep();
        let certified = Step {
            scheme: setting.parameters.scheme,
            stage: &self.stage,
            start: &state.unknowns,
            end: &self.trial.unknowns,
        };
        certified.check(system, iterations)?;
        let solved = SolvedStep {
            step,
            state,
            stage: &self.stage,
            end: &self.trial.unknowns,
            predicted_velocity: &self.trial.velocity,
            held: &system.assembly.held,
        };
        let error = scheme.finish(&solved, &mut self.next_velocity);
        Ok(Attempt {
            iterations,
            fluid_iterations,
            rings: is_coupled && scheme.extrapolates(),
            error,
            is_deep,
        })
    }

    /// Adapts contact stiffness and tolerances to the stage of a step to `goal`; returns the stopping criteria.
    pub(crate) fn set_tolerances(
        &mut self,
        setting: &Setting,
        system: &mut System,
        state: &State,
        goal: f64,
    ) -> Stopping {
        self.adapt_contact_stiffness(setting, system, state);
        let tolerance = setting.parameters.force_tolerance;
        system.set_tolerances(tolerance, &state.unknowns, Some(&self.stage));
        stopping(setting, system, goal - state.time)
    }

    /// Alternates between solving the stage and evaluating the drag of its motion until both
    /// agree; returns the Newton and the Krylov iterations.
    fn solve_with_drag(
        &mut self,
        system: &mut System,
        fluid: &mut FluidDrag,
        state: &State,
        stopping: &Stopping,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<(usize, usize), Failure> {
        fluid.begin_coupling(&self.stage);
        let (mut iterations, mut fluid_iterations) = (0, 0);
        loop {
            iterations += self
                .solve_for_pushes(system, state, stopping, goes_on)
                .map_err(|failure| failure.after(iterations))?;
            let (agrees, more) = fluid
                .couple(&mut self.stage, &self.trial.unknowns)
                .map_err(|_| Failure::NoDrag { iterations })?;
            fluid_iterations += more;
            // The reactions are the residual at clamps. Near rest the drag is as small as the
            // residual left by Newton's method and differs from one solution to the next, but
            // forces balance all the same.
            system.evaluate(&self.trial.unknowns, Some(&self.stage));
            let balanced = system.imbalance().is_balanced();
            if agrees || balanced && fluid.has_stalled() {
                return match fluid.work_of_coupled(&self.stage) {
                    None => Ok((iterations, fluid_iterations)),
                    Some(work) => Err(Failure::Work {
                        iterations,
                        forces: Forces::Drag,
                        work,
                    }),
                };
            }
            if !fluid.expect_coupled(&mut self.stage) {
                return Err(Failure::NoDrag { iterations });
            }
        }
    }

    /// Solves the stage and, where forces feed rods out of sheaths, for the lengths fed out; returns
    /// the Newton iterations.
    fn solve_for_pushes(
        &mut self,
        system: &mut System,
        state: &State,
        stopping: &Stopping,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<usize, Failure> {
        let mut iterations = self.solve_by_either_way(system, state, stopping, goes_on)?;
        for _ in 0..MOST_PUSHES {
            if system.pushes_balance() {
                return Ok(iterations);
            }
            iterations += 1;
            let trial = &mut self.trial.unknowns;
            let corrected = system.correct_fed(trial, &self.stage);
            corrected.map_err(|_| Failure::NoPush { iterations })?;
            let held = system.assembly.held.iter();
            let prescribed = self.prediction.iter_mut().zip(trial).zip(held);
            prescribed.for_each(|((own, new), held)| *own = if *held { *new } else { *own });
            iterations += self
                .solve_by_either_way(system, state, stopping, goes_on)
                .map_err(|failure| failure.after(iterations))?;
        }
        Err(Failure::NoPush { iterations })
    }

    /// Solves by Newton's method from the prediction. With complementarity, if rods near each
    /// other move far, it begins at the start of the step instead: the prediction may have moved
    /// the rods past each other, and contact would then separate them on the wrong sides. If this
    /// fails with carried contact forces, it solves again with line searches, from a prediction
    /// that crosses no contact; if no contact forces are found, from the other of the two starts.
    fn solve_by_either_way(
        &mut self,
        system: &mut System,
        state: &State,
        stopping: &Stopping,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<usize, Failure> {
        if !system.candidates_are_complete(&self.trial.unknowns) {
            system.update_candidates(&self.trial.unknowns);
        }
        let meets_fast = system.has_constraints()
            && system.meets_fast(&self.trial.unknowns, &self.stage, FAST * stopping.radius);
        if meets_fast {
            self.predict_rest(system, state);
            system.update_candidates(&self.trial.unknowns);
        }
        system.begin_iterations(&self.stage);
        let (iterations, failure) = match self.solve(system, stopping, goes_on) {
            Ok(iterations) if !system.touches_barrier() => return Ok(iterations),
            Ok(iterations) => (iterations, None),
            Err(failure) => (failure.iterations(), Some(failure)),
        };
        if let Some(Failure::NoContactForces { .. }) = failure {
            if meets_fast {
                self.trial.unknowns.copy_from_slice(&self.prediction);
            } else {
                self.predict_rest(system, state);
            }
            system.update_candidates(&self.trial.unknowns);
            system.begin_iterations(&self.stage);
            return match self.solve(system, stopping, goes_on) {
                Ok(more) => Ok(iterations + more),
                Err(failure) => Err(failure.after(iterations)),
            };
        }
        let has_other_way = system.uses_multipliers() && !stopping.gives_up;
        if let Some(failure) = failure
            && !has_other_way
        {
            return Err(failure);
        }
        self.trial.unknowns.copy_from_slice(&self.prediction);
        system.abandon_multipliers();
        self.shorten_prediction(system, state)?;
        Ok(iterations + self.solve(system, stopping, goes_on)?)
    }

    /// Alternates Newton's method and the contact forces of complementarity until no contact is
    /// missing; returns the iterations.
    fn solve(
        &mut self,
        system: &mut System,
        stopping: &Stopping,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<usize, Failure> {
        let trial = &mut self.trial.unknowns;
        let (mut iterations, mut passes) = (0, Passes::default());
        loop {
            let pass = if system.has_constraints() {
                iterations += 1;
                let found = passes.next(system, trial, &self.stage, stopping);
                found.map_err(|NoForces| Failure::NoContactForces { iterations })?
            } else {
                Pass::Balanced
            };
            if pass != Pass::Corrected {
                let corrected = self.corrected.take();
                iterations += self
                    .newton
                    .solve(system, &self.stage, trial, corrected, stopping, goes_on)
                    .map_err(Failure::Newton)?;
            }
            // If rods have moved far, a contact may be missing; then continue with new candidates.
            let complete = system.candidates_are_complete(trial);
            if complete && pass == Pass::Balanced {
                return Ok(iterations);
            }
            if !complete {
                system.update_candidates(trial);
            }
        }
    }

    /// Predicts a motion of the prescribed unknowns only. If rods move farther than their radius
    /// within a step, the usual prediction compresses them so much that the linearised step has no
    /// solution: its matrix is indefinite.
    fn predict_rest(&mut self, system: &mut System, state: &State) {
        let held = &system.assembly.held;
        for (k, unknown) in self.trial.unknowns.iter_mut().enumerate() {
            if !held[k] {
                *unknown = state.unknowns[k];
            }
        }
        system.complete(&mut self.trial.unknowns);
    }

    /// Extrapolates from the solution of the stage, the middle of the step, to its end.
    pub(super) fn extrapolate(
        &mut self,
        system: &mut System,
        state: &State,
        goal: f64,
        iterations: usize,
    ) -> Result<(), Failure> {
        let trial = &mut self.trial.unknowns;
        for (end, start) in trial.iter_mut().zip(&state.unknowns) {
            *end = 2.0 * *end - start;
        }
        system.begin_step(None);
        system.drive(goal, trial);
        system.update_geometry(trial);
        if system.largest_step(&state.unknowns, trial) < 1.0 {
            return Err(Failure::Crossing {
                iterations,
                crossing: Crossing::Extrapolation,
            });
        }
        Ok(())
    }

    /// Adapts the contact stiffness to the forces at the prediction. With friction, the inertia is
    /// computed as if the last change of velocity had taken a whole step of the grid.
    ///
    /// When rods stick or slip, velocities jump within one step, however small it is. Inertia,
    /// which is among the forces that set the stiffness (Eq. 2.19), would grow as 1/h. Contact
    /// would become harder and the next event would need a smaller step still, down to the
    /// smallest.
    pub(super) fn adapt_contact_stiffness(
        &mut self,
        setting: &Setting,
        system: &mut System,
        state: &State,
    ) {
        self.prediction.copy_from_slice(&self.trial.unknowns);
        if system.contact().is_none() {
            return;
        }
        let may_bound = !setting.parameters.scheme.rules().extrapolates();
        self.at_prediction(setting, system, state, |system, unknowns, stage| {
            let before = system.contact_stiffness();
            system.adapt_contact_stiffness(unknowns, Some(stage));
            if may_bound {
                system.bound_contact_stiffness(before, unknowns, stage);
            }
        });
    }

    /// Returns the result of `find` at the prediction, shortened where it crosses a contact, with
    /// the inertia for which the contact stiffness is; and the part of the prediction that is left.
    pub(super) fn at_prediction<T>(
        &mut self,
        setting: &Setting,
        system: &mut System,
        state: &State,
        find: impl FnOnce(&mut System, &[f64], &Stage) -> T,
    ) -> (T, f64) {
        let last = state.history.steps[0].size;
        let lengthening = match setting.parameters.step {
            StepSize::Fixed(whole) if system.has_friction() && last > 0.0 => {
                (whole / last).max(1.0)
            }
            _ => 1.0,
        };
        let acceleration_step = self.stage.acceleration_step;
        self.stage.acceleration_step *= lengthening;
        self.trial.unknowns.copy_from_slice(&self.prediction);
        // Inertia includes the motion that a barrier stops. If a clamp moves through the barrier,
        // Newton's method decides.
        let part = self.shorten_prediction(system, state).unwrap_or(0.0);
        let found = find(system, &self.trial.unknowns, &self.stage);
        self.trial.unknowns.copy_from_slice(&self.prediction);
        self.stage.acceleration_step = acceleration_step;
        (found, part)
    }

    /// Shortens a prediction that crosses an impassable contact, if necessary to zero, and returns
    /// the remaining fraction. Held unknowns stay as prescribed.
    fn shorten_prediction(&mut self, system: &mut System, state: &State) -> Result<f64, Failure> {
        let trial = &mut self.trial.unknowns;
        let free = system.largest_step(&state.unknowns, trial);
        if free >= 1.0 {
            return Ok(1.0);
        }
        for part in [PREDICTED_PART * free, 0.0] {
            for k in 0..trial.len() {
                if !system.assembly.held[k] {
                    trial[k] = state.unknowns[k] + part * (trial[k] - state.unknowns[k]);
                }
            }
            system.complete(trial);
            if system.largest_step(&state.unknowns, trial) >= 1.0 {
                return Ok(part);
            }
        }
        Err(Failure::Crossing {
            iterations: 0,
            crossing: Crossing::Clamp,
        })
    }
}

/// Stopping criteria of Newton's method in a step of the given size, s.
fn stopping(setting: &Setting, system: &System, step: f64) -> Stopping {
    let Setting { parameters, radius } = setting;
    let whole = parameters.step.largest();
    Stopping {
        radius: *radius,
        displacement: parameters.displacement_tolerance * radius,
        trust_radius: parameters.scheme.rules().trust_radius() * radius,
        iterations: parameters.maximum_iterations,
        // The midpoint rule extrapolates from this solution, which must therefore be more accurate
        // than the end of a step.
        ends_at_last_digits: !parameters.scheme.rules().extrapolates(),
        gives_up: system.has_friction() && step > FULL_EFFORT_PART * whole,
    }
}
