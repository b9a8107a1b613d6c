//! Continuation from one grasp to another in steps on the same branch of solutions.

use super::mesh::{finer_mesh, first_mesh};
use super::shape::{March, Shape};
use super::{GraspProblem, Vector3, WEIGHT};
use std::f64::consts::FRAC_PI_2;

/// Largest rotation of a tangent in one step. After a larger rotation the solution may have jumped
/// to another branch.
const LARGEST_TURN: f64 = 0.5;
/// Smallest step, as a fraction of the path.
const SMALLEST_STEP: f64 = 1e-3;
/// Maximum number of refinements of the mesh.
const REFINEMENTS: usize = 8;
/// Suspended length at which the curvature is introduced. In longer rods the gripper has no effect
/// on the contact node.
const SHORT: f64 = 4.0;

/// The gentle branch, starting at the planar rod. `None` if Newton's method does not converge.
pub fn gentle(problem: &GraspProblem, march: &mut March) -> Option<Shape> {
    let short = GraspProblem {
        suspended_length: problem.suspended_length.min(SHORT),
        ..*problem
    };
    let start = planar(&short, march)?;
    let bent = walk(start, &short, march)?;
    walk(bent, problem, march)
}

/// The gentle planar rod, κ̄ = 0, from the deflection of a heavy beam: θ = l s²/8 − s³/12, n_z(0) = −l/4.
fn planar(problem: &GraspProblem, march: &mut March) -> Option<Shape> {
    let problem = GraspProblem {
        curvature: 0.0,
        ..*problem
    };
    let length = problem.suspended_length;
    let force = [0.0, -(0.5 * WEIGHT * length).min(0.75)];
    let shape = Shape::guess(problem, &first_mesh(&problem), force, |s| {
        let small = length * s * s / 8.0 - s * s * s / 12.0;
        // Not beyond upright.
        let angle = small / (1.0 + small / FRAC_PI_2);
        let tangent = Vector3::new(libm::cos(angle), 0.0, libm::sin(angle));
        (tangent, Vector3::zeros())
    });
    settled(shape, march)
}

/// Newton's method, with refinement until the mesh is fine enough.
pub fn settled(mut shape: Shape, march: &mut March) -> Option<Shape> {
    shape.converge(march)?;
    for _ in 0..REFINEMENTS {
        let Some(mesh) = finer_mesh(&shape) else {
            break;
        };
        let mut finer = Shape::guess(shape.problem, &mesh, shape.force, |s| shape.at(s));
        finer.converge(march)?;
        shape = finer;
    }
    Some(shape)
}

/// The solution of `problem` on the branch of `shape`; steps are halved if Newton's method fails or
/// jumps.
pub fn walk(shape: Shape, problem: &GraspProblem, march: &mut March) -> Option<Shape> {
    let from = shape.problem;
    let mut shape = shape;
    let (mut done, mut step) = (0.0, 1.0);
    while done < 1.0 {
        let next = if done + step >= 1.0 { 1.0 } else { done + step };
        let aim = if next == 1.0 {
            *problem
        } else {
            from.towards(problem, next)
        };
        match moved(&shape, aim, march) {
            Some(there) => {
                shape = there;
                done = next;
                step *= 2.0;
            }
            None => {
                step *= 0.5;
                if step < SMALLEST_STEP {
                    return None;
                }
            }
        }
    }
    Some(shape)
}

/// One step: finds the solution near `shape`.
fn moved(shape: &Shape, problem: GraspProblem, march: &mut March) -> Option<Shape> {
    let mesh = first_mesh(&problem);
    let guess = Shape::guess(problem, &mesh, shape.force, |s| shape.at(s));
    let before = guess.tangents.clone();
    let there = settled(guess, march)?;
    // The mesh may have become finer.
    let turned = mesh.iter().zip(&before);
    let largest = turned
        .map(|(s, tangent)| (there.at(*s).0 - tangent).norm())
        .fold(0.0, f64::max);
    (largest < LARGEST_TURN).then_some(there)
}
