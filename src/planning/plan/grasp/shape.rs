//! The suspended rod by collocation: its shape, and Newton's method for it.
//!
//! Growing solutions of the linearised equations are kept independent by orthonormalisation at
//! every interval. Only the two columns are propagated that satisfy the conditions at the contact
//! node (stabilised march; Ascher, Mattheij & Russell, Numerical Solution of Boundary Value
//! Problems for Ordinary Differential Equations, sec. 4.4). Single shooting would lose all digits
//! beyond l̄_s ≈ 12, because disturbances grow by exp(∫√|n| ds).

use super::gauss::{RULE, STAGES};
use super::interval::{COLUMNS, Interval, PARTICULAR, Stages, State};
use super::{GraspProblem, Vector3, WEIGHT};

/// Maximum number of Newton iterations.
const ITERATIONS: usize = 30;
/// Largest change of a tangent in one iteration.
const LARGEST_TURN: f64 = 0.6;
/// Change for which the next one is below the rounding error.
const CONVERGED: f64 = 1e-6;
/// Change of a force or moment that counts as divergence.
const DIVERGED: f64 = 1e4;

/// A suspended rod in equilibrium, EI = L_gb = 1.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Problem of the grasp.
    pub problem: GraspProblem,
    /// The intervals, from the contact node to the gripper.
    pub intervals: Vec<Interval>,
    /// t at the starts of the intervals and at the gripper.
    pub tangents: Vec<Vector3>,
    /// M there.
    pub moments: Vec<Vector3>,
    /// n_y(0), n_z(0).
    pub force: [f64; 2],
}

impl Shape {
    /// Samples a guess of tangent and moment on a mesh.
    pub fn guess(
        problem: GraspProblem,
        mesh: &[f64],
        force: [f64; 2],
        values: impl Fn(f64) -> (Vector3, Vector3),
    ) -> Self {
        let (tangents, moments) = mesh.iter().map(|s| values(*s)).unzip();
        let intervals = mesh
            .windows(2)
            .map(|ends| {
                let length = ends[1] - ends[0];
                let stages: [_; STAGES] =
                    std::array::from_fn(|stage| values(ends[0] + length * RULE.nodes[stage]));
                Interval {
                    start: ends[0],
                    length,
                    tangents: stages.map(|stage| stage.0),
                    moments: stages.map(|stage| stage.1),
                }
            })
            .collect();
        Self {
            problem,
            intervals,
            tangents,
            moments,
            force,
        }
    }

    /// n(s).
    pub fn internal_force(&self, s: f64) -> Vector3 {
        Vector3::new(0.0, self.force[0], self.force[1] + WEIGHT * s)
    }

    /// t and M at s. Beyond the gripper the rod continues straight in the direction of its internal
    /// force.
    pub fn at(&self, s: f64) -> (Vector3, Vector3) {
        let beyond = s - self.problem.suspended_length;
        if beyond > 0.0 {
            let force = self.internal_force(s);
            let size = force.norm();
            let direction = force / size;
            let slope = (WEIGHT / size) * (Vector3::z() - direction.z * direction);
            let rest = libm::exp(-size.sqrt() * beyond);
            let last = self.tangents[self.tangents.len() - 1];
            let tangent = (direction + rest * (last - direction)).normalize();
            return (tangent, (1.0 - rest) * direction.cross(&slope));
        }
        let index = self
            .intervals
            .partition_point(|interval| interval.start <= s)
            .saturating_sub(1);
        let interval = &self.intervals[index];
        let weights = RULE.interpolation((s - interval.start) / interval.length);
        let mut tangent = weights[0] * self.tangents[index];
        let mut moment = weights[0] * self.moments[index];
        for stage in 0..STAGES {
            tangent += weights[stage + 1] * interval.tangents[stage];
            moment += weights[stage + 1] * interval.moments[stage];
        }
        (tangent, moment)
    }

    /// Newton's method. Returns the number of iterations, or `None` if it does not converge.
    pub fn converge(&mut self, scratch: &mut March) -> Option<usize> {
        for iteration in 1..=ITERATIONS {
            let change = self.iterate(scratch)?;
            if change < CONVERGED {
                return Some(iteration);
            }
        }
        None
    }

