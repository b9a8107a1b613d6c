//! Backward differences that are exact for steady rotation (Gautschi 1961), in the form of an
//! implicit Euler stage.
//!
//! The velocity at the end of a step h is the derivative of the function a + b t + c cos ωt + d sin
//! ωt through the last four points. The acceleration is the derivative of a + c cos ωt + d sin ωt
//! through the last three velocities:
//!
//! ```text
//! q̇ = (q − q̂)/H,     q̂ = qₙ + α₁ (qₙ₋₁ − qₙ) + α₂ (qₙ₋₂ − qₙ)
//! v̇ = (v − v̂)/Hₐ,    v̂ = vₙ + S₁²/(S² − S₁²) (vₙ − vₙ₋₁),   Hₐ = S₁ S₀ S/(S² − S₁²)
//! S₁ = S(h),   S₀ = S(h₀),   S = S(h₀ + h),   S(t) = (2/ω) sin(ωt/2)
//! ```
//!
//! with the size h₀ of the step before. For ω = 0, where S(t) = t, these are BDF3 and BDF2 (Gear
//! 1971). Differences of third order alone would feed oscillations that no drag damps (they are
//! not A-stable). With an acceleration of second order they damp all oscillations. Only the inertia
//! of motions other than rotation is then of second order; this inertia is small where drag
//! dominates. So positions and velocities advance by an Euler stage of size H from q̂ and v̂.
//! Contact and elasticity are evaluated at the end of the step.
//!
//! The drag is that of the predicted motion q̂ + H v*, implicit in each node's own velocity. The
//! velocity v* is extrapolated by a + c cos ωt + d sin ωt from the last four velocities by least
//! squares, which is also of third order and takes one solution of the fluid per step.
//!
//! Four velocities are used, although three would suffice, because the difference of the drag R
//! and the local resistance D, (R − D) v*, is fed back from step to step. With the inertia M, y =
//! M/(Hₐ D), and without elasticity, this grows where the polynomial
//!
//! ```text
//! (y + 1) z⁴ − y (4 z³ − z²)/3 + (R/D − 1) (w₁ z³ + w₂ z² + w₃ z + w₄)
//! ```
//!
//! with the weights w of v* has a root outside the unit circle. Without inertia four velocities
//! are stable for R between 0.45 and 1.42 of D, three between 0.50 and 1.14; from y = 0.3 on there
//! is no lower bound, and the upper one is 1.42 + 0.74 y. With three velocities ten flagella in a
//! bundle ring from steps of 1.5 ms on; with four they do not ring yet at 2.5 ms. Beyond these
//! bounds α D takes the place of D, with the least α for which R/(α D) ≤ 1.4 + 0.7 y/α. The drag
//! is the same if the prediction is right, so that the order remains. If y/α is below 1, the drag is
//! found within the step: `dynamics/coupling`.
//!
//! Rods on steadily rotating clamps move by a rotation at their ω plus a slow motion. BDF3 would
//! have an error of (ωh)³/4 in the speed of the rotation; the fitted differences have none.

use super::{Prediction, SolvedStep, TimeScheme};
use crate::mechanics::dynamics::history::LENGTH;
use crate::mechanics::dynamics::state::State;
use crate::mechanics::dynamics::step_control::ErrorLaw;
use crate::mechanics::system::Stage;
use crate::mechanics::{Matrix3, Vector3};

/// Largest growth of automatic steps from one to the next. This growth is smaller than for the
/// other schemes, since differences over several steps err more when steps grow. For two flagella
/// turned from rest, the deviation from small steps after 2.5 s is a fifth of that with a growth of
/// 1.5.
const LARGEST_GROWTH: f64 = 1.1;

/// Largest distance of an iteration from the predictor, in radii. Where predicted contacts press
/// hard, Newton's method may converge to another solution of the step, centimetres away, from
/// which the rods would return only slowly.
const TRUST_RADIUS: f64 = 0.2;

/// Growth of the step up to which differences of second and third order are stable: 1 + √2 and
/// 1.53 (Calvo, Grande and Grigorieff 1990). Beyond the first bound, implicit Euler takes the
/// step.
const LARGEST_GROWTHS: [f64; 2] = [2.1, 1.51];

/// Number of velocities from which v* is extrapolated.
const VELOCITIES: usize = LENGTH + 1;

/// Weight of each velocity in the least squares, relative to the next later one. Equal weights
/// would ring sooner and err more.
const FADING: f64 = 0.6;

/// Inertia relative to D Hₐ below which the drag of predicted velocities is unstable if the
/// resistance is less than half of D.
const LEAST_INERTIA: f64 = 0.3;

