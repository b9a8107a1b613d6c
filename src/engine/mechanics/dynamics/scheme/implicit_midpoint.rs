//! The implicit midpoint rule, the Gauss method of one stage (Hairer, Lubich & Wanner, Geometric Numerical Integration,
//! sec. II.1).
//!
//! Positions and velocities advance with the derivatives in the middle of the step:
//!
//! ```text
//! qₙ₊₁ = qₙ + h v_m,   vₙ₊₁ = vₙ + h M⁻¹ F(q_m, v_m),   q_m = ½ (qₙ + qₙ₊₁),   v_m = ½ (vₙ + vₙ₊₁)
//! ```
//!
//! Since q_m − qₙ = ½ h v_m and v_m − vₙ = ½ h M⁻¹ F_m, the middle is the end of a step of
//! implicit Euler of size h/2: M ((q_m − qₙ)/(h/2) − vₙ)/(h/2) = F(q_m, v_m). The end of the step
//! is extrapolated: qₙ₊₁ = 2 q_m − qₙ, vₙ₊₁ = 2 v_m − vₙ.
//!
//! **Order two.** The rule is symmetric, so that only even powers of h remain in the error after
//! many steps. The error of one step in q is h³ q⃛/12, as for the trapezoidal rule for ∫ v dt; the
//! error of v adds a term of fourth order. The error is estimated from the last two steps: h/12
//! times the second difference of the velocity.
//!
//! **Conservation.** Quadratic invariants are conserved exactly: momentum, angular momentum, and
//! in linear problems energy. Otherwise the energy oscillates about a value near the true one if
//! steps resolve the motion; if they do not, it may grow, since the scheme has no damping: |(1 +
//! iωh/2)/(1 − iωh/2)| = 1. Jumps cause ringing: velocities of modes that the step does not
//! resolve change their sign from step to step, without decay.
//!
//! **Drag of a flow.** With the drag at the start of the step, implicit in its local part D, a step of inertia M multiplies v by
//! 1 − 2 (M/hₐ + D)⁻¹ R, with the stage's hₐ = h/2: it grows from R = M/hₐ + D on.
//!
//! Prescribed unknowns have the mean velocity of the step: a motion with corners, reflected at
//! v_m, would ring without end.

use super::{Prediction, SolvedStep, TimeScheme, begin_at_the_start};
use crate::mechanics::dynamics::state::State;
use crate::mechanics::dynamics::step_control::ErrorLaw;
use crate::mechanics::system::Stage;

pub(super) struct ImplicitMidpoint;

impl TimeScheme for ImplicitMidpoint {
    fn error_law(&self) -> ErrorLaw {
        ErrorLaw {
            order: 3,
            largest_growth: 1.5,
        }
    }

    fn stage_time(&self, start: f64, goal: f64) -> f64 {
        start + 0.5 * (goal - start)
    }

    fn largest_lagged_ratio(&self, inertia: f64) -> f64 {
        1.0 + inertia
    }

    fn extrapolates(&self) -> bool {
        true
    }

    fn begin(
        &self,
        step: f64,
        state: &State,
        _turning: f64,
        stage: &mut Stage,
        prediction: &mut Prediction,
    ) {
        begin_at_the_start(0.5 * step, 0.5, state, stage, prediction);
    }

    fn finish(&self, solved: &SolvedStep, velocity: &mut [f64]) -> f64 {
        let (step, state) = (solved.step, solved.state);
        let (last, growth) = state.history.last(step);
        solved.fill(velocity, |k| {
            let mean = solved.mean_velocity(k);
            let before = state.velocity[k];
            let after = if solved.held[k] {
                mean
            } else {
                2.0 * mean - before
            };
            let earlier_change = growth * (before - last.velocity[k]);
            (after, step / 12.0 * (after - before - earlier_change))
        })
    }
}
