//! Checks of limits before the first point is sent, for the points and for the cubics that
//! controllers interpolate between them.

use crate::chain::Limits;
use crate::driver::{Interpolant, PartTrajectory};
use std::fmt;

/// Fraction of a limit by which rounding in a table may exceed it.
const ROUNDING: f64 = 0.01;
/// Allowed overshoot of the acceleration of a spline through samples, as a fraction of the jump of
/// the jerk times the time between samples.
const OVERSHOOT: f64 = 0.15;
/// Largest allowed overshoot, as a fraction of the limit.
const MOST_OVERSHOOT: f64 = 0.05;
/// Tolerance of limits for cubics, rad or m; it allows for rounding in a motion along a limit.
const POSITION_ROUNDING: f64 = 1e-5;

/// A point that must not be sent.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Name of the joint.
    pub joint: String,
    /// Index of the point.
    pub point: usize,
    /// Whether the fault is between this point and the next, on the cubic that a controller
    /// interpolates.
    pub is_between: bool,
    /// The quantity that exceeds its limit.
    pub what: &'static str,
    /// Value of the quantity, in rad or m and seconds.
    pub value: f64,
    /// The limit.
    pub allowed: [f64; 2],
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.allowed;
        let (joint, what, value) = (&self.joint, self.what, self.value);
        write!(formatter, "{joint}: {what} {value:.6} ")?;
        let point = self.point + 1;
        match self.is_between {
            false => write!(formatter, "at point {point}")?,
            true => write!(
                formatter,
                "between points {point} and {}, as controllers put cubics between points",
                point + 1
            )?,
        }
        write!(formatter, "; allowed: {low:.6} to {high:.6}")
    }
}

/// Checks positions, velocities, accelerations and jerks of a part against limits, one per joint.
/// Derivatives are differences of neighbouring points, with rest before the first and after the
/// last point. The cubics between the points are checked, too ([`PartTrajectory::interpolant`]).
///
/// # Errors
/// The first fault of each joint.
pub fn check(trajectory: &PartTrajectory, limits: &[Limits]) -> Result<(), Vec<Fault>> {
    let cubics = trajectory.interpolant();
    let mut faults = Vec::new();
    for (index, limits) in limits.iter().enumerate() {
        let fault = |is_between: bool, (what, point, value, allowed): Found| Fault {
            joint: trajectory.joints[index].clone(),
            point,
            is_between,
            what,
            value,
            allowed,
        };
        let at_points = first_fault(trajectory, index, limits).map(|found| fault(false, found));
        let between = || first_fault_between(&cubics, index, limits);
        faults.extend(at_points.or_else(|| between().map(|found| fault(true, found))));
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

/// The quantity that exceeds a limit, the index of its point, its value, and the limit.
pub(super) type Found = (&'static str, usize, f64, [f64; 2]);

pub(super) fn first_fault_between(
    cubics: &Interpolant,
    joint: usize,
    limits: &Limits,
) -> Option<Found> {
    let count = cubics.times().len();
    (1..count).find_map(|k| {
        let cubic = cubics.cubic(joint, k - 1, k);
        let [low, high] = cubic.range();
        let position = if limits.upper - high < low - limits.lower {
            high
        } else {
            low
        };
        let range = limits.lower - POSITION_ROUNDING..=limits.upper + POSITION_ROUNDING;
        if !range.contains(&position) {
            return Some(("position", k - 1, position, [limits.lower, limits.upper]));
        }
        let velocity = cubic.fastest();
        if !(velocity.abs() <= limits.velocity * (1.0 + ROUNDING)) {
            let allowed = [-limits.velocity, limits.velocity];
            return Some(("velocity", k - 1, velocity, allowed));
        }
        let spacing = cubics.times()[k] - cubics.times()[k - 1];
        let overshoot =
            (OVERSHOOT * limits.jerk * spacing).min(MOST_OVERSHOOT * limits.acceleration);
        let most = limits.acceleration * (1.0 + ROUNDING) + overshoot;
        let steep = cubic
            .accelerations()
            .into_iter()
            .find(|a| !(a.abs() <= most));
        let allowed = [-limits.acceleration, limits.acceleration];
        steep.map(|acceleration| ("acceleration", k - 1, acceleration, allowed))
    })
}

fn first_fault(trajectory: &PartTrajectory, joint: usize, limits: &Limits) -> Option<Found> {
    let outside = trajectory
        .points
        .iter()
        .position(|point| !limits.allow(point[joint]));
    if let Some(point) = outside {
        let position = trajectory.points[point][joint];
        return Some(("position", point, position, [limits.lower, limits.upper]));
    }
    // Times and values of each derivative, which is zero before and after the motion.
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
            // The motion starts from rest one interval earlier, and ends at rest one interval
            // later.
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
