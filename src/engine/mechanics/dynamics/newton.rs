//! Newton's method for one implicit stage. The whole Newton step is tried first; a line search
//! shortens the step only if the residual would increase.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, Imbalance, Stage, System, keep_larger};
use tracing::{Level, enabled, trace};

/// Stopping criteria of Newton's method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopping {
    /// Radius of the thinnest moving rod, m.
    pub radius: f64,
    /// Largest last correction of a position at convergence, m.
    pub displacement: f64,
    /// Largest move of a position in an iteration, m; a larger one has left the solution near the
    /// prediction.
    pub trust_radius: f64,
    /// Most iterations.
    pub iterations: usize,
    /// Whether a correction of only the last digits of the unknowns ends the iteration, with any
    /// residual.
    pub ends_at_last_digits: bool,
    /// Whether to give up early if the residual does not fall or a line search is needed: a
    /// smaller step may be cheaper.
    pub gives_up: bool,
}

/// Result of whole corrections made outside of this method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corrected {
    /// Their number.
    pub iterations: usize,
    /// Largest move of a position in the last correction, m.
    pub last_move: f64,
    /// Whether the last correction changed only the last digits of the unknowns.
    pub changes_nothing: bool,
    /// Whether the residual is below its tolerance.
    pub is_balanced: bool,
    /// Whether the residual may do work, which must then be checked.
    pub may_do_work: bool,
}

/// Scratch of Newton's method.
#[derive(Clone, Debug)]
pub(crate) struct Newton {
    start: Vec<f64>,
    direction: Vec<f64>,
}

/// Number of iterations in which contact forces are carried along; a step that needs more restarts
/// without carrying.
const CARRYING_ITERATIONS: usize = 30;
/// Largest move of a position in such an iteration, in radii. Falling rods move a radius within a
/// step; beyond two, contacts on the way have not been detected.
const FARTHEST_CARRIED: f64 = 2.0;
/// Correction of a position, in radii, below which normals and contact points are close to those
/// of the solution.
const SLIGHT_MOVE: f64 = 1e-2;
/// Number of iterations within which the residual must fall to [`TRIAL_REDUCTION`] of its largest
/// value among them; otherwise a smaller step is cheaper.
///
/// At friction coefficients near one the line search may creep along the boundary between sticking
/// and sliding for all iterations. Fewer iterations or a smaller fraction would give up steps that
/// would have converged.
const TRIAL_ITERATIONS: usize = 5;
const TRIAL_REDUCTION: f64 = 0.2;
/// A correction of at most this many last digits of the unknowns counts as zero: with stiff
/// contact, these digits leave a larger residual than is allowed.
pub(super) const LAST_DIGITS: f64 = 4.0;
/// Most reductions of the step along one direction before it is accepted.
const LINE_SEARCH_STEPS: usize = 12;
/// A step is accepted when the force along the direction has fallen below this fraction.
pub(super) const SUFFICIENT_REDUCTION: f64 = 0.9;

impl Newton {
    /// Scratch for `unknowns` unknowns.
    pub(crate) fn new(unknowns: usize) -> Self {
        Self {
            start: vec![0.0; unknowns],
            direction: vec![0.0; unknowns],
        }
    }

