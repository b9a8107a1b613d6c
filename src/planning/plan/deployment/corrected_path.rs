//! A gripper's path that is planned anew, while a rod is laid, from where the rod is seen to lie.

use super::{
    DeployedRod, ObservedContact, OptimalGrasps, Scheme, corrected_length, return_curve, trajectory,
};
use crate::plan::pattern::PatternPoint;
use rodlab_engine::mechanics::kirchhoff::numerics::smooth_step;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Length of lying rod, in gravito-bending lengths, by which its end is seen.
const WINDOW: f64 = 1.5;
/// Length behind the last place that seems to lie, in gravito-bending lengths, which may have risen already: z = s³/8 there.
const RISEN: f64 = 0.2;
/// Part of the length between two corrections over which the gripper goes over to the new path.
const TRANSITION: f64 = 0.5;
/// Shortest length of return over that between two corrections.
const SHORTEST_RETURN: f64 = 3.0;
/// Largest curvature, over 1/L_gb, by which the rod is bent beside that of its pattern.
const LARGEST_CURVATURE: f64 = 0.3;
/// Difference of direction, rad, above which something else was seen.
const MOST_TURNED: f64 = 0.5;

/// The path of a gripper that lays a rod by the optimal scheme, with what is believed of the rod.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CorrectedPath {
    /// The rod as it is believed to be, and its L_gb at first, m.
    rod: DeployedRod,
    nominal: f64,
    /// Length between two corrections, and that over which the rod returns to the pattern, m.
    every: f64,
    return_length: f64,
    /// Length ahead that is planned anew, m; without one all.
    horizon: Option<f64>,
    /// The pattern.
    pattern: Vec<PatternPoint>,
    /// What is aimed at, and the gripper's poses for it.
    aim: Vec<PatternPoint>,
    poses: Vec<(Vector3, UnitQuaternion)>,
    /// Where the rod was seen to end last.
    last: Option<ObservedContact>,
}

impl CorrectedPath {
    /// The path as it was planned before, with the `poses` for the points of the `pattern`. The rod is looked at each length
    /// `every`, and returns to the pattern over `return_length`, m.
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

    /// Plans anew no farther ahead than the rod needs to return to the pattern, and goes back to the poses of before behind that:
    /// in the next look they are planned anew as well, and all of them take longer.
    pub fn with_horizon(mut self) -> Self {
        self.horizon = Some(self.return_length + self.every);
        self
    }

    /// The rod as it is believed to be.
    pub fn rod(&self) -> &DeployedRod {
        &self.rod
    }

    /// The pattern.
    pub fn pattern(&self) -> &[PatternPoint] {
        &self.pattern
    }

    /// Place, m, and orientation of the gripper at the points of the pattern.
    pub fn poses(&self) -> &[(Vector3, UnitQuaternion)] {
        &self.poses
    }

    /// Length of lying rod by which its end is seen, m.
    pub fn window(&self) -> f64 {
        WINDOW * self.rod.gravito_bending_length
    }

    /// Length behind the last place that seems to lie which may have risen already, m.
    pub fn risen(&self) -> f64 {
        RISEN * self.rod.gravito_bending_length
    }

    /// Index of the first pose that is the length between two corrections further along the pattern than another one.
    pub fn after(&self, index: usize) -> usize {
        let wanted = self.pattern[index].s + self.every * (1.0 - 1e-9);
        self.pattern.partition_point(|point| point.s < wanted)
    }

    /// Whether a rod may have been seen so: within a gravito-bending length and half a radian of what is aimed at.
    pub fn is_plausible(&self, contact: &ObservedContact) -> bool {
        let after = self.aim.partition_point(|point| point.s < contact.s);
        self.aim.get(after).is_some_and(|aimed| {
            let off = (contact.position - aimed.position).norm();
            let turned = contact.angle - aimed.angle;
            let turned = turned - TAU * (turned / TAU).round();
            off < self.rod.gravito_bending_length && turned.abs() < MOST_TURNED
        })
    }

    /// Plans anew from pose `index` on, where the rod has been seen to end at `contact`; the next look comes at pose `next`.
    /// Nothing changes where the pattern cannot be laid from there.
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
