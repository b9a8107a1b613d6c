//! Following a path: predict along the tangent, correct, look for critical points, adapt the step.

use super::bordered::{Bordered, Condition};
use super::location::{Location, Origin, PathPoint, PointKind, Tangent};
use super::plan::{PathMethod, PathPlan};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::statics::equilibrium::{extent, find_equilibrium};
use crate::mechanics::statics::small_motions::{Unstable, small_motions};
use crate::mechanics::statics::spectrum::{find_neutral_modes, lowest_eigenvalue};
use crate::mechanics::system::{Divergence, System};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use tracing::debug;

/// Largest number of iterations after which the next step may be longer.
const FEW_ITERATIONS: usize = 4;
const GROWTH: f64 = 1.5;
/// Fraction of the first step below which a step counts as failed.
const SHORTEST_STEP: f64 = 1e-4;
/// Smallest cosine between the tangents before and after a step of the arclength. Sharper turns might lead
/// to another branch.
pub(super) const SMALLEST_COSINE: f64 = 0.8;

/// Largest distance of a point from its prediction, relative to the step.
const LARGEST_CORRECTION: f64 = 0.5;
/// The error for a point that is not between its neighbours on the path.
const NOT_BETWEEN: Divergence = Divergence {
    iterations: 0,
    residual: f64::NAN,
    unknown: 0,
};

/// Numbers of branches that ended within the range of the parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EndedEarly {
    /// Branches that reached the plan's limit of points.
    pub long: usize,
    /// Branches other than the first that were not found, or could not be followed with the
    /// smallest step.
    pub lost: usize,
}

/// Follows a path point by point; part of a checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Tracer {
    pub(super) plan: PathPlan,
    pub(super) bordered: Bordered,
    weights: [f64; 2],
    pub(super) branch: usize,
    branches: usize,
    ended_early: EndedEarly,
    points: usize,
    /// Present point of the path; `None` before its start and after its end.
    pub(super) here: Option<Location>,
    pub(super) tangent: Tangent,
    /// Length of the next step; 1 is the whole range of the parameter.
    step: f64,
    pub(super) iterations: usize,
    started: bool,
    pub(super) waiting: VecDeque<PathPoint>,
    pub(super) origins: VecDeque<Origin>,
    /// Bifurcations of the first branch, with its directions there.
    pub(super) crossings: Vec<Origin>,
    /// Start of the present branch; `None` on the first.
    pub(super) start_of_branch: Option<Origin>,
    scratch: Vec<f64>,
}

impl Tracer {
    /// Creates a tracer at `unknowns`, near which the path of `plan` begins; `tolerance` is the
    /// residual at a point as a multiple of the forces of each rod.
    pub(crate) fn new(system: &System, unknowns: &[f64], plan: PathPlan, tolerance: f64) -> Self {
        let extent = extent(unknowns);
        let bordered = Bordered::new(system, extent, plan.range(), tolerance);
        Self {
            weights: Bordered::weights(unknowns.len(), extent),
            branch: 0,
            branches: 1,
            ended_early: EndedEarly::default(),
            points: 0,
            here: Some(Location {
                parameter: plan.from,
                unknowns: unknowns.to_vec(),
                reference: system.reference.clone(),
                unstable: Unstable::default(),
                neutral: bordered.neutral.clone(),
            }),
            tangent: Tangent {
                unknowns: vec![0.0; unknowns.len()],
                parameter: plan.range(),
            },
            step: plan.step / plan.range().abs(),
            iterations: 0,
            started: false,
            waiting: VecDeque::new(),
            origins: VecDeque::new(),
            crossings: Vec::new(),
            start_of_branch: None,
            scratch: vec![0.0; unknowns.len()],
            bordered,
            plan,
        }
    }