    /// Performs one iteration; returns the largest change of a tangent, or of n(0).
    fn iterate(&mut self, march: &mut March) -> Option<f64> {
        let problem = self.problem;
        march.legs.clear();
        let mut columns = [State::default(); COLUMNS];
        columns[0].force[0] = 1.0;
        columns[1].force[1] = 1.0;
        columns[PARTICULAR].tangent = Vector3::x();
        columns[PARTICULAR].moment = problem.curvature * Vector3::z();
        for interval in &self.intervals {
            let (stages, mut ends) =
                interval.carry(&columns, self.force, problem.stretch_compliance);
            let turned = orthonormalise(&mut ends)?;
            march.legs.push(Leg {
                stages,
                columns,
                turned,
            });
            columns = ends;
        }
        // M = 0 at the gripper needs only the components across the tangent, since M·t = 0 holds
        // automatically.
        let last = self.tangents.len() - 1;
        let [one, other] = across(&self.tangents[last]);
        let row = |direction: &Vector3| columns.map(|column| direction.dot(&column.moment));
        let ([a, b, e], [c, d, f]) = (row(&one), row(&other));
        let determinant = a * d - b * c;
        let mut factors = [(b * f - d * e) / determinant, (c * e - a * f) / determinant];
        if !factors.iter().all(|factor| factor.is_finite()) {
            return None;
        }
        let mut end = columns[PARTICULAR];
        end.add(factors[0], &columns[0]);
        end.add(factors[1], &columns[1]);
        march.ends.clear();
        march.ends.push(end);
        for leg in march.legs.iter_mut().rev() {
            factors = leg.turned.back(factors);
            leg.combine(factors);
            let mut start = leg.columns[PARTICULAR];
            start.add(factors[0], &leg.columns[0]);
            start.add(factors[1], &leg.columns[1]);
            march.ends.push(start);
        }
        march.ends.reverse();
        self.take(march)
    }

    /// Moves to the new values, limited to the range in which the linearisation is valid.
    fn take(&mut self, march: &March) -> Option<f64> {
        let mut turn: f64 = 0.0;
        for (interval, leg) in self.intervals.iter().zip(&march.legs) {
            for stage in 0..STAGES {
                let new = leg.stages.tangents[stage][PARTICULAR];
                turn = turn.max((new - interval.tangents[stage]).norm());
            }
        }
        let new_force = march.ends[0].force;
        let pull = libm::hypot(new_force[0] - self.force[0], new_force[1] - self.force[1]);
        let change = turn.max(pull);
        if !(change < DIVERGED) {
            return None;
        }
        let factor = (LARGEST_TURN / turn.max(1e-300)).min(1.0);
        let move_to = |old: &mut Vector3, new: &Vector3| *old += factor * (new - *old);
        for (interval, leg) in self.intervals.iter_mut().zip(&march.legs) {
            for stage in 0..STAGES {
                move_to(
                    &mut interval.tangents[stage],
                    &leg.stages.tangents[stage][PARTICULAR],
                );
                move_to(
                    &mut interval.moments[stage],
                    &leg.stages.moments[stage][PARTICULAR],
                );
            }
        }
        for (point, end) in march.ends.iter().enumerate() {
            move_to(&mut self.tangents[point], &end.tangent);
            move_to(&mut self.moments[point], &end.moment);
        }
        for axis in 0..2 {
            self.force[axis] += factor * (new_force[axis] - self.force[axis]);
        }
        Some(change)
    }
}

/// Work arrays of Newton's method.
#[derive(Clone, Debug, Default)]
pub struct March {
    legs: Vec<Leg>,
    ends: Vec<State>,
}

/// Data of the march for an interval.
#[derive(Clone, Copy, Debug)]
struct Leg {
    stages: Stages,
    columns: [State; COLUMNS],
    turned: Turned,
}

impl Leg {
    /// Combines the columns into the last one.
    fn combine(&mut self, factors: [f64; 2]) {
        let sums = self
            .stages
            .tangents
            .iter_mut()
            .chain(&mut self.stages.moments);
        for columns in sums {
            columns[PARTICULAR] =
                columns[PARTICULAR] + factors[0] * columns[0] + factors[1] * columns[1];
        }
    }
}

/// Orthonormalisation of the columns at the end of an interval: old = new · [[a, b], [0, d]]. The
/// components of the particular solution along the columns are removed.
#[derive(Clone, Copy, Debug)]
struct Turned {
    triangle: [f64; 3],
    shift: [f64; 2],
}

impl Turned {
    /// Coefficients of the columns before the orthonormalisation from those after it.
    fn back(&self, factors: [f64; 2]) -> [f64; 2] {
        let [a, b, d] = self.triangle;
        let right = [factors[0] - self.shift[0], factors[1] - self.shift[1]];
        let second = right[1] / d;
        [(right[0] - b * second) / a, second]
    }
}

fn orthonormalise(columns: &mut [State; COLUMNS]) -> Option<Turned> {
    let a = columns[0].dot(&columns[0]).sqrt();
    let first = columns[0].scaled(1.0 / a);
    let b = first.dot(&columns[1]);
    let mut second = columns[1];
    second.add(-b, &first);
    let d = second.dot(&second).sqrt();
    let second = second.scaled(1.0 / d);
    let shift = [&first, &second].map(|column| column.dot(&columns[PARTICULAR]));
    columns[PARTICULAR].add(-shift[0], &first);
    columns[PARTICULAR].add(-shift[1], &second);
    (columns[0], columns[1]) = (first, second);
    let is_finite = [a, b, d].iter().all(|entry| entry.is_finite()) && a > 0.0 && d > 0.0;
    is_finite.then_some(Turned {
        triangle: [a, b, d],
        shift,
    })
}

/// Two unit vectors normal to a direction.
pub fn across(direction: &Vector3) -> [Vector3; 2] {
    let least = direction.iamin();
    let one = direction.cross(&Vector3::ith(least, 1.0)).normalize();
    [one, direction.cross(&one).normalize()]
}
