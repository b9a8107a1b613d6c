//! Backward differences that are exact for steady turning (Gautschi 1961), in the form of an implicit Euler stage.
//!
//! The velocity at the end of a step h is the derivative of the function a + b t + c cos ωt + d sin ωt through the
//! last four points, the acceleration that of a + c cos ωt + d sin ωt through the last three velocities:
//!
//! ```text
//! q̇ = (q − q̂)/H,     q̂ = qₙ + α₁ (qₙ₋₁ − qₙ) + α₂ (qₙ₋₂ − qₙ)
//! v̇ = (v − v̂)/Hₐ,    v̂ = vₙ + S₁²/(S² − S₁²) (vₙ − vₙ₋₁),   Hₐ = S₁ S₀ S/(S² − S₁²)
//! S₁ = S(h),   S₀ = S(h₀),   S = S(h₀ + h),   S(t) = (2/ω) sin(ωt/2)
//! ```
//!
//! with the size h₀ of the step before. For ω = 0, where S(t) = t, these are BDF3 and BDF2 (Gear 1971). Differences of
//! third order alone would feed oscillations that no drag damps (they are not A-stable); with an acceleration of second
//! order they damp all of them, and what is of second order is but the inertia of a motion other than turning, which is
//! small where drag rules. So positions and velocities advance by an Euler stage of size H from q̂ and v̂. Contact and
//! elasticity are those where the step ends.
//!
//! The drag is that of the predicted motion q̂ + H v*, implicit in each node's own velocity, with the velocity v*
//! extrapolated by a + c cos ωt + d sin ωt from the last three: of third order as well, for one solution of the fluid
//! per step.
//!
//! Rods on clamps that turn steadily move like a sum of turning with their ω and something slow: BDF3 would get the
//! speed of the turning wrong by (ωh)³/4, fitted differences do not.

use super::Simulation;
use super::report::SimulationError;
use crate::mechanics::rod::topology::position;
use crate::mechanics::system::copy_positions;
use crate::mechanics::{Matrix3, Vector3};

/// Growth of the step up to which differences of second and third order are stable: 1 + √2 and 1.53 (Calvo, Grande and
/// Grigorieff 1990). Beyond the first a step is one of implicit Euler.
const LARGEST_GROWTHS: [f64; 2] = [2.1, 1.51];

/// Largest angle ω(h₋₁ + h₀ + h) that is fitted, rad. What turns faster than the steps resolve is not followed but
/// damped.
const LARGEST_ANGLE: f64 = 1.0;

/// Least number of steps, chosen by the error, in which a clamp turns once. The error of each step stands for that of
/// many: where bundled flagella bear on each other, what larger steps lose adds up.
const STEPS_PER_TURN: f64 = 200.0;

/// Largest step that the error may choose where clamps turn with ω, s.
pub(super) fn largest_step(turning: f64) -> f64 {
    std::f64::consts::TAU / (STEPS_PER_TURN * turning)
}

/// The stage of a step and its predictor, see above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BackwardDifference {
    /// H, s.
    pub step: f64,
    /// α₁ and α₂.
    pub weights: [f64; 2],
    /// Hₐ, s.
    pub acceleration_step: f64,
    /// Weight of vₙ₋₁ − vₙ in v̂.
    pub acceleration_weight: f64,
    /// Weights of the last three velocities in v*.
    pub velocity_weights: [f64; 3],
}

impl BackwardDifference {
    /// For a step after others, the last first (0: there is none), all in s, and turning with ω in rad/s.
    pub fn new(step: f64, earlier: [f64; 2], turning: f64) -> Self {
        let [second, third] = LARGEST_GROWTHS;
        if step > second * earlier[0] {
            return Self {
                step,
                weights: [0.0; 2],
                acceleration_step: step,
                acceleration_weight: 0.0,
                velocity_weights: [1.0, 0.0, 0.0],
            };
        }
        let times = [step, step + earlier[0], step + earlier[0] + earlier[1]];
        let turning = Turning {
            rate: turning.min(LARGEST_ANGLE / times[2]),
        };
        let fitted = Self::of_second_order(times[0], times[1], turning);
        if step > third * earlier[0] || earlier[0] > third * earlier[1] {
            fitted
        } else {
            fitted.with_third_order(&times, turning)
        }
    }

    /// Through points at the times `last` and `before` ahead of the end of the step.
    fn of_second_order(last: f64, before: f64, turning: Turning) -> Self {
        let [one, both, between] = [last, before, before - last].map(|time| turning.chord(time));
        let difference = both * both - one * one;
        let (step, weight) = (one * between * both / difference, -one * one / difference);
        Self {
            step,
            weights: [weight, 0.0],
            acceleration_step: step,
            acceleration_weight: weight,
            velocity_weights: [
                turning.sine(before) / turning.sine(before - last),
                -turning.sine(last) / turning.sine(before - last),
                0.0,
            ],
        }
    }