    /// The next point of the path; `None` after the last.
    ///
    /// # Errors
    /// [`Divergence`] if no equilibrium was found at the start, or if the first branch cannot be
    /// followed with the smallest step.
    pub(crate) fn next(&mut self, system: &mut System) -> Result<Option<PathPoint>, Divergence> {
        while self.waiting.is_empty() {
            if !self.started {
                self.started = true;
                self.start(system)?;
            } else if self.here.is_some() {
                match self.advance(system) {
                    Err(_) if self.branch > 0 => self.ended_early.lost += 1,
                    done => done?,
                }
            } else if let Some(origin) = self.origins.pop_front() {
                self.branch = self.branches;
                if self.switch(system, &origin) {
                    self.branches += 1;
                    self.start_of_branch = Some(origin);
                } else {
                    self.ended_early.lost += 1;
                }
            } else {
                return Ok(None);
            }
        }
        Ok(self.waiting.pop_front())
    }

    /// Branches that ended within the range of the parameter.
    pub fn ended_early(&self) -> EndedEarly {
        self.ended_early
    }

    /// Finds the equilibrium at the start and the initial direction of the path.
    fn start(&mut self, system: &mut System) -> Result<(), Divergence> {
        let start = self.here.take().expect("a tracer starts somewhere");
        let condition = self.at_parameter(start.parameter, &start.unknowns);
        let found = self.correct(system, &start, &condition, start.unknowns.clone());
        let location = match found {
            Ok(location) => location,
            Err(_) => {
                let mut relaxed = start.clone();
                system.resume(start.parameter, &start.unknowns, &start.reference);
                system.drive(start.parameter, &mut relaxed.unknowns);
                let tolerance = self.bordered.tolerance;
                self.iterations += find_equilibrium(system, &mut relaxed.unknowns, tolerance)?;
                relaxed.reference.clone_from(&system.reference);
                self.correct(system, &relaxed, &condition, relaxed.unknowns.clone())?
            }
        };
        self.turn_tangent(None);
        self.arrive(system, location);
        Ok(())
    }

    /// Takes one step.
    fn advance(&mut self, system: &mut System) -> Result<(), Divergence> {
        let here = self.here.take().expect("called on a path");
        if self.points >= self.plan.most_points {
            self.ended_early.long += 1;
            return Ok(());
        }
        let largest = self.plan.largest_step / self.plan.range().abs();
        loop {
            let step = self.step.min(largest);
            let before = self.tangent.clone();
            let attempt = self.step_by(system, &here, step);
            let turned = attempt.as_ref().is_ok_and(|_| {
                self.turn_tangent(Some(&before));
                self.plan.method == PathMethod::Arclength
                    && self.inner(&before, &self.tangent) < SMALLEST_COSINE
            });
            match attempt {
                Ok(next) if !turned => {
                    debug!(
                        branch = self.branch,
                        parameter = next.parameter,
                        step,
                        iterations = self.iterations,
                        unstable = next.unstable.total(),
                        "point of the path"
                    );
                    if self.iterations <= FEW_ITERATIONS {
                        self.step = (GROWTH * step).min(largest);
                    }
                    if let Some(start) = self.close_loops(&here, &next) {
                        self.arrive(system, start);
                        self.here = None;
                        return Ok(());
                    }
                    self.locate_critical_points(system, &here, &before, &next, step);
                    return self.arrive_or_end(system, &here, next);
                }
                attempt => {
                    self.tangent = before;
                    self.step = 0.5 * step;
                    let reason = if attempt.is_ok() {
                        "the path turns too sharply"
                    } else {
                        "no equilibrium found ahead"
                    };
                    debug!(
                        branch = self.branch,
                        step, reason, "step along the path rejected"
                    );
                    if self.step < SHORTEST_STEP * self.plan.step / self.plan.range().abs() {
                        return match attempt {
                            Err(divergence) => Err(divergence),
                            // At a corner of the path, continue with the tangent beyond it.
                            Ok(next) => {
                                self.turn_tangent(None);
                                self.arrive_or_end(system, &here, next)
                            }
                        };
                    }
                }
            }
        }
    }

    /// The point of the path `step` ahead of `from`.
    fn step_by(
        &mut self,
        system: &mut System,
        from: &Location,
        step: f64,
    ) -> Result<Location, Divergence> {
        let mut length = step;
        if self.plan.method == PathMethod::Natural {
            // The parameter grows in equal steps; the last step ends at the end of its range.
            length /= (self.tangent.parameter / self.plan.range()).abs();
            let left = (self.end_ahead() - from.parameter) / self.tangent.parameter;
            length = length.min(left);
        }
        let parameter = from.parameter + length * self.tangent.parameter;
        let predicted: Vec<f64> = (from.unknowns.iter().zip(&self.tangent.unknowns))
            .map(|(q, t)| q + length * t)
            .collect();
        let largest = match self.plan.method {
            PathMethod::Natural => f64::INFINITY,
            PathMethod::Arclength => LARGEST_CORRECTION * length,
        };
        self.correct_along(system, from, parameter, predicted, largest)
    }

