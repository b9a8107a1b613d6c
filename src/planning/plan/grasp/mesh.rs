//! Meshes for the suspended rod.
//!
//! Disturbances of the rod decay over 1/√|n|; the effects of the pattern's curvature and the
//! upward bend are limited to a few L_gb near the contact node. The first mesh accounts for this.
//! Intervals are split where the shape requires it.

use super::gauss::{RULE, STAGES};
use super::shape::Shape;
use super::{GraspProblem, WEIGHT};

/// Number of decay lengths in an interval far from the contact node.
const DECAY_LENGTHS: f64 = 2.5;
/// Additional intervals per L_gb at the contact node, and their decay length.
const DENSITY_AT_CONTACT: f64 = 1.2;
const CONTACT_LENGTH: f64 = 2.5;
/// Minimum number of intervals.
const FEWEST: usize = 3;
/// Maximum number of intervals.
const MOST: usize = 4000;
/// Number of points per L_gb at which the density is summed.
const RESOLUTION: f64 = 8.0;

/// Allowed residual of the equations at the ends of intervals, times the length of the interval.
/// The polynomials have degree five but are exact to order 10 at the ends, so the error of the
/// shape is about the square of this value.
const DEFECT: f64 = 1e-4;

/// Intervals per length.
fn density(problem: &GraspProblem, s: f64) -> f64 {
    let decay = (1.0 + WEIGHT * s).sqrt();
    let contact = DENSITY_AT_CONTACT * (1.0 + 0.5 * problem.curvature.abs());
    decay / DECAY_LENGTHS + contact * libm::exp(-s / CONTACT_LENGTH)
}

/// The first mesh: points from 0 to the gripper.
pub fn first_mesh(problem: &GraspProblem) -> Vec<f64> {
    let length = problem.suspended_length;
    let points = (RESOLUTION * length).ceil().max(16.0) as usize;
    let step = length / points as f64;
    let mut sums = Vec::with_capacity(points + 1);
    sums.push(0.0);
    let mut sum = 0.0;
    for point in 0..points {
        sum += step * density(problem, (point as f64 + 0.5) * step);
        sums.push(sum);
    }
    let intervals = (sum.ceil() as usize).clamp(FEWEST, MOST);
    let mut mesh = Vec::with_capacity(intervals + 1);
    mesh.push(0.0);
    let mut point = 0;
    for interval in 1..intervals {
        let wanted = sum * interval as f64 / intervals as f64;
        while sums[point + 1] < wanted {
            point += 1;
        }
        let part = (wanted - sums[point]) / (sums[point + 1] - sums[point]);
        mesh.push((point as f64 + part) * step);
    }
    mesh.push(length);
    mesh
}

/// A mesh refined where the shape requires it; `None` if it is fine enough, or would need too many
/// intervals.
pub fn finer_mesh(shape: &Shape) -> Option<Vec<f64>> {
    let mut mesh = vec![0.0];
    for (index, interval) in shape.intervals.iter().enumerate() {
        let end = interval.start + interval.length;
        let force = shape.internal_force(end);
        let (tangent, moment) = (shape.tangents[index + 1], shape.moments[index + 1]);
        let stretch = 1.0 + shape.problem.stretch_compliance * force.dot(&tangent);
        let mut turn = RULE.end_slope[0] * shape.tangents[index];
        let mut change = RULE.end_slope[0] * shape.moments[index];
        for stage in 0..STAGES {
            turn += RULE.end_slope[stage + 1] * interval.tangents[stage];
            change += RULE.end_slope[stage + 1] * interval.moments[stage];
        }
        turn -= interval.length * moment.cross(&tangent);
        change += interval.length * stretch * tangent.cross(&force);
        // The moment is a derivative of the tangent, so its residual is multiplied by the length
        // of the interval.
        let defect = turn.norm().max(interval.length.min(1.0) * change.norm());
        let parts = libm::pow(defect / DEFECT, 1.0 / (STAGES + 1) as f64);
        let parts = parts.ceil().clamp(1.0, 4.0) as usize;
        for part in 1..=parts {
            mesh.push(interval.start + interval.length * part as f64 / parts as f64);
        }
    }
    if let Some(last) = mesh.last_mut() {
        *last = shape.problem.suspended_length;
    }
    (mesh.len() > shape.intervals.len() + 1 && mesh.len() <= MOST).then_some(mesh)
}
