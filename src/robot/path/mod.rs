//! Joint paths along a path of poses of the hand.
//!
//! The path is divided into points at most 1 mm and 0.01 rad apart. Some of these points are the
//! rungs of a ladder of solutions, as in Descartes (De Maeyer et al. 2017): every solution of a
//! rung leads to nearby solutions on the next one, and dynamic programming finds the sequence with
//! the lowest cost. Between rungs, the joint path is interpolated and projected onto the path;
//! redundant joints are then moved in the null space until the joint path is smooth.

mod ladder;
mod placement;
mod points;
mod refine;

pub use placement::{Placement, place};
pub use points::{PathPoint, subdivide};

use super::chain::Chain;
use super::pose::Pose;
use ladder::Ladder;

/// Largest step of a joint between neighbouring points of a path, rad or m.
pub const LARGEST_JUMP: f64 = 0.05;

/// Input of the search for a joint path.
pub struct PathProblem<'a> {
    /// The chain.
    pub chain: &'a Chain,
    /// Joint positions near which the path should begin.
    pub from: &'a [f64],
    /// Distance to the nearest obstacle, m.
    pub clearance: &'a (dyn Fn(&[f64]) -> f64 + Sync),
    /// Least allowed distance, m.
    pub margin: f64,
}

/// A joint path.
#[derive(Clone, Debug)]
pub struct JointPath {
    /// Joint positions at every point.
    pub joints: Vec<Vec<f64>>,
    /// Largest step of a joint between neighbouring points, rad or m.
    pub largest_jump: f64,
    /// Least distance to an obstacle, m.
    pub least_clearance: f64,
    /// Least distance to a singularity: smallest singular value of the Jacobian.
    pub least_distance_to_singularity: f64,
    /// Smallest distance of a joint from an end of its range, rad or m.
    pub least_distance_to_limits: f64,
}

/// The point where a path cannot be followed, and the reason.
#[derive(Clone, Debug)]
pub struct PathFailure {
    /// Index of the first point that no smooth joint path reaches.
    pub point: usize,
    /// Why.
    pub reason: Obstruction,
    /// Nearest pose that the arm can take, in the base frame.
    pub nearest: Pose,
}

/// Reason why a point cannot be reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstruction {
    /// No posture within the limits reaches it.
    OutOfReach,
    /// Every posture that reaches it comes too near to an obstacle.
    Collision,
    /// The point can be reached, but only with a jump from the points before it.
    Jump,
}

impl Obstruction {
    /// The reason as text.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::OutOfReach => "no posture within the limits of the joints reaches it",
            Self::Collision => "every posture that reaches it comes too near to an obstacle",
            Self::Jump => "it can be reached only by a jump of the joints",
        }
    }
}

impl PathProblem<'_> {
    /// Finds a smooth joint path along points from [`subdivide`].
    ///
    /// # Errors
    /// The first point that no smooth joint path reaches.
    pub fn solve(&self, points: &[PathPoint]) -> Result<JointPath, Box<PathFailure>> {
        let ladder = Ladder::climb(self, points)?;
        let joints = refine::refine(self, points, &ladder).map_err(Box::new)?;
        let path = self.measure(joints);
        let bad = path
            .joints
            .windows(2)
            .position(|pair| jump(&pair[0], &pair[1]) > LARGEST_JUMP);
        match bad {
            Some(before) => Err(Box::new(self.failure(
                points,
                before + 1,
                Obstruction::Jump,
            ))),
            None => Ok(path),
        }
    }

    fn is_free(&self, joints: &[f64]) -> bool {
        (self.clearance)(joints) >= self.margin
    }

    fn failure(&self, points: &[PathPoint], point: usize, reason: Obstruction) -> PathFailure {
        let pose = points[point].pose;
        let nearest = match reason {
            Obstruction::OutOfReach => match self.chain.reach(&pose, self.from) {
                Ok(joints) => self.chain.hand(&joints),
                Err(nearest) => nearest.hand,
            },
            // The previous point could be reached.
            Obstruction::Collision | Obstruction::Jump => points[point.saturating_sub(1)].pose,
        };
        PathFailure {
            point,
            reason,
            nearest,
        }
    }

    fn measure(&self, joints: Vec<Vec<f64>>) -> JointPath {
        let least = |value: &dyn Fn(&[f64]) -> f64| {
            joints
                .iter()
                .map(|q| value(q))
                .fold(f64::INFINITY, f64::min)
        };
        JointPath {
            largest_jump: joints
                .windows(2)
                .map(|pair| jump(&pair[0], &pair[1]))
                .fold(0.0, f64::max),
            least_clearance: least(&|q| (self.clearance)(q)),
            least_distance_to_singularity: least(&|q| {
                self.chain.hand_and_jacobian(q).1.smallest_singular_value()
            }),
            least_distance_to_limits: least(&|q| self.chain.distance_to_limits(q)),
            joints,
        }
    }
}

/// Largest step of a joint between two postures.
fn jump(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
