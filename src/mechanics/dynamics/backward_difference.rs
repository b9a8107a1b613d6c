//! Backward differences over two steps that are exact for steady turning (Gautschi 1961), in the form of an implicit
//! Euler stage.
//!
//! The derivative at the end of a step h of the function a + b cos ωt + c sin ωt through the last three points is
//!
//! ```text
//! q̇ = (q − q̂)/H,   H = S₁ S₀ S/(S² − S₁²),   q̂ = qₙ + S₁²/(S² − S₁²) (qₙ − qₙ₋₁)
//! S₁ = S(h),   S₀ = S(h₀),   S = S(h₀ + h),   S(t) = (2/ω) sin(ωt/2)
//! ```
//!
//! with the size h₀ of the step before. For ω = 0, where S(t) = t, this is the usual formula BDF2 (Gear 1971).
//! So positions and velocities advance by an Euler stage of size H from q̂ and v̂. It is of second order, damps
//! what is faster than the step (unlike the midpoint rule, which makes it ring), and has contact and elasticity where
//! the step ends.
//!
//! The drag is that of the predicted motion q̂ + H v*, implicit in each node's own velocity, with the velocity
//!
//! ```text
//! v* = (vₙ sin ω(h₀ + h) − vₙ₋₁ sin ωh)/sin ωh₀,   for ω = 0: vₙ + (h/h₀) (vₙ − vₙ₋₁)
//! ```
//!
//! so that its error is of second order as well, for one solution of the fluid per step. Rods on clamps that turn
//! steadily move like a sum of turning with their ω and something slow: of both nothing is lost to first order, of
//! the turning nothing at all, while BDF2 gets its speed wrong by (ωh)²/3.

use super::Simulation;
use super::report::SimulationError;
use crate::mechanics::rod::topology::position;
use crate::mechanics::system::copy_positions;

/// Growth of the step from which on a step is one of implicit Euler: two-step differences are stable below 1 + √2.
const LARGEST_GROWTH: f64 = 2.0;

/// Largest angle ω(h₀ + h) that is fitted, rad. What turns faster than the steps resolve is not followed but damped.
const LARGEST_ANGLE: f64 = 1.0;

/// The stage of a step and its predictor, see above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BackwardDifference {
    /// H, s.
    pub stage_step: f64,
    /// Weight of the last change in q̂ and v̂.
    pub weight: f64,
    /// Weights of the last velocity and of the one before in v*.
    pub velocity_weights: [f64; 2],
}

impl BackwardDifference {
    /// For a step after `earlier_step` (0: there is none), both in s, and turning with ω in rad/s.
    pub fn new(step: f64, earlier_step: f64, turning: f64) -> Self {
        if step > LARGEST_GROWTH * earlier_step {
            return Self {
                stage_step: step,
                weight: 0.0,
                velocity_weights: [1.0, 0.0],
            };
        }
        let both = earlier_step + step;
        let turning = turning.min(LARGEST_ANGLE / both);
        let sine = |time: f64| {
            if turning > 0.0 {
                (turning * time).sin() / turning
            } else {
                time
            }
        };
        let chord = |time: f64| 2.0 * sine(0.5 * time);
        let difference = chord(both).powi(2) - chord(step).powi(2);
        Self {
            stage_step: chord(step) * chord(earlier_step) * chord(both) / difference,
            weight: chord(step).powi(2) / difference,
            velocity_weights: [
                sine(both) / sine(earlier_step),
                -sine(step) / sine(earlier_step),
            ],
        }
    }

    /// v* from the last velocity and the one before.
    pub fn predicted(&self, velocity: f64, earlier_velocity: f64) -> f64 {
        self.velocity_weights[0] * velocity + self.velocity_weights[1] * earlier_velocity
    }
}

impl Simulation {
    /// Writes the start q̂, v̂ of the stage of a step and, to the trial, the predicted motion.
    pub(super) fn begin_backward_difference(&mut self, step: f64) {
        let turning = self.system.assembly.steady_turning();
        let difference = BackwardDifference::new(step, self.earlier_step, turning);
        let stage = &mut self.stage;
        stage.step = difference.stage_step;
        for k in 0..self.unknowns.len() {
            let (velocity, earlier_velocity) = (self.velocity[k], self.earlier_velocity[k]);
            let change = self.unknowns[k] - self.earlier_unknowns[k];
            stage.start[k] = self.unknowns[k] + difference.weight * change;
            stage.velocity[k] = velocity + difference.weight * (velocity - earlier_velocity);
            self.predicted_velocity[k] = difference.predicted(velocity, earlier_velocity);
            self.trial[k] = stage.start[k] + stage.step * self.predicted_velocity[k];
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

    /// Largest errors of derivative and predicted velocity for a function and its derivative.
    fn errors(turning: f64, function: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> [f64; 2] {
        let mut worst = [0.0_f64; 2];
        for (earlier_step, step) in [(0.1, 0.1), (0.1, 0.19), (0.1, 0.02)] {
            let (now, end) = (0.4, 0.4 + step);
            let earlier = now - earlier_step;
            let difference = BackwardDifference::new(step, earlier_step, turning);
            let start = function(now) + difference.weight * (function(now) - function(earlier));
            let found = (function(end) - start) / difference.stage_step;
            let predicted = difference.predicted(slope(now), slope(earlier));
            worst[0] = worst[0].max((found - slope(end)).abs());
            worst[1] = worst[1].max((predicted - slope(end)).abs());
        }
        worst
    }

    #[test]
    fn without_turning_parabolas_are_exact() {
        let worst = errors(0.0, |t| 3.0 - 2.0 * t + 0.7 * t * t, |t| 1.4 * t - 2.0);
        assert!(worst.iter().all(|&error| error < 1e-12), "{worst:?}");
    }

    #[test]
    fn steady_turning_is_exact() {
        let worst = errors(
            3.0,
            |t| 1.0 + 2.0 * (3.0 * t).sin() - 0.5 * (3.0 * t).cos(),
            |t| 6.0 * (3.0 * t).cos() + 1.5 * (3.0 * t).sin(),
        );
        assert!(worst.iter().all(|&error| error < 1e-12), "{worst:?}");
    }

    #[test]
    fn the_first_step_and_one_that_grows_too_much_are_of_implicit_euler() {
        for earlier_step in [0.0, 0.04] {
            let difference = BackwardDifference::new(0.1, earlier_step, 15.0);
            assert_eq!((difference.stage_step, difference.weight), (0.1, 0.0));
            assert_eq!(difference.velocity_weights, [1.0, 0.0]);
        }
    }
}
