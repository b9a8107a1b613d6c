//! Newton's method for one implicit stage. The whole step is taken, with its Jacobian at once; only where
//! it increases the residual a line search finds a shorter one.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, Imbalance, Stage, System};
use tracing::{Level, enabled, trace};

/// Stopping criteria of Newton's method.
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
    /// Whether a correction of only the last digits of the unknowns ends the iteration with any residual.
    pub ends_at_last_digits: bool,
    /// Whether to give up earlier, where the residual does not fall or a line search would be needed: a smaller
    /// step may be the cheaper way.
    pub gives_up: bool,
}

/// Whole corrections that were made elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corrected {
    /// Their number.
    pub iterations: usize,
    /// Largest move of a position by the last one, m.
    pub last_move: f64,
    /// Whether the last one was of only the last digits of the unknowns.
    pub changes_nothing: bool,
    /// Whether the residual counts as none.
    pub is_balanced: bool,
    /// Whether it may do work, so that this must be looked at.
    pub may_do_work: bool,
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
/// contacts on the way have not been detected.
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
/// is requested.
pub(super) const LAST_DIGITS: f64 = 4.0;
/// Reductions of the step along one direction before it is accepted.
const LINE_SEARCH_STEPS: usize = 12;
/// A step is accepted when the force along the direction has fallen below this fraction.
pub(super) const SUFFICIENT_REDUCTION: f64 = 0.9;

impl Newton {
    /// Scratch for so many unknowns.
    pub(crate) fn new(unknowns: usize) -> Self {
        Self {
            start: vec![0.0; unknowns],
            direction: vec![0.0; unknowns],
        }
    }

    /// Solves R(q) = 0, starting from `unknowns`, which may have been `corrected` and evaluated, and leaving the solution there; returns the number of
    /// linear solves, without those of a prediction of contact forces, which solves for no contacts. The frames and the
    /// residual of `system` are those of the solution.
    ///
    /// # Errors
    /// [`Divergence`] when the iterations run out or lead nowhere, a number is not finite, or `goes_on` returns false.
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
            // The residual alone costs a quarter of the Jacobian, which the solution no longer needs.
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
            system.linearize(unknowns, Some(stage));
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
            system.linearize(unknowns, Some(stage));
        }
        unreachable!("the last iteration returns")
    }

    /// Finds the Newton direction at the last linearisation.
    ///
    /// # Errors
    /// [`Divergence`] if the iteration leaves the trust region, with a NaN residual where there is none.
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
        // Frames of joints without inertia turn at once to where moments balance.
        let of_nodes = STRIDE * system.assembly.rods.nodes;
        if largest_move(&self.direction[..of_nodes]) > stopping.trust_radius {
            return Err(failed);
        }
        Ok(())
    }

    /// Moves the unknowns by the direction, or by the part of it that contact allows; returns that part.
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

/// Record of the iterations so far.
struct Course {
    /// Most iterations.
    limit: usize,
    /// Whether it is given up where the residual does not fall.
    is_on_trial: bool,
    /// Largest imbalance of those that are compared in that.
    largest_ratio: f64,
    /// Largest move of a position by the last correction, m.
    last_move: f64,
    /// Whether a whole correction has been made since the last line search.
    is_corrected: bool,
    refinement: Refinement,
}

/// The residual of a balanced step may still do work; the step is then corrected once more.
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

    /// Whether the iteration ends after a correction: where it changed nothing, or forces are balanced after a whole one and do not
    /// want the refinement, which is due where their residual `does_work`.
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

    /// Requests the one refinement where `does_work` returns true.
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
