//! The implicit stage of one step: predictor, Newton's method, contact, and the local error.

use super::Simulation;
use super::failure::Failure;
use super::newton::Stopping;
use super::parameters::{Scheme, StepSize};
use super::report::SimulationError;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, describe_overlap};

/// Times that contact forces and the rods under them are found in turn before the step counts as failed.
const CONTACT_PASSES: usize = 30;

/// Part of the free way that a shortened predictor goes: less than all, so that it is free in spite of rounding.
const PREDICTED_PART: f64 = 0.9;

/// Part of the largest step from which down Newton's method gets all its iterations and line searches. Without this a
/// step could be halved until it is smaller than the smallest.
const PATIENT_PART: f64 = 1.0 / 64.0;

/// Farthest way of an iteration from a predictor of third order, in radii. Where predicted contacts press hard, Newton's
/// method may leap to another solution of the step, centimetres away, from which the rods would only slowly return.
const LEAP: f64 = 0.2;

/// What one attempt at a step found.
pub(super) struct Attempt {
    pub iterations: usize,
    pub error: f64,
}

impl Simulation {
    /// Sets up the implicit stage of a step to `goal`, with the predictor in `trial`; returns the Krylov iterations
    /// of the drag where the scheme wants that of the predicted motion.
    ///
    /// # Errors
    /// [`SimulationError::Unphysical`] where the fluid has no answer.
    pub(super) fn prepare_stage(&mut self, goal: f64) -> Result<usize, SimulationError> {
        let step = goal - self.time;
        let (stage_step, stage_time) = match self.parameters.scheme {
            Scheme::ImplicitEuler => (step, goal),
            Scheme::ImplicitMidpoint => (0.5 * step, self.time + 0.5 * step),
            Scheme::BackwardDifferences => {
                self.begin_backward_difference(step);
                self.system.drive(goal, &mut self.trial);
                return self.compute_predicted_drag();
            }
        };
        self.stage.step = stage_step;
        self.stage.acceleration_step = stage_step;
        self.stage.start.copy_from_slice(&self.unknowns);
        self.stage.velocity.copy_from_slice(&self.velocity);
        self.stage.positions.copy_from_slice(&self.positions);
        self.predict(stage_step);
        self.system.drive(stage_time, &mut self.trial);
        Ok(0)
    }

    /// Solves the implicit stage of a step to `goal` from its predictor; leaves its solution in `trial`.
    pub(super) fn attempt(&mut self, goal: f64) -> Result<Attempt, Failure> {
        let step = goal - self.time;
        self.shorten_predictor()?;
        self.adapt_contact_stiffness();
        let relative_tolerance = self.parameters.force_tolerance;
        let stopping = Stopping {
            force: self.system.force_tolerance(
                relative_tolerance,
                &self.unknowns,
                Some(&self.stage),
            ),
            displacement: self.parameters.displacement_tolerance * self.radius,
            farthest: match self.parameters.scheme {
                Scheme::BackwardDifferences => LEAP * self.radius,
                Scheme::ImplicitEuler | Scheme::ImplicitMidpoint => f64::INFINITY,
            },
            iterations: self.parameters.maximum_iterations,
            gives_up: self.system.rubs() && step > PATIENT_PART * self.parameters.step.largest(),
        };
        let (mut iterations, mut passes) = (0, 0);
        loop {
            let mut settled = true;
            if self.system.has_constraints() {
                passes += 1;
                iterations += 1;
                settled = self.find_contact_forces(stopping.displacement, iterations)?;
                if !settled && passes == CONTACT_PASSES {
                    return Err(self.no_contact_forces(iterations));
                }
            }
            iterations += self
                .newton
                .solve(&mut self.system, &self.stage, &mut self.trial, &stopping)
                .map_err(Failure::Newton)?;
            // A contact may be missing where rods have moved far; then go on with new candidates.
            let complete = self.system.candidates_are_complete(&self.trial);
            if complete && settled {
                break;
            }
            if !complete {
                self.system.update_candidates(&self.trial);
            }
        }
        if let Some(contact) = &self.system.contact
            && let Some(overlap) = contact.excessive_penetration()
        {
            let what = describe_overlap(&overlap, contact, &self.system.assembly);
            return Err(Failure::Penetration { iterations, what });
        }
        if self.parameters.scheme == Scheme::ImplicitMidpoint {
            for (end, start) in self.trial.iter_mut().zip(&self.unknowns) {
                *end = 2.0 * *end - start;
            }
            self.system.drive(goal, &mut self.trial);
            self.system.update_geometry(&self.trial);
            if self.system.largest_step(&self.unknowns, &self.trial) < 1.0 {
                let what = "the extrapolation of the midpoint rule leads through a contact".into();
                return Err(Failure::Crossing { iterations, what });
            }
        }
        self.certify(iterations)?;
        Ok(Attempt {
            iterations,
            error: self.velocity_after(step),
        })
    }

    /// Certifies the step that ends at the trial: no surfaces overlap there beyond the bound, and none have passed through
    /// each other on the way.
    fn certify(&mut self, iterations: usize) -> Result<(), Failure> {
        // Where contact forces are functions of the gaps at the end, these have been looked at.
        let ends_elsewhere = self.parameters.scheme == Scheme::ImplicitMidpoint;
        let overlap = if ends_elsewhere || self.system.has_constraints() {
            self.system.excessive_penetration_at(&self.trial)
        } else {
            None
        };
        let what = overlap.or_else(|| self.system.passage(&self.unknowns, &self.trial));
        what.map_or(Ok(()), |what| Err(Failure::Crossing { iterations, what }))
    }