    /// Solves R(q) = 0, starting from `unknowns`, which may have been `corrected` and evaluated,
    /// and leaves the solution there. Returns the number of linear solves, except those of a
    /// prediction of contact forces, which solves for no contacts. The frames and the residual of
    /// `system` are those of the solution.
    ///
    /// # Errors
    /// [`Divergence`] if the iterations are exhausted or make no progress, a number is not finite,
    /// or `goes_on` returns false.
    pub(crate) fn solve(
        &mut self,
        system: &mut System,
        stage: &Stage,
        unknowns: &mut [f64],
        corrected: Option<Corrected>,
        stopping: &Stopping,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<usize, Divergence> {
        let carries = system.uses_multipliers();
        let mut course = Course::new(carries, stopping);
        let mut first = 0;
        if let Some(corrected) = corrected {
            first = corrected.iterations;
            course.last_move = corrected.last_move;
            course.is_corrected = true;
            let does_work = || corrected.may_do_work && system.residual_does_work(unknowns, stage);
            let Corrected {
                changes_nothing,
                is_balanced,
                ..
            } = corrected;
            if course.ends(is_balanced, stopping, changes_nothing, does_work) {
                if enabled!(Level::TRACE) {
                    course.trace(first, &system.imbalance());
                }
                return Ok(first);
            }
        }
        system.linearize(unknowns, Some(stage));
        if carries && system.predict_contacts(unknowns, stage, stopping.radius) {
            system.linearize(unknowns, Some(stage));
        }
        for iteration in first..=course.limit {
            let imbalance = system.imbalance();
            course.trace(iteration, &imbalance);
            if course.is_settled(imbalance.is_balanced(), stopping)
                && course.refinement != Refinement::Due
                && (course.is_corrected || system.is_balanced_as_predicted(unknowns, Some(stage)))
            {
                return Ok(iteration);
            }
            let failed = Divergence {
                iterations: iteration,
                residual: imbalance.residual,
                unknown: imbalance.unknown,
            };
            let is_last = !imbalance.residual.is_finite() || iteration == course.limit;
            if is_last || !goes_on() || course.crawls(iteration, imbalance.ratio) {
                return Err(failed);
            }
            self.find_direction(system, stopping, failed)?;
            self.start.copy_from_slice(unknowns);
            let before = Progress::of(system, &self.direction);
            let part = self.correct(system, unknowns, stopping, carries);
            // Evaluate only the residual: it costs a quarter of the Jacobian, which the solution
            // no longer needs.
            system.evaluate(unknowns, Some(stage));
            course.last_move = part * largest_move(&self.direction);
            course.is_corrected |= part == 1.0;
            let changes_nothing = stopping.ends_at_last_digits
                && part == 1.0
                && are_last_digits(&self.direction, unknowns);
            let imbalance = system.imbalance();
            let does_work = || system.residual_does_work(unknowns, stage);
            if course.ends(
                imbalance.is_balanced(),
                stopping,
                changes_nothing,
                does_work,
            ) {
                course.trace(iteration + 1, &imbalance);
                return Ok(iteration + 1);
            }
            let after = Progress::of(system, &self.direction);
            system.set_moved_slightly(course.last_move <= SLIGHT_MOVE * stopping.radius);
            system.linearize_evaluated(unknowns, Some(stage));
            if carries || after.suffices(&before) {
                continue;
            }
            if stopping.gives_up {
                return Err(Divergence {
                    iterations: iteration + 1,
                    ..failed
                });
            }
            let part = self.line_search(system, stage, unknowns, &before, &after, part);
            course.last_move = part * largest_move(&self.direction);
            course.is_corrected = false;
            system.linearize_evaluated(unknowns, Some(stage));
        }
        unreachable!("the last iteration returns")
    }

    /// Finds the Newton direction at the last linearisation.
    ///
    /// # Errors
    /// [`Divergence`] if the iteration leaves the trust region, or, with a NaN residual, if no
    /// direction is found.
    fn find_direction(
        &mut self,
        system: &mut System,
        stopping: &Stopping,
        failed: Divergence,
    ) -> Result<(), Divergence> {
        let factored = system.factor();
        let solved = factored.and_then(|_| system.direction(&mut self.direction));
        if solved.is_err() || !self.direction.iter().all(|d| d.is_finite()) {
            return Err(Divergence {
                residual: f64::NAN,
                ..failed
            });
        }
        // The trust region ignores the frames of joints without inertia: they turn at once to
        // balanced moments.
        let of_nodes = STRIDE * system.assembly.rods.nodes;
        if largest_move(&self.direction[..of_nodes]) > stopping.trust_radius {
            return Err(failed);
        }
        Ok(())
    }

    /// Moves the unknowns along the direction, or along the fraction of it that contact allows;
    /// returns that fraction.
    fn correct(
        &self,
        system: &mut System,
        unknowns: &mut [f64],
        stopping: &Stopping,
        carries: bool,
    ) -> f64 {
        self.move_by(1.0, system, unknowns);
        let longest = if carries {
            (FARTHEST_CARRIED * stopping.radius / largest_move(&self.direction)).min(1.0)
        } else {
            system.largest_step(&self.start, unknowns)
        };
        if longest < 1.0 {
            self.move_by(longest, system, unknowns);
        }
        longest
    }

    /// Sets the unknowns to start + length · direction.
    fn move_by(&self, length: f64, system: &mut System, unknowns: &mut [f64]) {
        for k in 0..unknowns.len() {
            unknowns[k] = self.start[k] + length * self.direction[k];
        }
        system.complete(unknowns);
    }

    /// Approaches a root of d·R along the direction d by regula falsi (Matthies and Strang 1979),
    /// if the whole step, or the `longest` allowed, has lowered neither the residual nor the force
    /// along it. Leaves the unknowns there.
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
                // The force has grown without a change of sign: no root is within reach, so take
                // the step.
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

/// Record of the iterations so far.
struct Course {
    /// Most iterations.
    limit: usize,
    /// Whether to give up if the residual does not fall.
    is_on_trial: bool,
    /// Largest imbalance in the current iterations of the trial.
    largest_ratio: f64,
    /// Largest move of a position by the last correction, m.
    last_move: f64,
    /// Whether a whole correction has been made since the last line search.
    is_corrected: bool,
    refinement: Refinement,
}

/// State of the refinement: if the residual of a balanced step may still do work, the step is
/// corrected once more.
#[derive(Clone, Copy, PartialEq)]
enum Refinement {
    NotAsked,
    Due,
    Done,
}

impl Course {
    fn new(carries: bool, stopping: &Stopping) -> Self {
        Self {
            limit: if carries {
                CARRYING_ITERATIONS
            } else {
                stopping.iterations
            },
            is_on_trial: stopping.gives_up && !carries,
            largest_ratio: 0.0,
            last_move: 0.0,
            is_corrected: false,
            refinement: Refinement::NotAsked,
        }
    }

    fn trace(&self, iteration: usize, imbalance: &Imbalance) {
        let Imbalance {
            ratio, residual, ..
        } = imbalance;
        let last_move = self.last_move;
        trace!(iteration, residual, ratio, last_move, "Newton iteration");
    }

    /// Whether forces are balanced and the last correction was small.
    fn is_settled(&self, is_balanced: bool, stopping: &Stopping) -> bool {
        is_balanced && self.last_move <= stopping.displacement
    }

    /// Whether the iteration ends after a correction: if the correction changed nothing, or if
    /// forces are balanced after a whole correction and no refinement is due. A refinement is due
    /// if the residual `does_work`.
    fn ends(
        &mut self,
        is_balanced: bool,
        stopping: &Stopping,
        changes_nothing: bool,
        does_work: impl FnOnce() -> bool,
    ) -> bool {
        let is_balanced = self.is_corrected && self.is_settled(is_balanced, stopping);
        self.refine(|| is_balanced && does_work());
        changes_nothing || is_balanced && self.refinement != Refinement::Due
    }

    /// Requests the single refinement if `does_work` returns true.
    fn refine(&mut self, does_work: impl FnOnce() -> bool) {
        self.refinement = match self.refinement {
            Refinement::NotAsked if does_work() => Refinement::Due,
            Refinement::NotAsked => Refinement::NotAsked,
            Refinement::Due | Refinement::Done => Refinement::Done,
        };
    }

    /// Whether the residual has not fallen enough in the last iterations of a trial.
    fn crawls(&mut self, iteration: usize, ratio: f64) -> bool {
        if self.is_on_trial && iteration > 0 && iteration.is_multiple_of(TRIAL_ITERATIONS) {
            if ratio > TRIAL_REDUCTION * self.largest_ratio {
                return true;
            }
            self.largest_ratio = 0.0;
        }
        self.largest_ratio = self.largest_ratio.max(ratio);
        false
    }
}

/// Progress of a step.
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

    /// Whether the residual has fallen or, if not, the force along the direction.
    fn suffices(&self, before: &Self) -> bool {
        self.squared_residual <= before.squared_residual
            || self.slope.abs() <= SUFFICIENT_REDUCTION * before.slope.abs()
    }
}

/// Whether a correction is within the last digits of positions and angles. The farthest position
/// sets the last digit for all positions.
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
    let (nodes, rest) = direction.as_chunks::<STRIDE>();
    let mut largest = [0.0; STRIDE - 1];
    for node in nodes.iter().map(|node| &node[..]).chain([rest]) {
        let own = largest.iter_mut().zip(node);
        own.for_each(|(largest, d)| keep_larger(largest, d.abs()));
    }
    largest.into_iter().fold(0.0, f64::max)
}
