//! Newton's method for one implicit stage. The whole step is taken, with its Jacobian at once; only where
//! it makes things worse a line search looks for a shorter one.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, Imbalance, Stage, System};
use tracing::trace;

/// When Newton's method stops.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopping {
    /// Radius of the thinnest rod that moves, m.
    pub radius: f64,
    /// Largest correction of a position, m.
    pub displacement: f64,
    /// Farthest that an iteration may move a position, m; one that would move farther has left the solution near the
    /// prediction.
    pub trust_radius: f64,
    /// Most iterations.
    pub iterations: usize,
    /// Whether a correction of the last digits of the unknowns ends it, whatever they leave of the residual.
    pub ends_at_last_digits: bool,
    /// Whether to give up earlier, where the residual does not fall or a line search would be needed: a smaller
    /// step may be the cheaper way.
    pub gives_up: bool,
}

/// Scratch of Newton's method.
#[derive(Clone, Debug)]
pub(crate) struct Newton {
    start: Vec<f64>,
    direction: Vec<f64>,
}

/// Iterations in which contact forces are carried along; a step that needs more begins again without.
const CARRYING_ITERATIONS: usize = 30;
/// Farthest that such an iteration moves a position, in radii: rods that fall move a radius within a step, and beyond two
/// nothing is known of what they meet.
const FARTHEST_CARRIED: f64 = 2.0;
/// Correction of a position, in radii, from which down normals and contact points are those of the solution.
const SLIGHT_MOVE: f64 = 1e-2;
/// Iterations that must lower the residual to [`TRIAL_REDUCTION`] of its largest value in them, or a smaller step is
/// the cheaper way.
///
/// At friction coefficients near one the line search may crawl along the edge between sticking and sliding for all the
/// iterations there are. Fewer iterations or a smaller part give up steps that would have converged.
const TRIAL_ITERATIONS: usize = 5;
const TRIAL_REDUCTION: f64 = 0.2;
/// A correction of so many last digits of the unknowns is none: where contact is stiff they leave more of the residual than
/// is asked for.
const LAST_DIGITS: f64 = 4.0;
/// Reductions of the step along one direction before it is taken as it is.
const LINE_SEARCH_STEPS: usize = 12;
/// A step is accepted when the force along the direction has fallen below this fraction.
const SUFFICIENT_REDUCTION: f64 = 0.9;

impl Newton {
    /// Scratch for so many unknowns.
    pub(crate) fn new(unknowns: usize) -> Self {
        Self {
            start: vec![0.0; unknowns],
            direction: vec![0.0; unknowns],
        }
    }

