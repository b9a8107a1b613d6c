//! The time integration schemes, one file each: its equations, their derivation, and its guarantees.
//!
//! Every scheme solves one implicit stage per step, in the form that [`Stage`] states: velocities
//! (q − q̂)/h and accelerations (v − v̂)/hₐ, with forces at the end of the stage. A scheme defines
//! where the stage starts, how its solution is predicted, and how the end of the step and its
//! error follow from the solution.

mod backward_differences;
mod implicit_euler;
mod implicit_midpoint;
#[cfg(test)]
mod lag_tests;
#[cfg(test)]
mod order_tests;

use super::parameters::Scheme;
use super::state::State;
use super::step_control::ErrorLaw;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::Stage;
use backward_differences::BackwardDifferences;
use implicit_euler::ImplicitEuler;
use implicit_midpoint::ImplicitMidpoint;

pub(super) use backward_differences::largest_step;

/// A time integration scheme with one implicit stage.
pub(super) trait TimeScheme {
    /// Order of the local error in the step, and the growth allowed to automatic steps.
    fn error_law(&self) -> ErrorLaw;

    /// Time at which the stage of a step from `start` to `goal` is solved, s.
    fn stage_time(&self, _start: f64, goal: f64) -> f64 {
        goal
    }

    /// Whether the drag of a fluid is that of the predicted motion; otherwise it is that at the start of the step.
    fn predicts_drag(&self) -> bool {
        false
    }

    /// Largest eigenvalue of D⁻¹ R, the resistance of a flow over its local part, up to which a
    /// step may leave (R − D) (v − v₀) to the next step without ringing; 0 if it never may. The
    /// least inertia of a node is `inertia` times D hₐ.
    fn largest_lagged_ratio(&self, inertia: f64) -> f64;

    /// Factor α, at least 1, for which a step with α D in place of D may leave the rest of the
    /// drag, (R − α D) (v − v₀), to the next step. `ratio` is the largest eigenvalue of D⁻¹ R, and
    /// the least inertia of a node is `inertia` times D hₐ. `None` if there is no such factor, or if
    /// the rest would cost accuracy.
    fn lagged_factor(&self, ratio: f64, inertia: f64) -> Option<f64> {
        (ratio <= self.largest_lagged_ratio(inertia)).then_some(1.0)
    }

    /// Whether the first steps of a motion must be small, because the scheme needs earlier steps
    /// for its order.
    fn begins_small(&self) -> bool {
        false
    }

    /// Weights α₁ and α₂ of the last two steps in the difference quotient of the stage, for strain
    /// rates: ε̂ = εₙ + α₁ (εₙ₋₁ − εₙ) + α₂ (εₙ₋₂ − εₙ).
    fn earlier_weights(&self, _step: f64, _state: &State, _turning: f64) -> [f64; 2] {
        [0.0; 2]
    }

    /// Largest move of an iteration of Newton's method, in radii of the thinnest rod.
    fn trust_radius(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether the end of the step is extrapolated to twice the distance of the solution of the
    /// stage.
    fn extrapolates(&self) -> bool {
        false
    }

    /// Sets up the stage of a step (s) from `state` and predicts its solution; clamps rotate
    /// steadily by up to `turning` (rad/s).
    fn begin(
        &self,
        step: f64,
        state: &State,
        turning: f64,
        stage: &mut Stage,
        prediction: &mut Prediction,
    );

    /// Computes the velocity at the end of a step and returns the local error of the positions, m.
    fn finish(&self, solved: &SolvedStep, velocity: &mut [f64]) -> f64;
}

/// Prediction of the solution of a stage.
#[derive(Clone, Debug)]
pub(super) struct Prediction {
    /// Unknowns at the end of the stage: the start of Newton's method, then its solution.
    pub unknowns: Vec<f64>,
    /// Velocity at the end of the stage; written only by schemes that predict the drag.
    pub velocity: Vec<f64>,
}

/// A step whose stage is solved.
pub(super) struct SolvedStep<'a> {
    /// Size, s.
    pub step: f64,
    /// Where it starts.
    pub state: &'a State,
    /// Its stage.
    pub stage: &'a Stage,
    /// Unknowns where it ends.
    pub end: &'a [f64],
    /// Velocity that was predicted.
    pub predicted_velocity: &'a [f64],
    /// Unknowns that are prescribed.
    pub held: &'a [bool],
}

impl SolvedStep<'_> {
    /// Mean velocity of an unknown.
    fn mean_velocity(&self, unknown: usize) -> f64 {
        (self.end[unknown] - self.state.unknowns[unknown]) / self.step
    }

    /// Sets velocity and local error of all unknowns as computed by `of`; returns the largest
    /// error of a position, m.
    fn fill(&self, velocity: &mut [f64], of: impl Fn(usize) -> (f64, f64)) -> f64 {
        let mut worst = 0.0;
        for (k, velocity) in velocity.iter_mut().enumerate() {
            let error;
            (*velocity, error) = of(k);
            if k % STRIDE != 3 {
                worst = f64::max(worst, error.abs());
            }
        }
        worst
    }
}

impl Scheme {
    /// The scheme's rules.
    pub(super) fn rules(self) -> &'static dyn TimeScheme {
        match self {
            Self::ImplicitEuler => &ImplicitEuler,
            Self::ImplicitMidpoint => &ImplicitMidpoint,
            Self::BackwardDifferences => &BackwardDifferences,
        }
    }
}

/// Sets up a stage of `size` (s) that starts where the step does. Predicts its solution with the
/// acceleration of the last step; the predicted velocity uses it for the fraction `fraction` of
/// `size`.
fn begin_at_the_start(
    size: f64,
    fraction: f64,
    state: &State,
    stage: &mut Stage,
    prediction: &mut Prediction,
) {
    stage.step = size;
    stage.acceleration_step = size;
    stage.keeps_spin = false;
    stage.start.copy_from_slice(&state.unknowns);
    stage.velocity.copy_from_slice(&state.velocity);
    stage.start_at(&state.unknowns);
    let (last, growth) = state.history.last(fraction * size);
    for (k, predicted) in prediction.unknowns.iter_mut().enumerate() {
        let change = state.velocity[k] - last.velocity[k];
        *predicted = state.unknowns[k] + size * (state.velocity[k] + growth * change);
    }
}