    /// The point of the path between two of its points, at the fraction `share` from the first to
    /// the second.
    ///
    /// # Errors
    /// [`Divergence`] if Newton's method fails, or ends farther from its start than the two points
    /// are from each other.
    pub(super) fn between(
        &mut self,
        system: &mut System,
        low: &Location,
        high: &Location,
        share: f64,
    ) -> Result<Location, Divergence> {
        let parameter = low.parameter + share * (high.parameter - low.parameter);
        let predicted: Vec<f64> = (low.unknowns.iter().zip(&high.unknowns))
            .map(|(a, b)| a + share * (b - a))
            .collect();
        let way = self.distance(&low.unknowns, &high.unknowns);
        self.correct_along(system, low, parameter, predicted, way)
    }

    /// Corrects a prediction to the path, at its parameter or normal to the tangent. The
    /// correction may be at most `largest`, since another branch may be farther away.
    fn correct_along(
        &mut self,
        system: &mut System,
        from: &Location,
        parameter: f64,
        predicted: Vec<f64>,
        largest: f64,
    ) -> Result<Location, Divergence> {
        let condition = match self.plan.method {
            PathMethod::Natural => self.at_parameter(parameter, &predicted),
            PathMethod::Arclength => {
                let tangent = self.tangent.clone();
                self.across(&tangent, parameter, &predicted)
            }
        };
        let found = self.correct(system, from, &condition, predicted)?;
        if self.distance(&found.unknowns, &condition.start) > largest {
            return Err(NOT_BETWEEN);
        }
        Ok(found)
    }

    /// The end of the range of λ towards which the path runs.
    fn end_ahead(&self) -> f64 {
        if self.tangent.parameter * self.plan.range() >= 0.0 {
            self.plan.to
        } else {
            self.plan.from
        }
    }

    /// Accepts a point; ends the branch at the end of the range of the parameter.
    fn arrive_or_end(
        &mut self,
        system: &mut System,
        before: &Location,
        next: Location,
    ) -> Result<(), Divergence> {
        let part = |parameter: f64| (parameter - self.plan.from) / self.plan.range();
        let end = if part(next.parameter) >= 1.0 {
            self.plan.to
        } else if part(next.parameter) <= 0.0 {
            self.plan.from
        } else {
            self.arrive(system, next);
            return Ok(());
        };
        let share = (end - before.parameter) / (next.parameter - before.parameter);
        let between = (before.unknowns.iter().zip(&next.unknowns))
            .map(|(a, b)| a + share * (b - a))
            .collect();
        let condition = self.at_parameter(end, &next.unknowns);
        let last = self.correct(system, before, &condition, between)?;
        self.arrive(system, last);
        self.here = None;
        Ok(())
    }

    /// Makes `location` the present point of the path and queues it for output.
    pub(super) fn arrive(&mut self, system: &mut System, mut location: Location) {
        let unknowns = self.place(system, &location);
        if self.bordered.linearize(system, &unknowns).is_some() {
            let shift = self.bordered.shift;
            find_neutral_modes(&mut location.neutral, system, unknowns.len(), shift);
        }
        self.hand_out(system, &location, PointKind::Regular, 0.0);
        self.points += 1;
        self.here = Some(location);
    }

    /// Queues a point.
    pub(super) fn hand_out(
        &mut self,
        system: &mut System,
        location: &Location,
        kind: PointKind,
        parameter_error: f64,
    ) {
        let unknowns = self.place(system, location);
        let lowest = lowest_eigenvalue(
            system,
            &unknowns,
            &location.neutral,
            self.bordered.shift,
            &mut self.scratch,
        );
        let motions = (!system.is_symmetric())
            .then(|| small_motions(system, &unknowns))
            .flatten();
        self.waiting.push_back(PathPoint {
            branch: self.branch,
            parameter: location.parameter,
            parameter_error,
            unknowns,
            reference: location.reference.clone(),
            negative: location.unstable.total(),
            lowest_eigenvalue: lowest.unwrap_or(f64::NAN),
            motions,
            kind,
            iterations: std::mem::take(&mut self.iterations),
        });
    }