/// Largest ratio of resistances that do not ring, without inertia and per inertia, see above;
/// rounded down, to allow for growing steps and rotations.
const LAGGED: [f64; 2] = [1.4, 0.7];

/// Least inertia relative to an enlarged α D Hₐ. The change of the velocity from its extrapolation
/// acts with α. With less inertia the velocities after a collision err so much that the next
/// prediction penetrates: with 0.5, a tenth of the steps of 5 ms of two bundled flagella fail.
const LEAST_ENLARGED_INERTIA: f64 = 1.0;

/// Largest angle ω(h₋₁ + h₀ + h) that is fitted, rad. Faster rotations are not resolved by the
/// steps; they are damped.
const LARGEST_ANGLE: f64 = 1.0;

/// Least number of steps, chosen by the error, per turn of a clamp. The error of each step
/// represents that of many: where bundled flagella press on each other, the losses of larger steps
/// add up. With 160 steps a turn, over 250 s, two flagella deviate by 0.5 radii from a run with
/// steps of 1 ms.
const STEPS_PER_TURN: f64 = 200.0;

/// Largest step that the error may choose if clamps rotate at ω, s.
pub(in crate::mechanics::dynamics) fn largest_step(turning: f64) -> f64 {
    std::f64::consts::TAU / (STEPS_PER_TURN * turning)
}

/// The stage of a step and its predictor; for the symbols see above.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BackwardDifference {
    /// H, s.
    pub step: f64,
    /// α₁ and α₂.
    pub weights: [f64; 2],
    /// Hₐ, s.
    pub acceleration_step: f64,
    /// Weight of vₙ₋₁ − vₙ in v̂.
    pub acceleration_weight: f64,
    /// Weights of the last velocities in v*, latest first.
    pub velocity_weights: [f64; VELOCITIES],
}

impl BackwardDifference {
    /// For a step from a state.
    fn after(step: f64, state: &State, turning: f64) -> Self {
        let sizes = std::array::from_fn(|k| state.history.steps[k].size);
        Self::new(step, sizes, turning)
    }

    /// The differences for a step of size `step` after the `earlier` steps, latest first (0: there
    /// is none), all in s, with a rotation ω in rad/s.
    pub(crate) fn new(step: f64, earlier: [f64; LENGTH], turning: f64) -> Self {
        let [second, third] = LARGEST_GROWTHS;
        if step > second * earlier[0] {
            return Self {
                step,
                weights: [0.0; 2],
                acceleration_step: step,
                acceleration_weight: 0.0,
                velocity_weights: padded(&[1.0]),
            };
        }
        let mut times = [step; VELOCITIES];
        for (k, earlier) in earlier.iter().enumerate() {
            times[k + 1] = times[k] + earlier;
        }
        let turning = Turning {
            rate: turning.min(LARGEST_ANGLE / times[2]),
        };
        let fitted = Self::of_second_order(times[0], times[1], turning);
        if step > third * earlier[0] || earlier[0] > third * earlier[1] {
            fitted
        } else {
            let known = 1 + earlier.iter().take_while(|&&step| step > 0.0).count();
            fitted.with_third_order(&times[..known], turning)
        }
    }

    /// The differences through points at the times `last` and `before` ahead of the end of the
    /// step.
    fn of_second_order(last: f64, before: f64, turning: Turning) -> Self {
        let [one, both, between] = [last, before, before - last].map(|time| turning.chord(time));
        let difference = both * both - one * one;
        let (step, weight) = (one * between * both / difference, -one * one / difference);
        Self {
            step,
            weights: [weight, 0.0],
            acceleration_step: step,
            acceleration_weight: weight,
            velocity_weights: padded(&[
                turning.sine(before) / turning.sine(before - last),
                -turning.sine(last) / turning.sine(before - last),
            ]),
        }
    }

    /// Raises the velocities to third order with one more point, and extrapolates v* from the
    /// velocities at all `times` (at least three) ahead of the end of the step.
    fn with_third_order(self, times: &[f64], turning: Turning) -> Self {
        // Each column holds the functions at one point, all zero at the end of the step.
        let slopes = Matrix3::from_columns(
            &[times[0], times[1], times[2]]
                .map(|t| Vector3::new(-t, turning.versine(t), turning.lag(t))),
        );
        let derivative = slopes.lu().solve(&Vector3::x());
        let (Some(derivative), Some(velocity_weights)) = (derivative, turning.extrapolation(times))
        else {
            return self;
        };
        let sum = derivative.sum();
        Self {
            step: -1.0 / sum,
            weights: [derivative.y / sum, derivative.z / sum],
            velocity_weights,
            ..self
        }
    }

