//! The time integration schemes, one file each: its equations, their derivation, and its guarantees.
//!
//! Every scheme solves one implicit stage per step, of the form that [`Stage`] states: velocities (q − q̂)/h and
//! accelerations (v − v̂)/hₐ, forces where the stage ends. A scheme defines where the stage starts, from what its solution is
//! predicted, and what follows from the solution for the end of the step and the error made in it.

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

/// A scheme of one implicit stage.
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

    /// Largest eigenvalue of D⁻¹ R, the resistance of a flow over its local part, for which a step may leave (R − D) (v − v₀)
    /// to the next one without ringing, where the least inertia of a node is `inertia` times D hₐ; 0 where it may not.
    fn largest_lagged_ratio(&self, inertia: f64) -> f64;

    /// Whether the first steps of a motion must be small, since the scheme needs earlier ones for its order.
    fn begins_small(&self) -> bool {
        false
    }

    /// Weights α₁ and α₂ of the last two steps in the difference that the stage of a step takes, for rates of strains:
    /// ε̂ = εₙ + α₁ (εₙ₋₁ − εₙ) + α₂ (εₙ₋₂ − εₙ).
    fn earlier_weights(&self, _step: f64, _state: &State, _turning: f64) -> [f64; 2] {
        [0.0; 2]
    }

    /// Farthest that an iteration of Newton's method may go at once, in radii of the thinnest rod.
    fn trust_radius(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether the end of the step lies beyond the solution of the stage: as far again.
    fn extrapolates(&self) -> bool {
        false
    }

    /// Sets up the stage of a step (s) from `state` with clamps that turn steadily by up to `turning` (rad/s), and
    /// the prediction of its solution.
    fn begin(
        &self,
        step: f64,
        state: &State,
        turning: f64,
        stage: &mut Stage,
        prediction: &mut Prediction,
    );

    /// Writes the velocity at the end of a step and returns the local error of the positions, m.
    fn finish(&self, solved: &SolvedStep, velocity: &mut [f64]) -> f64;
}

/// Prediction of the solution of a stage.
#[derive(Clone, Debug)]
pub(super) struct Prediction {
    /// Unknowns at the end of the stage; Newton's method starts here, and leaves its solution here.
    pub unknowns: Vec<f64>,
    /// Velocity at the end of the stage; only schemes that predict the drag write it.
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

    /// Writes velocity and local error of all unknowns as given by `of`; returns the largest error of a position, m.
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

/// Sets up a stage of `size` (s) that starts where the step does, and predicts its solution with the acceleration of the
/// last step, of which the part `fraction` of the stage's size is kept in the velocity.
fn begin_at_the_start(
    size: f64,
    fraction: f64,
    state: &State,
    stage: &mut Stage,
    prediction: &mut Prediction,
) {
    stage.step = size;
    stage.acceleration_step = size;
    stage.start.copy_from_slice(&state.unknowns);
    stage.velocity.copy_from_slice(&state.velocity);
    crate::mechanics::system::copy_positions(&state.unknowns, &mut stage.positions);
    let (last, growth) = state.history.last(fraction * size);
    for (k, predicted) in prediction.unknowns.iter_mut().enumerate() {
        let change = state.velocity[k] - last.velocity[k];
        *predicted = state.unknowns[k] + size * (state.velocity[k] + growth * change);
    }
}
