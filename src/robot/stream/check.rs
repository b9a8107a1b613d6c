//! What is looked at before the first point is sent.

use crate::robot::chain::Limits;
use crate::robot::driver::PartTrajectory;
use std::fmt;

/// Part of a limit by which rounding in a table may exceed it.
const ROUNDING: f64 = 0.01;

/// A point that must not be sent.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Name of the joint.
    pub joint: String,
    /// Index of the point.
    pub point: usize,
    /// What exceeds its limit.
    pub what: &'static str,
    /// How much it is, in rad or m and seconds.
    pub value: f64,
    /// What is allowed.
    pub allowed: [f64; 2],
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.allowed;
        write!(
            formatter,
            "{}: {} {:.6} at point {}; allowed: {low:.6} to {high:.6}",
            self.joint,
            self.what,
            self.value,
            self.point + 1
        )
    }
}

/// Checks positions, velocities, accelerations and jerks of a part against limits, one per joint, by differences of
/// neighbouring points, with rest before the first and after the last.
///
/// # Errors
/// The first fault of each joint.
pub fn check(trajectory: &PartTrajectory, limits: &[Limits]) -> Result<(), Vec<Fault>> {
    let mut faults = Vec::new();
    for (index, limits) in limits.iter().enumerate() {
        if let Some((what, point, value, allowed)) = first_fault(trajectory, index, limits) {
            let joint = trajectory.joints[index].clone();
            faults.push(Fault {
                joint,
                point,
                what,
                value,
                allowed,
            });
        }
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

type Found = (&'static str, usize, f64, [f64; 2]);

fn first_fault(trajectory: &PartTrajectory, joint: usize, limits: &Limits) -> Option<Found> {
    let outside = trajectory
        .points
        .iter()
        .position(|point| !limits.allow(point[joint]));
    if let Some(point) = outside {
        let position = trajectory.points[point][joint];
        return Some(("position", point, position, [limits.lower, limits.upper]));
    }
    // Times and values of each derivative; rest outside.
    let mut times = trajectory.times.clone();
    let mut values: Vec<f64> = trajectory.points.iter().map(|point| point[joint]).collect();
    let bounds = [
        ("velocity", limits.velocity),
        ("acceleration", limits.acceleration),
        ("jerk", limits.jerk),
    ];
    for (order, (what, bound)) in bounds.into_iter().enumerate() {
        let mut slopes = Vec::with_capacity(times.len() + 1);
        let mut middles = Vec::with_capacity(times.len() + 1);
        if order > 0 {
            // From rest one interval before, to rest one after.
            let (first, last) = (
                times[1] - times[0],
                times[times.len() - 1] - times[times.len() - 2],
            );
            times.insert(0, times[0] - first);
            values.insert(0, 0.0);
            times.push(times[times.len() - 1] + last);
            values.push(0.0);
        }
        for k in 1..times.len() {
            slopes.push((values[k] - values[k - 1]) / (times[k] - times[k - 1]));
            middles.push(0.5 * (times[k] + times[k - 1]));
        }
        let most = bound * (1.0 + ROUNDING);
        if let Some(k) = slopes.iter().position(|slope| !(slope.abs() <= most)) {
            let point = k
                .saturating_sub(order.saturating_sub(1))
                .min(trajectory.points.len() - 1);
            return Some((what, point, slopes[k], [-bound, bound]));
        }
        (times, values) = (middles, slopes);
        if times.len() < 2 {
            break;
        }
    }
    None
}
