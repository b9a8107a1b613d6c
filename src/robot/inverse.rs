//! Inverse kinematics of any chain: Levenberg–Marquardt steps inside the limits, from one or from many postures.
//!
//! The step is dq = Jᵀ (J Jᵀ + λ 1)⁻¹ e with the error e of the hand and λ = |e|²/2 + 10⁻¹²
//! (Sugihara 2011, Eq. 19). The step is damped far from the solution and at singularities, and is
//! Newton's step near the solution. A joint that would leave its range is held at its limit, and
//! the step is recomputed for the others.
//!
//! Further postures are tried in the order of a low-discrepancy sequence (Roberts' generalised
//! golden ratio), so that results are reproducible.

use super::chain::{Chain, JointKind};
use super::pose::{Pose, difference, distance_and_angle};
use nalgebra::{Cholesky, Vector6};

/// Error at which a pose counts as reached, m and rad.
pub const REACHED: f64 = 1e-9;
/// Largest number of steps from one posture.
const STEPS: usize = 60;
/// Longest step of a joint, rad or m.
const LONGEST_STEP: f64 = 0.7;
/// Number of initial postures before a pose counts as out of reach.
const STARTS: usize = 400;
/// [`Chain::branches`] stops after this many postures in a row without a new solution.
const FRUITLESS_STARTS: usize = 300;
/// Solutions are the same if all joints are closer than this, rad or m.
const SAME: f64 = 1e-4;

/// The nearest posture to an unreachable pose.
#[derive(Clone, Debug)]
pub struct Nearest {
    /// Joint positions.
    pub joints: Vec<f64>,
    /// Pose of the hand in the base frame.
    pub hand: Pose,
    /// Distance to the requested pose, m.
    pub distance: f64,
    /// Angle to it, rad.
    pub angle: f64,
}