    /// The same with velocities of third order, through a point more.
    fn with_third_order(self, times: &[f64; 3], turning: Turning) -> Self {
        // Each column holds the functions at one point, all zero at the end of the step.
        let columns = |functions: fn(Turning, f64) -> [f64; 3]| {
            Matrix3::from_columns(&times.map(|time| Vector3::from(functions(turning, time))))
        };
        let slopes = columns(|turning, t| [-t, turning.versine(t), turning.lag(t)]);
        let values = columns(|turning, t| [1.0, turning.sine(t), turning.versine(t)]);
        let solved = slopes.lu().solve(&Vector3::x());
        let (Some(derivative), Some(extrapolation)) = (solved, values.lu().solve(&Vector3::x()))
        else {
            return self;
        };
        let sum = derivative.sum();
        Self {
            step: -1.0 / sum,
            weights: [derivative.y / sum, derivative.z / sum],
            velocity_weights: extrapolation.into(),
            ..self
        }
    }

    /// v* from the last three velocities.
    pub fn predicted(&self, velocities: [f64; 3]) -> f64 {
        let products = self.velocity_weights.iter().zip(velocities);
        products.map(|(weight, velocity)| weight * velocity).sum()
    }
}

/// Functions of a turning motion that tend to polynomials where it is slow.
#[derive(Clone, Copy)]
struct Turning {
    /// ω, rad/s.
    rate: f64,
}

impl Turning {
    /// sin(ωt)/ω, t for ω = 0.
    fn sine(self, time: f64) -> f64 {
        if self.rate > 0.0 {
            (self.rate * time).sin() / self.rate
        } else {
            time
        }
    }

    /// S(t) = (2/ω) sin(ωt/2), t for ω = 0.
    fn chord(self, time: f64) -> f64 {
        2.0 * self.sine(0.5 * time)
    }

    /// (1 − cos ωt)/ω², t²/2 for ω = 0.
    fn versine(self, time: f64) -> f64 {
        0.5 * self.chord(time).powi(2)
    }

    /// (ωt − sin ωt)/ω³, t³/6 for ω = 0.
    fn lag(self, time: f64) -> f64 {
        let square = (self.rate * time).powi(2);
        // Four terms of the series: its remainder is below rounding error for the angles that are fitted.
        let series = 1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0));
        if square < 0.01 {
            time.powi(3) / 6.0 * series
        } else {
            (time - self.sine(time)) / self.rate.powi(2)
        }
    }
}

