//! The ladder: solutions on rungs of the path, and the sequence of solutions with the lowest cost.

use super::{LARGEST_JUMP, Obstruction, PathFailure, PathPoint, PathProblem, jump};
use crate::self_motion::separation;
use rayon::prelude::*;

/// Distance between rungs, m.
const RUNG: f64 = 8e-3;
/// Largest number of solutions of a rung.
const MOST: usize = 100;
/// Solutions closer than this count as one, rad or m.
const SAME: f64 = 0.1;
/// Steps in the null space that give further solutions on the next rung.
const NULL_STEP: f64 = 0.15;
/// Fraction of [`LARGEST_JUMP`] that the ladder uses, so that the refinement has some margin.
const PART_OF_JUMP: f64 = 0.7;
/// Weight, per rung, of the distances to limits, singularities and obstacles relative to the joint
/// motion.
const DISCOMFORT: f64 = 2e-3;

/// The sequence of solutions with the lowest cost.
pub(super) struct Ladder {
    /// Indices of the points that are rungs, including the first and the last.
    pub rungs: Vec<usize>,
    /// Joint positions on each rung.
    pub joints: Vec<Vec<f64>>,
}

struct Node {
    joints: Vec<f64>,
    cost: f64,
    parent: usize,
}

impl Ladder {
    /// Finds the sequence of solutions with the lowest cost.
    ///
    /// # Errors
    /// The first point that cannot be reached.
    pub fn climb(
        problem: &PathProblem<'_>,
        points: &[PathPoint],
    ) -> Result<Self, Box<PathFailure>> {
        let rungs = rungs(points);
        let mut levels = vec![first_level(problem, points)?];
        for pair in rungs.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let before = &levels[levels.len() - 1];
            let level = next_level(problem, points, before, (to - from) as f64, to);
            if level.is_empty() {
                return Err(Box::new(first_failure(problem, points, before, from, to)));
            }
            levels.push(level);
        }
        let mut joints = Vec::with_capacity(levels.len());
        let last = &levels[levels.len() - 1];
        let mut index = (0..last.len())
            .min_by(|a, b| last[*a].cost.total_cmp(&last[*b].cost))
            .unwrap_or(0);
        for level in levels.iter().rev() {
            joints.push(level[index].joints.clone());
            index = level[index].parent;
        }
        joints.reverse();
        Ok(Self { rungs, joints })
    }
}

/// Rungs at even distances of at most a quarter of the path, so that short paths have several.
fn rungs(points: &[PathPoint]) -> Vec<usize> {
    let last = points.len() - 1;
    let length = points[last].way;
    let spacing = RUNG.min(length / 4.0);
    let mut rungs = vec![0];
    let mut way = 0.0;
    for (index, point) in points.iter().enumerate().take(last).skip(1) {
        if point.way - way >= spacing - 1e-9 && length - point.way > 0.5 * spacing {
            rungs.push(index);
            way = point.way;
        }
    }
    if last > 0 {
        rungs.push(last);
    }
    rungs
}

fn first_level(
    problem: &PathProblem<'_>,
    points: &[PathPoint],
) -> Result<Vec<Node>, Box<PathFailure>> {
    let chain = problem.chain;
    let pose = &points[0].pose;
    let mut solutions = if chain.joints.len() <= 6 {
        chain.branches(pose)
    } else {
        let curves = chain.self_motions(pose);
        let all: usize = curves.iter().map(Vec::len).sum();
        let stride = all.div_ceil(4 * MOST).max(1);
        curves.into_iter().flatten().step_by(stride).collect()
    };
    // The arm may already be at the start of the path, with extra turns of its joints.
    solutions.extend(chain.follow(pose, problem.from));
    if solutions.is_empty() {
        return Err(Box::new(problem.failure(
            points,
            0,
            Obstruction::OutOfReach,
        )));
    }
    let nodes = solutions.into_par_iter().filter_map(|joints| {
        let discomfort = discomfort(problem, &joints)?;
        // Add the cost of the motion from the present posture to the start.
        let way = 0.02 * separation(&joints, problem.from).powi(2);
        Some(Node {
            joints,
            cost: discomfort + way,
            parent: 0,
        })
    });
    let nodes = thinned(nodes.collect());
    if nodes.is_empty() {
        return Err(Box::new(problem.failure(points, 0, Obstruction::Collision)));
    }
    Ok(nodes)
}

