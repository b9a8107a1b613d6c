//! Backward differences over two steps (BDF2, Gear 1971) in the form of an implicit Euler stage.
//!
//! The derivative at the end of a step h of the parabola through the last three points is
//!
//! ```text
//! q̇ = (q − q̂)/H,   H = h (1 + r)/(1 + 2r),   q̂ = qₙ + r²/(1 + 2r) (qₙ − qₙ₋₁),   r = h/hₙ
//! ```
//!
//! with the size hₙ of the step before. So positions and velocities advance by an Euler stage of size H from q̂ and
//! v̂. It is of second order, damps what is faster than the step (unlike the midpoint rule, which makes it ring),
//! and has contact and elasticity where the step ends.
//!
//! The drag is that of the predicted motion, q̂ + H v* with v* = vₙ + r (vₙ − vₙ₋₁), and implicit in each node's own
//! velocity: its error is of second order as well, for one solution of the fluid per step.

use super::Simulation;
use super::report::SimulationError;
use crate::mechanics::rod::topology::position;
use crate::mechanics::system::copy_positions;

/// Growth of the step from which on a step is one of implicit Euler: two-step differences are stable below 1 + √2.
const LARGEST_GROWTH: f64 = 2.0;

/// The stage of a step, see above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BackwardDifference {
    /// H, s.
    pub stage_step: f64,
    /// r²/(1 + 2r), weight of the last change in q̂.
    pub weight: f64,
}

impl BackwardDifference {
    /// For a step after `earlier_step` (0: there is none), both in s.
    pub fn new(step: f64, earlier_step: f64) -> Self {
        if step > LARGEST_GROWTH * earlier_step {
            return Self {
                stage_step: step,
                weight: 0.0,
            };
        }
        let growth = step / earlier_step;
        Self {
            stage_step: step * (1.0 + growth) / (1.0 + 2.0 * growth),
            weight: growth * growth / (1.0 + 2.0 * growth),
        }
    }
}

impl Simulation {
    pub(super) fn backward_difference(&self, step: f64) -> BackwardDifference {
        BackwardDifference::new(step, self.earlier_step)
    }

    /// Writes q̂ and v̂ where the stage has what it starts from.
    pub(super) fn start_backward_difference(&mut self, step: f64) {
        let weight = self.backward_difference(step).weight;
        let stage = &mut self.stage;
        for k in 0..self.unknowns.len() {
            stage.start[k] += weight * (self.unknowns[k] - self.earlier_unknowns[k]);
            stage.velocity[k] += weight * (self.velocity[k] - self.earlier_velocity[k]);
        }
        copy_positions(&stage.start, &mut stage.positions);
    }

    /// Drag and local resistance of the predicted motion, that of the trial; returns the Krylov iterations.
    pub(super) fn compute_predicted_drag(&mut self) -> Result<usize, SimulationError> {
        if self.fluid.is_none() {
            return Ok(0);
        }
        let per_step = 1.0 / self.stage.step;
        for node in 0..self.positions.len() {
            let predicted = position(&self.trial, node);
            self.velocities[node] = (predicted - self.stage.positions[node]) * per_step;
            self.positions[node] = predicted;
        }
        let result = self.compute_drag();
        // A step that fails must leave what observers read.
        self.publish();
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_exact_for_parabolas_and_uneven_steps() {
        let parabola = |time: f64| 3.0 - 2.0 * time + 0.7 * time * time;
        for (earlier_step, step) in [(0.1, 0.1), (0.1, 0.19), (0.1, 0.02)] {
            let now = 0.4;
            let difference = BackwardDifference::new(step, earlier_step);
            let start =
                parabola(now) + difference.weight * (parabola(now) - parabola(now - earlier_step));
            let slope = (parabola(now + step) - start) / difference.stage_step;
            assert!((slope - (1.4 * (now + step) - 2.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_first_step_and_one_that_grows_too_much_are_of_implicit_euler() {
        for earlier_step in [0.0, 0.04] {
            let difference = BackwardDifference::new(0.1, earlier_step);
            assert_eq!((difference.stage_step, difference.weight), (0.1, 0.0));
        }
    }
}