impl Simulation {
    /// Writes the start q̂, v̂ of the stage of a step and, to the trial, the predicted motion.
    pub(super) fn begin_backward_difference(&mut self, step: f64) {
        let turning = self.system.assembly.steady_turning();
        let [last, before] = &self.history.moments;
        let difference = BackwardDifference::new(step, [last.step, before.step], turning);
        let stage = &mut self.stage;
        stage.step = difference.step;
        stage.acceleration_step = difference.acceleration_step;
        for k in 0..self.unknowns.len() {
            let velocities = [self.velocity[k], last.velocity[k], before.velocity[k]];
            let [first, second] =
                [last, before].map(|moment| moment.unknowns[k] - self.unknowns[k]);
            stage.start[k] =
                self.unknowns[k] + difference.weights[0] * first + difference.weights[1] * second;
            stage.velocity[k] =
                velocities[0] + difference.acceleration_weight * (velocities[1] - velocities[0]);
            self.predicted_velocity[k] = difference.predicted(velocities);
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
    use nalgebra::{Complex, DMatrix};

    /// Largest errors of velocity, acceleration and predicted velocity for functions and their derivatives.
    fn errors(
        turning: f64,
        [place, velocity, acceleration]: [fn(f64) -> f64; 3],
        steps: [[f64; 2]; 4],
    ) -> [f64; 3] {
        let mut worst = [0.0_f64; 3];
        for [earlier_step, step] in steps {
            let (now, end) = (0.4, 0.4 + step);
            let times = [now, now - earlier_step, now - earlier_step - 0.1];
            let difference = BackwardDifference::new(step, [earlier_step, 0.1], turning);
            let [q, v] = [place, velocity].map(|function| times.map(function));
            let start = q[0]
                + difference.weights[0] * (q[1] - q[0])
                + difference.weights[1] * (q[2] - q[0]);
            let from = v[0] + difference.acceleration_weight * (v[1] - v[0]);
            let found = [
                (place(end) - start) / difference.step - velocity(end),
                (velocity(end) - from) / difference.acceleration_step - acceleration(end),
                difference.predicted(v) - velocity(end),
            ];
            for (worst, error) in worst.iter_mut().zip(found) {
                *worst = worst.max(error.abs());
            }
        }
        worst
    }

    #[test]
    fn without_turning_cubic_motion_is_exact() {
        let worst = errors(
            0.0,
            [
                |t| 3.0 - 2.0 * t + 0.7 * t * t + 0.4 * t * t * t,
                |t| 1.2 * t * t + 1.4 * t - 2.0,
                |t| 2.4 * t + 1.4,
            ],
            [[0.1, 0.1], [0.1, 0.14], [0.1, 0.02], [0.07, 0.1]],
        );
        assert!(worst.iter().all(|&error| error < 1e-12), "{worst:?}");
    }

    #[test]
    fn steady_turning_and_drift_are_exact() {
        let motion: [fn(f64) -> f64; 3] = [
            |t| 1.0 + 0.6 * t + 2.0 * (3.0 * t).sin() - 0.5 * (3.0 * t).cos(),
            |t| 0.6 + 6.0 * (3.0 * t).cos() + 1.5 * (3.0 * t).sin(),
            |t| -18.0 * (3.0 * t).sin() + 4.5 * (3.0 * t).cos(),
        ];
        let worst = errors(
            3.0,
            motion,
            [[0.1, 0.1], [0.1, 0.13], [0.1, 0.02], [0.07, 0.1]],
        );
        assert!(worst.iter().all(|&error| error < 1e-11), "{worst:?}");
    }

    #[test]
    fn steps_that_grow_lower_the_order() {
        let order = |earlier, step| {
            let difference = BackwardDifference::new(step, earlier, 0.0);
            1 + difference
                .weights
                .iter()
                .filter(|&&weight| weight != 0.0)
                .count()
        };
        assert_eq!(order([0.0, 0.0], 0.1), 1);
        assert_eq!(order([0.04, 0.04], 0.1), 1);
        assert_eq!(order([0.05, 0.05], 0.1), 2);
        assert_eq!(order([0.1, 0.0], 0.1), 2);
        assert_eq!(order([0.1, 0.05], 0.1), 2);
        assert_eq!(order([0.08, 0.08], 0.1), 3);
        assert_eq!(order([0.1, 0.1], 0.01), 3);
    }

    /// Spectral radius of a step of q̈ + c q̇ + ω² q = 0 over (qₙ, qₙ₋₁, qₙ₋₂, vₙ, vₙ₋₁).
    fn amplification(step: f64, frequency: f64, damping: f64) -> f64 {
        let difference = BackwardDifference::new(step, [step; 2], 0.0);
        let [first, second] = difference.weights;
        let start = [1.0 - first - second, first, second, 0.0, 0.0];
        let weight = difference.acceleration_weight;
        let from = [0.0, 0.0, 0.0, 1.0 - weight, weight];
        let (h, a) = (difference.step, difference.acceleration_step);
        // ((q − q̂)/h − v̂)/a + c (q − q̂)/h + ω² q = 0.
        let diagonal = 1.0 / (h * a) + damping / h + frequency * frequency;
        let mut matrix = DMatrix::<f64>::zeros(5, 5);
        for k in 0..5 {
            let q = (start[k] * (1.0 / (h * a) + damping / h) + from[k] / a) / diagonal;
            matrix[(0, k)] = q;
            matrix[(3, k)] = (q - start[k]) / h;
        }
        for (row, column) in [(1, 0), (2, 1), (4, 3)] {
            matrix[(row, column)] = 1.0;
        }
        let roots: Vec<Complex<f64>> = matrix.complex_eigenvalues().iter().copied().collect();
        roots.iter().map(|root| root.norm()).fold(0.0, f64::max)
    }

    #[test]
    fn no_oscillation_is_fed() {
        for decade in -20..=30 {
            let frequency = 10f64.powf(0.1 * f64::from(decade));
            for damping in [0.0, 0.01, 0.1, 1.0, 10.0, 1e3] {
                let radius = amplification(1.0, frequency, damping);
                // Five roots of a matrix are found to about the fifth root of rounding error where they meet.
                assert!(
                    radius < 1.0 + 1e-6,
                    "ω = {frequency}, c = {damping}: {radius}"
                );
            }
        }
        assert!(amplification(1.0, 1.0, 0.0) < 0.99);
    }
}
