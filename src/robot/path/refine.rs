//! Refines the solutions on the ladder to joint positions at every point.

use super::ladder::Ladder;
use super::{Obstruction, PathFailure, PathPoint, PathProblem};
use crate::chain::Chain;

/// Rounds of smoothing on the rungs.
const COARSE_ROUNDS: usize = 120;
/// Rounds of smoothing at the points.
const FINE_ROUNDS: usize = 6;

/// Smooths the joint path in the null space and follows the path from rung to rung.
pub(super) fn refine(
    problem: &PathProblem<'_>,
    points: &[PathPoint],
    ladder: &Ladder,
) -> Result<Vec<Vec<f64>>, PathFailure> {
    let chain = problem.chain;
    let mut coarse = ladder.joints.clone();
    let rungs: Vec<PathPoint> = ladder.rungs.iter().map(|rung| points[*rung]).collect();
    if chain.joints.len() > 6 {
        smooth(problem, &rungs, &mut coarse, COARSE_ROUNDS);
    }
    let mut joints = Vec::with_capacity(points.len());
    for (segment, rung) in rungs.windows(2).enumerate() {
        let (from, to) = (ladder.rungs[segment], ladder.rungs[segment + 1]);
        for index in from..to {
            let part = (points[index].way - rung[0].way) / (rung[1].way - rung[0].way);
            let guess = interpolated(&rungs, &coarse, segment, part);
            let followed = chain.follow(&points[index].pose, &guess);
            joints.push(followed.ok_or_else(|| problem.failure(points, index, Obstruction::Jump))?);
        }
    }
    joints.push(coarse[coarse.len() - 1].clone());
    if chain.joints.len() > 6 {
        smooth(problem, points, &mut joints, FINE_ROUNDS);
    }
    match joints.iter().position(|joints| !problem.is_free(joints)) {
        Some(point) => Err(problem.failure(points, point, Obstruction::Collision)),
        None => Ok(joints),
    }
}

/// Cubic Hermite interpolation between two rungs with slopes from neighbouring rungs.
fn interpolated(rungs: &[PathPoint], joints: &[Vec<f64>], segment: usize, t: f64) -> Vec<f64> {
    let length = rungs[segment + 1].way - rungs[segment].way;
    let slope = |rung: usize, k: usize| {
        let (before, after) = (rung.saturating_sub(1), (rung + 1).min(rungs.len() - 1));
        (joints[after][k] - joints[before][k]) / (rungs[after].way - rungs[before].way)
    };
    (0..joints[0].len())
        .map(|k| {
            let (a, b) = (joints[segment][k], joints[segment + 1][k]);
            let (da, db) = (slope(segment, k) * length, slope(segment + 1, k) * length);
            let (t2, t3) = (t * t, t * t * t);
            a * (2.0 * t3 - 3.0 * t2 + 1.0)
                + da * (t3 - 2.0 * t2 + t)
                + b * (3.0 * t2 - 2.0 * t3)
                + db * (t3 - t2)
        })
        .collect()
}

/// Moves the joints at every point except the first in the null space, halfway to the mean of
/// their neighbours, unless limits or obstacles prevent it.
fn smooth(problem: &PathProblem<'_>, points: &[PathPoint], joints: &mut [Vec<f64>], rounds: usize) {
    let chain = problem.chain;
    let count = joints.len();
    for _ in 0..rounds {
        let mut moved = 0.0_f64;
        for k in 1..count {
            let wish: Vec<f64> = (0..joints[k].len())
                .map(|j| {
                    let here = joints[k][j];
                    // At the free end the last step is mirrored.
                    let after = if k + 1 < count {
                        joints[k + 1][j]
                    } else {
                        joints[k - 1][j]
                    };
                    0.5 * (joints[k - 1][j] + after) - here
                })
                .collect();
            if let Some((next, step)) = in_null_space(chain, &points[k], &joints[k], &wish)
                && problem.is_free(&next)
            {
                joints[k] = next;
                moved = moved.max(step);
            }
        }
        if moved < 1e-5 {
            break;
        }
    }
}

/// The posture after a desired joint motion in the null space, and the size of the motion; `None`
/// if the posture is too close to the limits.
fn in_null_space(
    chain: &Chain,
    point: &PathPoint,
    joints: &[f64],
    wish: &[f64],
) -> Option<(Vec<f64>, f64)> {
    let (_, jacobian) = chain.hand_and_jacobian(joints);
    let direction = chain.null_direction(&jacobian, wish)?;
    let step: f64 = direction.iter().zip(wish).map(|(d, w)| d * w).sum();
    if step.abs() < 1e-9 {
        return None;
    }
    let guess: Vec<f64> = joints
        .iter()
        .zip(&direction)
        .map(|(q, d)| q + step * d)
        .collect();
    // Stay slightly inside the joint limits, so that the path can still be corrected.
    if chain.distance_to_limits(&guess) < chain.distance_to_limits(joints).min(0.02) {
        return None;
    }
    Some((chain.follow(&point.pose, &guess)?, step.abs()))
}