    /// v* from the last velocities.
    pub(crate) fn predicted(&self, velocities: [f64; VELOCITIES]) -> f64 {
        let products = self.velocity_weights.iter().zip(velocities);
        products.map(|(weight, velocity)| weight * velocity).sum()
    }
}

/// Appends zero weights for earlier velocities.
fn padded(weights: &[f64]) -> [f64; VELOCITIES] {
    let mut all = [0.0; VELOCITIES];
    all[..weights.len()].copy_from_slice(weights);
    all
}

/// Functions of a rotation that tend to polynomials if it is slow.
#[derive(Clone, Copy)]
struct Turning {
    /// ω, rad/s.
    rate: f64,
}

impl Turning {
    /// sin(ωt)/ω, t for ω = 0.
    fn sine(self, time: f64) -> f64 {
        if self.rate > 0.0 {
            libm::sin(self.rate * time) / self.rate
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

    /// Weights of values at `times` ahead of the end of the step that extrapolate to it by a + c
    /// cos ωt + d sin ωt. The least-squares fit weights each earlier value less by [`FADING`].
    fn extrapolation(self, times: &[f64]) -> Option<[f64; VELOCITIES]> {
        let scale = times[0];
        let functions = |time: f64| {
            let (sine, versine) = (self.sine(time), self.versine(time));
            Vector3::new(1.0, sine / scale, versine / (scale * scale))
        };
        let mut weights = [0.0; VELOCITIES];
        let mut counts = 1.0;
        let mut products = Matrix3::zeros();
        for (weight, &time) in weights.iter_mut().zip(times) {
            *weight = counts;
            products += counts * functions(time) * functions(time).transpose();
            counts *= FADING;
        }
        let solved = products.lu().solve(&Vector3::x())?;
        for (weight, &time) in weights.iter_mut().zip(times) {
            *weight *= functions(time).dot(&solved);
        }
        Some(weights)
    }

    /// (ωt − sin ωt)/ω³, t³/6 for ω = 0.
    fn lag(self, time: f64) -> f64 {
        let square = (self.rate * time).powi(2);
        // Four terms of the series: for the angles that are fitted, the remainder is below
        // rounding error.
        let series = 1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0));
        if square < 0.01 {
            time.powi(3) / 6.0 * series
        } else {
            (time - self.sine(time)) / self.rate.powi(2)
        }
    }
}

/// Backward differences as a scheme of one stage.
pub(super) struct BackwardDifferences;

impl TimeScheme for BackwardDifferences {
    fn error_law(&self) -> ErrorLaw {
        ErrorLaw {
            order: 4,
            largest_growth: LARGEST_GROWTH,
        }
    }

    fn predicts_drag(&self) -> bool {
        true
    }

    /// See above.
    fn largest_lagged_ratio(&self, inertia: f64) -> f64 {
        if inertia < LEAST_INERTIA {
            return 0.0;
        }
        LAGGED[0] + LAGGED[1] * inertia
    }

    fn lagged_factor(&self, ratio: f64, inertia: f64) -> Option<f64> {
        if ratio <= self.largest_lagged_ratio(inertia) {
            return Some(1.0);
        }
        let factor = ((ratio - LAGGED[1] * inertia) / LAGGED[0]).max(1.0);
        (inertia >= LEAST_ENLARGED_INERTIA * factor).then_some(factor)
    }

    fn begins_small(&self) -> bool {
        true
    }

    fn earlier_weights(&self, step: f64, state: &State, turning: f64) -> [f64; 2] {
        BackwardDifference::after(step, state, turning).weights
    }

    fn trust_radius(&self) -> f64 {
        TRUST_RADIUS
    }

    fn begin(
        &self,
        step: f64,
        state: &State,
        turning: f64,
        stage: &mut Stage,
        prediction: &mut Prediction,
    ) {
        let past = &state.history.steps;
        let [last, before, ..] = past;
        let difference = BackwardDifference::after(step, state, turning);
        stage.step = difference.step;
        stage.acceleration_step = difference.acceleration_step;
        stage.keeps_spin = false;
        for k in 0..state.unknowns.len() {
            let mut velocities = [state.velocity[k]; VELOCITIES];
            for (velocity, earlier) in velocities[1..].iter_mut().zip(past) {
                *velocity = earlier.velocity[k];
            }
            let [first, second] =
                [last, before].map(|earlier| earlier.unknowns[k] - state.unknowns[k]);
            stage.start[k] =
                state.unknowns[k] + difference.weights[0] * first + difference.weights[1] * second;
            stage.velocity[k] =
                velocities[0] + difference.acceleration_weight * (velocities[1] - velocities[0]);
            prediction.velocity[k] = difference.predicted(velocities);
            prediction.unknowns[k] = stage.start[k] + stage.step * prediction.velocity[k];
        }
        let start = std::mem::take(&mut stage.start);
        stage.start_at(&start);
        stage.start = start;
    }

