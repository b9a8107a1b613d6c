//! Implicit Euler, the scheme of the thesis (Eq. 1.8).
//!
//! Positions and velocities advance by the derivatives where the step ends:
//!
//! ```text
//! qₙ₊₁ = qₙ + h vₙ₊₁,     vₙ₊₁ = vₙ + h M⁻¹ F(qₙ₊₁, vₙ₊₁)
//! ```
//!
//! Eliminating vₙ₊₁ leaves M ((q − qₙ)/h − vₙ)/h = F(q, (q − qₙ)/h), one system for q = qₙ₊₁.
//!
//! **Order one.** Taylor's theorem about the end of the step gives qₙ = qₙ₊₁ − h q̇ₙ₊₁ + ½ h² q̈ − ..., so a step errs by
//! ½ h² q̈, which is estimated as ½ h (vₙ₊₁ − vₙ), and n = t/h steps by O(h).
//!
//! **Damping.** On q̈ + ω² q = 0 a step multiplies the amplitude by 1/√(1 + ω²h²) < 1 for every h: unconditionally
//! stable, and fast modes vanish (L-stable). In each step ½ ‖vₙ₊₁ − vₙ‖²_M and the like of the elastic energy are lost; a
//! motion of period T keeps the part exp(−2π² h t/T²) of its amplitude. A velocity that jumps, as in an impact, or as rods
//! begin to stick, is taken as it is: no other scheme here does that without ringing, which is why contact by
//! complementarity needs this one.
//!
//! **Drag of a flow.** With the drag −R vₙ at the start of the step, implicit in its local part D, a step of inertia M takes
//! v to (M/h + D)⁻¹ (M/h + D − R) v: it rings, and grows, from R = 2 (M/h + D) on.

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
    }

    fn finish(&self, solved: &SolvedStep, velocity: &mut [f64]) -> f64 {
        solved.fill(velocity, |k| {
            let mean = solved.mean_velocity(k);
            (mean, 0.5 * solved.step * (mean - solved.state.velocity[k]))
        })
    }
}
