//! Implicit Euler, the scheme of the thesis (Eq. 1.8).
//!
//! Positions and velocities advance with the derivatives at the end of the step:
//!
//! ```text
//! qₙ₊₁ = qₙ + h vₙ₊₁,     vₙ₊₁ = vₙ + h M⁻¹ F(qₙ₊₁, vₙ₊₁)
//! ```
//!
//! Eliminating vₙ₊₁ leaves M ((q − qₙ)/h − vₙ)/h = F(q, (q − qₙ)/h), one system for q = qₙ₊₁.
//!
//! **Order one.** Taylor's theorem about the end of the step gives qₙ = qₙ₊₁ − h q̇ₙ₊₁ + ½ h² q̈ −
//! .... So the error of a step is ½ h² q̈, which is estimated as ½ h (vₙ₊₁ − vₙ), and that of n =
//! t/h steps is O(h).
//!
//! **Damping.** On q̈ + ω² q = 0 a step multiplies the amplitude by 1/√(1 + ω²h²) < 1 for every h:
//! unconditionally stable, and fast modes vanish (L-stable). Each step loses ½ ‖vₙ₊₁ − vₙ‖²_M and
//! a similar amount of elastic energy; a motion of period T keeps the fraction exp(−2π² h t/T²) of
//! its amplitude. The scheme accepts a jump of the velocity, as in an impact or at the onset of
//! sticking. No other scheme here does so without ringing, which is why contact by complementarity
//! needs this one.
//!
//! **Drag of a flow.** With the drag −R vₙ at the start of the step, implicit in its local part D,
//! a step of inertia M takes v to (M/h + D)⁻¹ (M/h + D − R) v: from R = 2 (M/h + D) on it rings
//! and grows.

use super::{Prediction, SolvedStep, TimeScheme, begin_at_the_start};
use crate::mechanics::dynamics::state::State;
use crate::mechanics::dynamics::step_control::ErrorLaw;
use crate::mechanics::system::Stage;

pub(super) struct ImplicitEuler;

impl TimeScheme for ImplicitEuler {
    fn error_law(&self) -> ErrorLaw {
        ErrorLaw {
            order: 2,
            largest_growth: 1.5,
        }
    }

    fn largest_lagged_ratio(&self, inertia: f64) -> f64 {
        2.0 * (1.0 + inertia)
    }

    fn begin(
        &self,
        step: f64,
        state: &State,
        _turning: f64,
        stage: &mut Stage,
        prediction: &mut Prediction,
    ) {
        begin_at_the_start(step, 1.0, state, stage, prediction);
        stage.keeps_spin = true;
    }

    fn finish(&self, solved: &SolvedStep, velocity: &mut [f64]) -> f64 {
        solved.fill(velocity, |k| {
            let mean = solved.mean_velocity(k);
            (mean, 0.5 * solved.step * (mean - solved.state.velocity[k]))
        })
    }
}