    /// The local error is H/4 times the predictor error of the velocity, at free unknowns.
    fn finish(&self, solved: &SolvedStep, velocity: &mut [f64]) -> f64 {
        let stage = solved.stage;
        solved.fill(velocity, |k| {
            let after = (solved.end[k] - stage.start[k]) / stage.step;
            let predictor_error = after - solved.predicted_velocity[k];
            let error = if solved.held[k] {
                0.0
            } else {
                stage.step / 4.0 * predictor_error
            };
            (after, error)
        })
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
            let before = now - earlier_step;
            let times = [now, before, before - 0.1, before - 0.22];
            let earlier = [earlier_step, 0.1, 0.12];
            let difference = BackwardDifference::new(step, earlier, turning);
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
            let [last, before] = earlier;
            let difference = BackwardDifference::new(step, [last, before, 0.0], 0.0);
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

    /// The largest factor by which a step of M q̈ + R q̇ + K q = 0 multiplies a motion, if only D
    /// of the drag R is implicit. It is the largest root z of the polynomial from q = zⁿ in M (v −
    /// v̂)/Hₐ + D v + (R − D) v* + K q, v = (q − q̂)/H. All in units of the step.
    fn amplification(mass: f64, [drag, local]: [f64; 2], stiffness: f64) -> f64 {
        let difference = BackwardDifference::new(1.0, [1.0; LENGTH], 0.0);
        // Coefficients of v in terms of q, and of the acceleration in terms of v, by the number of
        // steps ago.
        let [first, second] = difference.weights;
        let velocity = [first + second - 1.0, -first, -second].map(|c| c / difference.step);
        let velocity = [1.0 / difference.step, velocity[0], velocity[1], velocity[2]];
        let weight = difference.acceleration_weight;
        let acceleration = [1.0, weight - 1.0, -weight].map(|c| c / difference.acceleration_step);
        let mut force = [0.0; VELOCITIES + 1];
        for (k, coefficient) in acceleration.iter().enumerate() {
            force[k] += mass * coefficient;
        }
        force[0] += local;
        for (k, weight) in difference.velocity_weights.iter().enumerate() {
            force[k + 1] += (drag - local) * weight;
        }
        let mut polynomial = [0.0; VELOCITIES + 4];
        polynomial[0] = stiffness;
        for (i, f) in force.iter().enumerate() {
            for (j, v) in velocity.iter().enumerate() {
                polynomial[i + j] += f * v;
            }
        }
        // Its companion matrix.
        let degree = polynomial.len() - 1;
        let mut matrix = DMatrix::<f64>::zeros(degree, degree);
        for k in 0..degree {
            matrix[(0, k)] = -polynomial[k + 1] / polynomial[0];
        }
        for k in 1..degree {
            matrix[(k, k - 1)] = 1.0;
        }
        let roots: Vec<Complex<f64>> = matrix.complex_eigenvalues().iter().copied().collect();
        roots.iter().map(|root| root.norm()).fold(0.0, f64::max)
    }

    /// Multiple roots of a matrix are found to about the fifth root of rounding error.
    const ROUNDING: f64 = 1e-6;

    #[test]
    fn no_oscillation_is_fed() {
        for decade in -20..=30 {
            let frequency = 10f64.powf(0.1 * f64::from(decade));
            for damping in [0.0, 0.01, 0.1, 1.0, 10.0, 1e3] {
                let radius = amplification(1.0, [damping; 2], frequency * frequency);
                assert!(
                    radius < 1.0 + ROUNDING,
                    "ω = {frequency}, c = {damping}: {radius}"
                );
            }
        }
        assert!(amplification(1.0, [0.0; 2], 1.0) < 0.99);
    }

    #[test]
    fn drag_that_exceeds_its_local_resistance_does_not_ring() {
        for mass in [0.0, 0.1, 1.0, 10.0] {
            for stiffness in [0.0, 0.1, 1.0, 10.0, 100.0] {
                for drag in [0.8, 1.0, 1.2, 1.39] {
                    let radius = amplification(mass, [drag, 1.0], stiffness);
                    assert!(
                        radius < 1.0 + ROUNDING,
                        "M = {mass}, K = {stiffness}, R = {drag} D: {radius}"
                    );
                }
            }
        }
        assert!(
            amplification(0.0, [2.0, 1.0], 0.0) > 1.0,
            "the bound is real"
        );
    }
}