    /// Sets `system` to a location; returns the unknowns there.
    pub(super) fn place(&mut self, system: &mut System, location: &Location) -> Vec<f64> {
        system.resume(location.parameter, &location.unknowns, &location.reference);
        let mut unknowns = location.unknowns.clone();
        system.drive(location.parameter, &mut unknowns);
        unknowns
    }

    /// Runs Newton's method from `unknowns` with the frames of `from`.
    pub(super) fn correct(
        &mut self,
        system: &mut System,
        from: &Location,
        condition: &Condition,
        mut unknowns: Vec<f64>,
    ) -> Result<Location, Divergence> {
        system.resume(from.parameter, &from.unknowns, &from.reference);
        self.bordered.neutral.clone_from(&from.neutral);
        let mut parameter = condition.start_parameter;
        let converged = self
            .bordered
            .correct(system, &mut unknowns, &mut parameter, condition)?;
        self.iterations += converged.iterations;
        system.commit_frames();
        Ok(Location {
            parameter,
            unknowns,
            reference: system.reference.clone(),
            unstable: converged.unstable,
            neutral: self.bordered.neutral.clone(),
        })
    }

    /// Prescribes the parameter.
    fn at_parameter(&self, parameter: f64, unknowns: &[f64]) -> Condition {
        Condition {
            unknowns: vec![0.0; unknowns.len()],
            parameter: 1.0,
            start: unknowns.to_vec(),
            start_parameter: parameter,
        }
    }

    /// The condition for a plane normal to `tangent` through a point.
    pub(super) fn across(&self, tangent: &Tangent, parameter: f64, unknowns: &[f64]) -> Condition {
        let range = self.plan.range();
        Condition {
            unknowns: (tangent.unknowns.iter().enumerate())
                .map(|(k, t)| self.weight(k) * t)
                .collect(),
            parameter: tangent.parameter / (range * range),
            start: unknowns.to_vec(),
            start_parameter: parameter,
        }
    }

    /// Sets the tangent to the direction (∂q/∂λ, 1) of the last correction, oriented like `before`
    /// or, without it, towards the end of the range.
    pub(super) fn turn_tangent(&mut self, before: Option<&Tangent>) {
        let mut tangent = Tangent {
            unknowns: self.bordered.rate.clone(),
            parameter: 1.0,
        };
        let along = before.map_or(self.tangent.parameter, |before| {
            self.inner(before, &tangent)
        });
        let factor = self
            .inner(&tangent, &tangent)
            .sqrt()
            .recip()
            .copysign(along);
        tangent.unknowns.iter_mut().for_each(|t| *t *= factor);
        tangent.parameter = factor;
        self.tangent = tangent;
    }

    /// Inner product of two directions.
    pub(super) fn inner(&self, a: &Tangent, b: &Tangent) -> f64 {
        let range = self.plan.range();
        let moved: f64 = (a.unknowns.iter().zip(&b.unknowns).enumerate())
            .map(|(k, (a, b))| self.weight(k) * a * b)
            .sum();
        moved + a.parameter * b.parameter / (range * range)
    }

    /// Distance of two shapes.
    pub(super) fn distance(&self, from: &[f64], to: &[f64]) -> f64 {
        let squares = (from.iter().zip(to).enumerate())
            .map(|(k, (from, to))| self.weight(k) * (to - from) * (to - from));
        squares.sum::<f64>().sqrt()
    }

    fn weight(&self, unknown: usize) -> f64 {
        self.weights[usize::from(unknown % STRIDE == 3)]
    }

    /// Length of the first step.
    pub(super) fn first_step(&self) -> f64 {
        self.plan.step / self.plan.range().abs()
    }

    /// Begins a branch with short steps.
    pub(super) fn begin_branch(&mut self) {
        self.points = 0;
        self.step = self.first_step();
    }
}