/// The solutions at a point a few points after `before`, each with its predecessor of lowest cost.
fn next_level(
    problem: &PathProblem<'_>,
    points: &[PathPoint],
    before: &[Node],
    steps: f64,
    to: usize,
) -> Vec<Node> {
    let chain = problem.chain;
    let pose = &points[to].pose;
    let reach = PART_OF_JUMP * LARGEST_JUMP * steps;
    let redundant = chain.joints.len() > 6;
    let candidates: Vec<Vec<f64>> = before
        .par_iter()
        .flat_map_iter(|node| {
            let mut found = Vec::with_capacity(3);
            found.extend(chain.follow(pose, &node.joints));
            if redundant {
                let (_, jacobian) = chain.hand_and_jacobian(&node.joints);
                let like = vec![1.0; chain.joints.len()];
                for side in [1.0, -1.0] {
                    let step = NULL_STEP.min(0.7 * reach) * side;
                    let aside = chain.null_direction(&jacobian, &like).map(|direction| {
                        let moved = node.joints.iter().zip(direction);
                        moved.map(|(q, d)| q + step * d).collect::<Vec<f64>>()
                    });
                    found.extend(aside.and_then(|aside| chain.follow(pose, &aside)));
                }
            }
            found
        })
        .collect();
    let nodes = candidates.into_par_iter().filter_map(|joints| {
        let ways = before.iter().enumerate().filter_map(|(parent, node)| {
            let near = jump(&joints, &node.joints) <= reach;
            // Squares make an even motion cheaper than an uneven one.
            near.then(|| {
                (
                    node.cost + separation(&joints, &node.joints).powi(2),
                    parent,
                )
            })
        });
        let (cost, parent) = ways.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let cost = cost + discomfort(problem, &joints)?;
        Some(Node {
            joints,
            cost,
            parent,
        })
    });
    thinned(nodes.collect())
}

/// The cost of a posture near limits, singularities and obstacles; `None` if it is forbidden.
fn discomfort(problem: &PathProblem<'_>, joints: &[f64]) -> Option<f64> {
    let clearance = (problem.clearance)(joints);
    if clearance < problem.margin {
        return None;
    }
    let limits = problem.chain.joints.iter().zip(joints).map(|(joint, q)| {
        let (lower, upper) = joint.limits.search_range();
        // Zero at the middle of the range, large at its ends.
        let near = (q - lower).min(upper - q).max(1e-3) / (0.5 * (upper - lower));
        if joint.limits.upper.is_finite() {
            (1.0 / near).min(100.0) - 1.0
        } else {
            0.0
        }
    });
    let limits: f64 = limits.sum();
    let (_, jacobian) = problem.chain.hand_and_jacobian(joints);
    let singular = 0.01 / jacobian.manipulability().max(1e-4);
    let obstacle = 0.05 / (clearance - problem.margin + 5e-3);
    Some(DISCOMFORT * (limits + singular + obstacle))
}

/// The cheapest of each group of close solutions, at most [`MOST`].
fn thinned(mut nodes: Vec<Node>) -> Vec<Node> {
    nodes.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut kept: Vec<Node> = Vec::new();
    for node in nodes {
        if kept.len() == MOST {
            break;
        }
        if !kept
            .iter()
            .any(|known| separation(&known.joints, &node.joints) < SAME)
        {
            kept.push(node);
        }
    }
    kept
}

/// The first point between two rungs that cannot be reached.
fn first_failure(
    problem: &PathProblem<'_>,
    points: &[PathPoint],
    before: &[Node],
    from: usize,
    to: usize,
) -> PathFailure {
    let mut here: Vec<Node> = before
        .iter()
        .map(|node| Node {
            joints: node.joints.clone(),
            cost: node.cost,
            parent: 0,
        })
        .collect();
    let mut point = from + 1;
    while point < to {
        // The full jump is allowed here, since the path is rejected if this search fails.
        let level = next_level(problem, points, &here, 1.0 / PART_OF_JUMP, point);
        if level.is_empty() {
            break;
        }
        here = level;
        point += 1;
    }
    let pose = &points[point].pose;
    let all = if problem.chain.joints.len() <= 6 {
        problem.chain.branches(pose)
    } else {
        problem.chain.self_motions(pose).concat()
    };
    let reason = if all.is_empty() {
        Obstruction::OutOfReach
    } else if all.iter().any(|joints| problem.is_free(joints)) {
        Obstruction::Jump
    } else {
        Obstruction::Collision
    };
    problem.failure(points, point, reason)
}