    /// Solves R(q) = 0, starting from `unknowns` and leaving the solution there; returns the number of
    /// linear solves, without those of a prediction of contact forces, which solves for no contacts. The frames and the
    /// residual of `system` are those of the solution.
    ///
    /// # Errors
    /// [`Divergence`] when the iterations run out or lead nowhere, a number is not finite, or `goes_on` says no.
    pub(crate) fn solve(
        &mut self,
        system: &mut System,
        stage: &Stage,
        unknowns: &mut [f64],
        stopping: &Stopping,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<usize, Divergence> {
        let mut last_move = 0.0;
        // Whether a whole correction has been made.
        let mut is_corrected = false;
        // Whether the last one, made whole, changed no more than last digits.
        let mut is_exhausted = false;
        // Whether what the last one leaves is to be corrected although it is small, which is done once.
        let (mut leaves_work, mut is_refined) = (false, false);
        let mut largest_imbalance = 0.0_f64;
        let carries = system.uses_multipliers();
        let limit = if carries {
            CARRYING_ITERATIONS
        } else {
            stopping.iterations
        };
        system.linearize(unknowns, Some(stage));
        if carries && system.predict_contacts(unknowns, stage, stopping.radius) {
            system.linearize(unknowns, Some(stage));
        }
        for iteration in 0..=limit {
            let imbalance = system.imbalance();
            let Imbalance {
                ratio, residual, ..
            } = imbalance;
            trace!(iteration, residual, ratio, last_move, "Newton iteration");
            let is_solved = is_exhausted
                || imbalance.is_balanced() && last_move <= stopping.displacement && !leaves_work;
            if is_solved && (is_corrected || system.is_balanced_as_predicted(unknowns, Some(stage)))
            {
                return Ok(iteration);
            }
            let failed = Divergence {
                iterations: iteration,
                residual,
                unknown: imbalance.unknown,
            };
            if !residual.is_finite() || iteration == limit || !goes_on() {
                return Err(failed);
            }
            if !carries && stopping.gives_up && iteration > 0 && iteration % TRIAL_ITERATIONS == 0 {
                if ratio > TRIAL_REDUCTION * largest_imbalance {
                    return Err(failed);
                }
                largest_imbalance = 0.0;
            }
            largest_imbalance = largest_imbalance.max(ratio);
            let solved = system
                .factor()
                .and_then(|_| system.direction(&mut self.direction));
            let is_near = largest_move(&self.direction) <= stopping.trust_radius;
            let is_finite = self.direction.iter().all(|d| d.is_finite());
            if solved.is_ok() && is_finite && !is_near {
                return Err(failed);
            }
            if solved.is_err() || !is_finite {
                return Err(Divergence {
                    residual: f64::NAN,
                    ..failed
                });
            }
            self.start.copy_from_slice(unknowns);
            let before = Progress::of(system, &self.direction);
            self.move_by(1.0, system, unknowns);
            let longest = if carries {
                (FARTHEST_CARRIED * stopping.radius / largest_move(&self.direction)).min(1.0)
            } else {
                system.largest_step(&self.start, unknowns)
            };
            if longest < 1.0 {
                self.move_by(longest, system, unknowns);
            }
            last_move = longest * largest_move(&self.direction);
            // The residual alone costs a quarter of the Jacobian, which the solution no longer needs.
            system.evaluate(unknowns, Some(stage));
            is_corrected |= longest == 1.0;
            is_exhausted = stopping.ends_at_last_digits
                && longest == 1.0
                && are_last_digits(&self.direction, unknowns);
            let is_balanced = is_corrected
                && system.imbalance().is_balanced()
                && last_move <= stopping.displacement;
            leaves_work = is_balanced && !is_refined && system.residual_does_work(unknowns, stage);
            if is_exhausted || is_balanced && !leaves_work {
                continue;
            }
            is_refined |= leaves_work;
            let after = Progress::of(system, &self.direction);
            system.set_moved_slightly(last_move <= SLIGHT_MOVE * stopping.radius);
            system.linearize(unknowns, Some(stage));
            let accepted = carries || after.suffices(&before);
            if !accepted && stopping.gives_up {
                return Err(Divergence {
                    iterations: iteration + 1,
                    ..failed
                });
            }
            if !accepted {
                let length = self.line_search(system, stage, unknowns, &before, &after, longest);
                last_move = length * largest_move(&self.direction);
                is_corrected = false;
                system.linearize(unknowns, Some(stage));
            }
        }
        unreachable!("the last iteration returns")
    }

    /// Writes start + length · direction.
    fn move_by(&self, length: f64, system: &mut System, unknowns: &mut [f64]) {
        for k in 0..unknowns.len() {
            unknowns[k] = self.start[k] + length * self.direction[k];
        }
        system.complete(unknowns);
    }

    /// Approaches a root of d·R along the direction d by regula falsi (Matthies and Strang 1979), after the
    /// whole step, or the `longest` allowed, has neither lowered the residual nor the force along it; leaves the
    /// unknowns there.
    fn line_search(
        &mut self,
        system: &mut System,
        stage: &Stage,
        unknowns: &mut [f64],
        before: &Progress,
        full: &Progress,
        longest: f64,
    ) -> f64 {
        let (mut low, mut high) = ((0.0, before.slope), None);
        let (mut length, mut now) = (longest, full.slope);
        for _ in 0..LINE_SEARCH_STEPS {
            if !now.is_finite() || now * before.slope < 0.0 {
                high = Some((length, now));
            } else {
                low = (length, now);
            }
            length = match high {
                Some((end, force)) if force.is_finite() => {
                    let root = low.0 + (end - low.0) * (low.1 / (low.1 - force));
                    root.clamp(low.0 + 0.1 * (end - low.0), low.0 + 0.9 * (end - low.0))
                }
                Some((end, _)) => 0.5 * (low.0 + end),
                // The force has grown without changing its sign: no root within reach, take the step.
                None => break,
            };
            self.move_by(length, system, unknowns);
            system.evaluate(unknowns, Some(stage));
            let progress = Progress::of(system, &self.direction);
            if progress.suffices(before) {
                break;
            }
            now = progress.slope;
        }
        length
    }
}

/// How far a step has come.
struct Progress {
    /// Sum of squares of the residual, N².
    squared_residual: f64,
    /// Force along the direction, d·R, J.
    slope: f64,
}

impl Progress {
    fn of(system: &System, direction: &[f64]) -> Self {
        Self {
            squared_residual: system.squared_residual(),
            slope: direction
                .iter()
                .zip(&system.residual)
                .map(|(d, r)| d * r)
                .sum(),
        }
    }

    /// Whether the residual has fallen, or else the force along the direction.
    fn suffices(&self, before: &Self) -> bool {
        self.squared_residual <= before.squared_residual
            || self.slope.abs() <= SUFFICIENT_REDUCTION * before.slope.abs()
    }
}

/// Whether a correction is one of the last digits of positions and angles, the farthest of which count for all.
fn are_last_digits(direction: &[f64], unknowns: &[f64]) -> bool {
    let farthest = largest_move(unknowns);
    direction
        .iter()
        .zip(unknowns)
        .enumerate()
        .all(|(k, (d, unknown))| {
            let size = if k % STRIDE == 3 {
                unknown.abs().max(1.0)
            } else {
                farthest
            };
            d.abs() <= LAST_DIGITS * f64::EPSILON * size
        })
}

/// Largest move of a position along a direction, m.
fn largest_move(direction: &[f64]) -> f64 {
    let positions = direction
        .iter()
        .enumerate()
        .filter(|(k, _)| k % STRIDE != 3);
    positions.fold(0.0, |largest, (_, d)| largest.max(d.abs()))
}