    /// Adapts the contact stiffness to the forces at the predictor, and where rods rub to an inertia that takes the last
    /// change of velocity to have lasted a whole step of the grid.
    ///
    /// When rods stick or slip velocities jump within one step, however small it is. Inertia, which is among the forces
    /// that set the stiffness (Eq. 2.19), would grow as 1/h, contact get harder, and the next event need a
    /// smaller step still, down to the smallest.
    fn adapt_contact_stiffness(&mut self) {
        let last = self.history.moments[0].step;
        let lengthening = match self.parameters.step {
            StepSize::Fixed(whole) if self.system.rubs() && last > 0.0 => (whole / last).max(1.0),
            _ => 1.0,
        };
        let acceleration_step = self.stage.acceleration_step;
        self.stage.acceleration_step *= lengthening;
        self.system
            .adapt_contact_stiffness(&self.trial, Some(&self.stage));
        self.stage.acceleration_step = acceleration_step;
    }

    /// Extrapolates positions and angles to the implicit stage with the acceleration of the last step.
    fn predict(&mut self, stage_step: f64) {
        let fraction = match self.parameters.scheme {
            Scheme::ImplicitMidpoint => 0.5,
            Scheme::ImplicitEuler | Scheme::BackwardDifferences => 1.0,
        };
        let earlier = &self.history.moments[0];
        let growth = if earlier.step > 0.0 {
            fraction * stage_step / earlier.step
        } else {
            0.0
        };
        for k in 0..self.trial.len() {
            let change = self.velocity[k] - earlier.velocity[k];
            self.trial[k] = self.unknowns[k] + stage_step * (self.velocity[k] + growth * change);
        }
    }

    /// Finds the contact forces of complementarity at the trial; whether they move no node farther than
    /// `tolerance`, m.
    fn find_contact_forces(&mut self, tolerance: f64, iterations: usize) -> Result<bool, Failure> {
        match self.system.find_contact_forces(&self.trial, &self.stage) {
            Ok(correction) => Ok(correction <= tolerance),
            Err(_) => Err(self.no_contact_forces(iterations)),
        }
    }

    fn no_contact_forces(&self, iterations: usize) -> Failure {
        let (_, unknown) = self.system.worst_residual();
        Failure::Newton(Divergence {
            iterations,
            residual: f64::NAN,
            unknown,
        })
    }

    /// Shortens the predictor where it crosses a contact that must not be crossed, to rest if need be. Held
    /// unknowns stay as prescribed.
    fn shorten_predictor(&mut self) -> Result<(), Failure> {
        let free = self.system.largest_step(&self.unknowns, &self.trial);
        if free >= 1.0 {
            return Ok(());
        }
        for part in [PREDICTED_PART * free, 0.0] {
            for k in 0..self.trial.len() {
                if !self.system.assembly.held[k] {
                    self.trial[k] = self.unknowns[k] + part * (self.trial[k] - self.unknowns[k]);
                }
            }
            if self.system.largest_step(&self.unknowns, &self.trial) >= 1.0 {
                return Ok(());
            }
        }
        Err(Failure::Crossing {
            iterations: 0,
            what: "the prescribed motion of a clamp leads through a contact".into(),
        })
    }

    /// Writes the velocity at the end of a step and returns the local error of the positions, m:
    /// ½ h |v₁ − v₀| for implicit Euler; h/12 times the second difference of the velocity for the
    /// midpoint rule; H/4 times that from the predicted velocity for backward differences, at free unknowns.
    fn velocity_after(&mut self, step: f64) -> f64 {
        let earlier = &self.history.moments[0];
        let growth = if earlier.step > 0.0 {
            step / earlier.step
        } else {
            0.0
        };
        let mut error = 0.0;
        for k in 0..self.trial.len() {
            let mean = (self.trial[k] - self.unknowns[k]) / step;
            let (after, local) = match self.parameters.scheme {
                Scheme::ImplicitEuler => (mean, 0.5 * step * (mean - self.velocity[k])),
                Scheme::ImplicitMidpoint => {
                    // A prescribed motion has corners, across which reflection would ring.
                    let held = self.system.assembly.held[k];
                    let after = if held {
                        mean
                    } else {
                        2.0 * mean - self.velocity[k]
                    };
                    let earlier_change = growth * (self.velocity[k] - earlier.velocity[k]);
                    (
                        after,
                        step / 12.0 * (after - self.velocity[k] - earlier_change),
                    )
                }
                Scheme::BackwardDifferences => {
                    let after = (self.trial[k] - self.stage.start[k]) / self.stage.step;
                    let surprise = after - self.predicted_velocity[k];
                    let held = self.system.assembly.held[k];
                    (
                        after,
                        if held {
                            0.0
                        } else {
                            self.stage.step / 4.0 * surprise
                        },
                    )
                }
            };
            self.next_velocity[k] = after;
            if k % STRIDE != 3 {
                error = f64::max(error, local.abs());
            }
        }
        error
    }
}