impl Chain {
    /// Joint positions within the limits that bring the hand to a pose in the base frame, within
    /// [`REACHED`]. They are near the given ones if the steps converge from there; otherwise they
    /// may be anywhere.
    ///
    /// # Errors
    /// If no posture reaches the pose: the nearest posture found.
    pub fn reach(&self, target: &Pose, from: &[f64]) -> Result<Vec<f64>, Nearest> {
        let mut best: Option<(f64, Vec<f64>)> = None;
        let starts = std::iter::once(from.to_vec()).chain((1..=STARTS).map(|k| self.start(k)));
        for start in starts {
            let (joints, error) = self.approach(target, start);
            if error < REACHED {
                return Ok(joints);
            }
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                best = Some((error, joints));
            }
        }
        let joints = best.map_or_else(|| from.to_vec(), |(_, joints)| joints);
        Err(self.nearest(target, joints))
    }

    /// Joint positions that bring the hand to a pose by steps from the given ones only; `None` if
    /// they do not converge to it.
    pub fn follow(&self, target: &Pose, from: &[f64]) -> Option<Vec<f64>> {
        let (joints, error) = self.approach(target, from.to_vec());
        (error < REACHED).then_some(joints)
    }

    /// All isolated postures that bring the hand to a pose, sorted. Joints with a range of more
    /// than one turn are returned in the turn nearest to zero. Intended for chains without
    /// redundancy.
    ///
    /// The search runs from many initial postures until 300 in a row give no new solution. This is
    /// not exhaustive: a posture with a tiny basin of attraction can be missed.
    pub fn branches(&self, target: &Pose) -> Vec<Vec<f64>> {
        let mut found: Vec<Vec<f64>> = Vec::new();
        let (mut start, mut fruitless) = (0, 0);
        while fruitless < FRUITLESS_STARTS {
            start += 1;
            fruitless += 1;
            let (mut joints, error) = self.approach(target, self.start(start));
            if error >= REACHED {
                continue;
            }
            self.unwind(&mut joints);
            if !found.iter().any(|known| self.same(known, &joints)) {
                found.push(joints);
                fruitless = 0;
            }
        }
        found.sort_by(|a, b| {
            let pairs = a.iter().zip(b);
            pairs
                .map(|(a, b)| a.total_cmp(b))
                .find(|order| order.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        found
    }

    /// The `k`-th posture of the low-discrepancy sequence.
    pub fn start(&self, k: usize) -> Vec<f64> {
        let count = self.joints.len();
        // The root greater than 1 of x^(n+1) = x + 1.
        let mut root = 1.5_f64;
        for _ in 0..60 {
            root = libm::pow(1.0 + root, 1.0 / (count as f64 + 1.0));
        }
        self.joints
            .iter()
            .enumerate()
            .map(|(index, joint)| {
                let part = (0.5 + k as f64 * root.powi(-(index as i32 + 1))).fract();
                let (lower, upper) = joint.limits.search_range();
                lower + part * (upper - lower)
            })
            .collect()
    }

    fn nearest(&self, target: &Pose, joints: Vec<f64>) -> Nearest {
        let hand = self.hand(&joints);
        let (distance, angle) = distance_and_angle(&hand, target);
        Nearest {
            joints,
            hand,
            distance,
            angle,
        }
    }

    /// Steps towards a pose; returns the final positions and the norm of the error at the end, m
    /// and rad combined.
    fn approach(&self, target: &Pose, mut joints: Vec<f64>) -> (Vec<f64>, f64) {
        for (joint, q) in self.joints.iter().zip(&mut joints) {
            *q = q.clamp(joint.limits.lower, joint.limits.upper);
        }
        let (mut least, mut stalled) = (f64::INFINITY, 0);
        let mut best = joints.clone();
        for _ in 0..STEPS {
            let (hand, jacobian) = self.hand_and_jacobian(&joints);
            let error = difference(&hand, target);
            let norm = error.norm();
            if norm < least {
                // Stops when a step makes no significant progress.
                stalled = if norm > 0.98 * least { stalled + 1 } else { 0 };
                least = norm;
                best.copy_from_slice(&joints);
            } else {
                stalled += 1;
            }
            if least < 1e-13
                || (least < REACHED && norm > 0.1 * least && stalled > 0)
                || stalled > 6
            {
                break;
            }
            let columns = jacobian.columns();
            let mut held = [false; super::chain::MOST_JOINTS];
            let step = loop {
                let step = damped_step(columns, &held, &error);
                let mut more = false;
                for (k, (joint, q)) in self.joints.iter().zip(&joints).enumerate() {
                    let leaves = (*q <= joint.limits.lower && step[k] < 0.0)
                        || (*q >= joint.limits.upper && step[k] > 0.0);
                    if leaves && !held[k] {
                        held[k] = true;
                        more = true;
                    }
                }
                if !more {
                    break step;
                }
            };
            let longest = step.iter().fold(0.0_f64, |most, dq| most.max(dq.abs()));
            let scale = if longest > LONGEST_STEP {
                LONGEST_STEP / longest
            } else {
                1.0
            };
            for ((joint, q), dq) in self.joints.iter().zip(&mut joints).zip(step) {
                *q = (*q + scale * dq).clamp(joint.limits.lower, joint.limits.upper);
            }
        }
        (best, least)
    }

    /// Removes whole turns of joints, within their limits, so that they are nearest to zero.
    pub(super) fn unwind(&self, joints: &mut [f64]) {
        use std::f64::consts::{PI, TAU};
        for (joint, q) in self.joints.iter().zip(joints) {
            if joint.kind != JointKind::Revolute {
                continue;
            }
            let turned = *q - TAU * (*q / TAU).round();
            // At half a turn both signs are equally near; the positive one is used.
            let turned = if turned < -PI + 1e-9 {
                turned + TAU
            } else {
                turned
            };
            if joint.limits.allow(turned) {
                *q = turned;
            }
        }
    }

    fn same(&self, a: &[f64], b: &[f64]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME)
    }
}

/// The damped least-squares step of the joints that are not held.
fn damped_step(
    columns: &[Vector6<f64>],
    held: &[bool],
    error: &Vector6<f64>,
) -> [f64; super::chain::MOST_JOINTS] {
    let mut matrix = nalgebra::Matrix6::zeros();
    for (column, _) in columns.iter().zip(held).filter(|(_, held)| !**held) {
        matrix.ger(1.0, column, column, 1.0);
    }
    let damping = 0.5 * error.norm_squared() + 1e-12;
    for k in 0..6 {
        matrix[(k, k)] += damping;
    }
    let mut step = [0.0; super::chain::MOST_JOINTS];
    if let Some(factor) = Cholesky::new(matrix) {
        let weights = factor.solve(error);
        for (k, column) in columns.iter().enumerate().filter(|(k, _)| !held[*k]) {
            step[k] = column.dot(&weights);
        }
    }
    step
}
