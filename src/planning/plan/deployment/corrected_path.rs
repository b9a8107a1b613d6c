//! A path of the gripper that is replanned during laying from the observed position of the rod.

use super::{
    DeployedRod, ObservedContact, OptimalGrasps, Scheme, corrected_length, return_curve, trajectory,
};
use crate::plan::pattern::PatternPoint;
use rodlab_engine::mechanics::kirchhoff::numerics::smooth_step;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Length of lying rod from which its end is observed, in gravito-bending lengths.
const WINDOW: f64 = 1.5;
/// Length before the last lying point, in gravito-bending lengths, that may already be lifted: z =
/// s³/8 there.
const RISEN: f64 = 0.2;
/// Fraction of the length between two corrections over which the gripper moves to the new path.
const TRANSITION: f64 = 0.5;
/// Smallest ratio of the return length to the length between two corrections.
const SHORTEST_RETURN: f64 = 3.0;
/// Largest curvature of the path in addition to that of its pattern, over 1/L_gb.
const LARGEST_CURVATURE: f64 = 0.3;
/// Difference of direction, rad, above which an observation is rejected.
const MOST_TURNED: f64 = 0.5;

/// The path of a gripper that lays a rod by the optimal scheme, with the estimated parameters of
/// the rod.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CorrectedPath {
    /// The estimated rod, and its initial L_gb, m.
    rod: DeployedRod,
    nominal: f64,
    /// Length between two corrections, and return length of the rod to the pattern, m.
    every: f64,
    return_length: f64,
    /// Length ahead that is replanned, m; `None` for the whole rest of the path.
    horizon: Option<f64>,
    /// The pattern.
    pattern: Vec<PatternPoint>,
    /// The target curve, and the poses of the gripper for it.
    aim: Vec<PatternPoint>,
    poses: Vec<(Vector3, UnitQuaternion)>,
    /// The last observed end of the rod.
    last: Option<ObservedContact>,
}

impl CorrectedPath {
    /// The initial path, with the `poses` for the points of the `pattern`. The rod is observed
    /// after every length `every`, m, and returns to the pattern over `return_length`, m.
    pub fn new(
        rod: DeployedRod,
        pattern: Vec<PatternPoint>,
        poses: Vec<(Vector3, UnitQuaternion)>,
        [every, return_length]: [f64; 2],
    ) -> Self {
        Self {
            nominal: rod.gravito_bending_length,
            rod,
            every,
            return_length,
            horizon: None,
            aim: pattern.clone(),
            pattern,
            poses,
            last: None,
        }
    }

    /// Replans only as far ahead as the rod needs to return to the pattern, and keeps the previous
    /// poses beyond. They are replanned after the next observation anyway, and replanning all of
    /// them takes longer.
    pub fn with_horizon(mut self) -> Self {
        self.horizon = Some(self.return_length + self.every);
        self
    }

    /// The estimated rod.
    pub fn rod(&self) -> &DeployedRod {
        &self.rod
    }

    /// The pattern.
    pub fn pattern(&self) -> &[PatternPoint] {
        &self.pattern
    }

    /// Position, m, and orientation of the gripper at the points of the pattern.
    pub fn poses(&self) -> &[(Vector3, UnitQuaternion)] {
        &self.poses
    }

    /// Length of lying rod from which its end is observed, m.
    pub fn window(&self) -> f64 {
        WINDOW * self.rod.gravito_bending_length
    }

    /// Length before the last lying point that may already be lifted, m.
    pub fn risen(&self) -> f64 {
        RISEN * self.rod.gravito_bending_length
    }

    /// Index of the pose of the next correction: the first one that is `every` farther along the pattern than pose `index`.
    pub fn after(&self, index: usize) -> usize {
        let wanted = self.pattern[index].s + self.every * (1.0 - 1e-9);
        self.pattern.partition_point(|point| point.s < wanted)
    }

    /// Whether an observation is plausible: within a gravito-bending length and half a radian of
    /// the target curve.
    pub fn is_plausible(&self, contact: &ObservedContact) -> bool {
        let after = self.aim.partition_point(|point| point.s < contact.s);
        self.aim.get(after).is_some_and(|aimed| {
            let off = (contact.position - aimed.position).norm();
            let turned = contact.angle - aimed.angle;
            let turned = turned - TAU * (turned / TAU).round();
            off < self.rod.gravito_bending_length && turned.abs() < MOST_TURNED
        })
    }

    /// Replans from pose `index` on, for an observed end of the rod at `contact`; the next
    /// observation is at pose `next`. Nothing changes if the pattern cannot be laid from there.
    pub fn correct(
        &mut self,
        index: usize,
        next: usize,
        contact: &ObservedContact,
        grasps: OptimalGrasps<'_>,
    ) {
        if let Some(last) = self.last.filter(|last| contact.s > last.s) {
            let aimed = last.carried(&self.aim, contact.s).angle - last.angle;
            let turned = contact.angle - last.angle;
            let turned = turned - TAU * ((turned - aimed) / TAU).round();
            let length = contact.s - last.s;
            self.rod.gravito_bending_length =
                corrected_length(&self.rod, self.nominal, [turned, aimed], length);
        }
        self.last = Some(*contact);
        let here = contact.carried(&self.aim, self.pattern[index].s);
        let next = self.pattern.get(next).unwrap_or(&self.pattern[index]);
        let laid = next.s - self.pattern[index].s;
        let curve = return_curve(
            &self.pattern[index..],
            &here,
            self.return_length.max(SHORTEST_RETURN * laid),
            LARGEST_CURVATURE / self.rod.gravito_bending_length,
        );
        let begin = self.pattern[index].s;
        let until = begin + self.horizon.unwrap_or(f64::INFINITY);
        let near = curve.partition_point(|point| point.s <= until);
        let planned = trajectory(&curve[..near], &self.rod, Scheme::Optimal, grasps);
        let Ok(planned) = planned else {
            return;
        };
        let transition = TRANSITION * self.every;
        let old = self.poses[index..].iter_mut();
        for ((pose, new), point) in old.zip(&planned).zip(&curve) {
            let there = ((point.s - begin) / transition).min(1.0);
            let back = if near < curve.len() {
                (until - point.s) / transition
            } else {
                1.0
            };
            let part = smooth_step(there.min(back));
            pose.0 += part * (new.position - pose.0);
            pose.1 = rotation::from_vector(
                part * rotation::to_vector(&(new.rotation * pose.1.inverse())),
            ) * pose.1;
        }
        self.aim.truncate(index);
        self.aim.extend(curve);
    }
}
