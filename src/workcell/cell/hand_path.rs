//! Joint positions along poses of a hand from its current pose, and motions back and forth along a
//! part of them.
//!
//! [`Cell::plan`](super::Cell::plan) searches for the best of all joint paths. Here each posture
//! continues from the one before, so that the hand returns along the same joint path, and all
//! paths from the same posture begin with the same joints.

use super::plan::PlanError;
use super::resolved::Cell;
use super::sums::sums;
use rodlab_robot::{
    Column, JointKind, JointTrajectory, Pose, SAMPLE, distance_and_angle, parametrise,
};

/// Largest step of a joint from pose to pose, rad or m. A larger step means that a singularity is
/// near; it would be too fast for a rod.
const LARGEST_STEP: f64 = 0.15;
/// Length equivalent to a rotation by one radian, m.
const LENGTH_PER_RADIAN: f64 = 0.1;
/// Number of samples between two points of a trajectory.
const STRIDE: usize = 10;

/// Request for joints along poses of a hand.
pub struct HandPathRequest<'a> {
    /// Index of the arm.
    pub arm: usize,
    /// Joint positions at the first pose.
    pub from: Vec<f64>,
    /// Poses of the hand in the cell, near each other.
    pub poses: &'a [Pose],
    /// Least distance of the arm to anything else, m.
    pub margin: f64,
}

/// Joints along poses of a hand.
#[derive(Clone, Debug)]
pub struct HandPath {
    /// Joint positions at each pose, up to the last one that can be followed.
    pub joints: Vec<Vec<f64>>,
    /// Reason why the next pose cannot be followed; `None` if all can be followed.
    pub ends: Option<String>,
}

impl Cell {
    /// Follows poses from pose to pose, while the other arms are at rest.
    pub fn follow_poses(&self, request: &HandPathRequest<'_>) -> HandPath {
        let arm = &self.arms[request.arm];
        let surroundings = self.surroundings();
        let mut postures = surroundings.homes();
        let to_base = arm.base.inverse();
        let mut joints: Vec<Vec<f64>> = Vec::with_capacity(request.poses.len());
        let mut ends = None;
        for pose in request.poses {
            let before = joints.last().unwrap_or(&request.from);
            let Some(next) = arm.chain.follow(&(to_base * pose), before) else {
                ends = Some(format!("arm {} does not reach it", arm.name));
                break;
            };
            let steps = arm.chain.joints.iter().zip(next.iter().zip(before));
            let too_far = steps
                .filter(|(_, (now, then))| (*now - *then).abs() > LARGEST_STEP)
                .map(|(joint, _)| joint.name.as_str())
                .next();
            if let Some(joint) = too_far {
                ends = Some(format!(
                    "joint {joint} of arm {} would turn too fast: it is near a singularity",
                    arm.name
                ));
                break;
            }
            postures[request.arm].clone_from(&next);
            if let Some(near) = surroundings.nearest(&postures, Some(request.arm))
                && near.distance < request.margin
            {
                let [one, other] = near.between;
                ends = Some(format!("{one} comes too near to {other}"));
                break;
            }
            joints.push(next);
        }
        HandPath { joints, ends }
    }

    /// A motion of an arm and an external axis along joint positions of both; the axis is the last
    /// column. The motion begins and ends at rest, and stays at its last point for `rest`, s. The
    /// hand moves at `speed`, m/s, at most, and turns at ten times that number, rad/s, at most.
    ///
    /// # Errors
    /// A joint has no limit of acceleration or jerk.
    pub fn motion_along(
        &self,
        arm: usize,
        axis: usize,
        points: &[Vec<f64>],
        speed: f64,
        rest: f64,
    ) -> Result<JointTrajectory, PlanError> {
        let (arm, axis) = (&self.arms[arm], &self.axes[axis]);
        let count = arm.chain.joints.len();
        let way = sums(points.windows(2).map(|pair| {
            let [from, to] = [&pair[0], &pair[1]].map(|point| arm.chain.hand(&point[..count]));
            let (distance, angle) = distance_and_angle(&from, &to);
            let turned = (pair[1][count] - pair[0][count]).abs();
            libm::hypot(distance, LENGTH_PER_RADIAN * angle.max(turned))
        }));
        let limits = [&arm.limits()[..], &[axis.limits]].concat();
        let motion = parametrise(points, &way, &limits, self.safety.planned(speed))?;
        let columns = arm.columns().chain([Column {
            part: axis.name.clone(),
            joint: None,
            kind: JointKind::Revolute,
        }]);
        let last = motion.samples.len() - 1;
        let whole = last.div_ceil(STRIDE).max(1);
        let mut times: Vec<f64> = (0..=whole).map(|k| (k * STRIDE) as f64 * SAMPLE).collect();
        let at = |k: usize| motion.samples[(k * STRIDE).min(last)].clone();
        let mut points: Vec<Vec<f64>> = (0..=whole).map(at).collect();
        if rest > 0.0 {
            times.push(times[whole] + rest);
            points.push(motion.samples[last].clone());
        }
        Ok(JointTrajectory {
            columns: columns.collect(),
            times,
            points,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gantry() -> Cell {
        crate::test_cells::cell("helix_gantry")
    }

    /// Poses that begin at home, each moved by `step` from the one before.
    fn poses(cell: &Cell, count: usize, step: impl Fn(f64) -> Pose) -> Vec<Pose> {
        let arm = &cell.arms[0];
        let first = arm.hand(&arm.home);
        (0..count).map(|k| first * step(k as f64)).collect()
    }

    fn followed(cell: &Cell, poses: &[Pose]) -> HandPath {
        cell.follow_poses(&HandPathRequest {
            arm: 0,
            from: cell.arms[0].home.clone(),
            poses,
            margin: 5e-3,
        })
    }

    #[test]
    fn the_hand_follows_its_poses_until_a_joint_or_an_obstacle_ends_them() {
        let cell = gantry();
        let turning = |k: f64| {
            let turn = nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.0, 0.02 * k);
            Pose::from_parts(nalgebra::Translation3::new(-1e-3 * k, 0.0, 0.0), turn)
        };
        let wanted = poses(&cell, 400, turning);
        let path = followed(&cell, &wanted);
        assert_eq!((path.joints.len(), path.ends), (400, None));
        let arm = &cell.arms[0];
        for (joints, pose) in path.joints.iter().zip(&wanted) {
            let (distance, angle) = distance_and_angle(&arm.hand(joints), pose);
            assert!(distance < 1e-6 && angle < 1e-6);
        }
        // Only one joint turns the hand about z, without a limit at a full turn.
        assert!((path.joints[399][3] - 0.02 * 399.0).abs() < 1e-6);
        let sideways = poses(&cell, 200, |k| Pose::translation(0.0, 0.01 * k, 0.0));
        let path = followed(&cell, &sideways);
        assert_eq!(path.joints.len(), 71);
        assert!(path.ends.unwrap().contains("does not reach"));
        let to_chuck = poses(&cell, 200, |k| Pose::translation(-0.01 * k, 0.0, 0.0));
        let words = followed(&cell, &to_chuck).ends.unwrap();
        assert!(words.contains("comes too near to motor"), "{words}");
    }

    #[test]
    fn arm_and_axis_move_together_from_rest_to_rest() {
        let cell = gantry();
        let wanted = poses(&cell, 50, |k| Pose::translation(-2e-3 * k, 0.0, 0.0));
        let joints = followed(&cell, &wanted).joints;
        let with_axis = joints.into_iter().enumerate().map(|(k, mut joints)| {
            joints.push(0.04 * k as f64);
            joints
        });
        let points: Vec<Vec<f64>> = with_axis.collect();
        let motion = cell.motion_along(0, 0, &points, 0.05, 0.3).unwrap();
        let last = motion.points.len() - 1;
        assert_eq!(motion.columns[6].header(), "stepper_rad");
        assert!((motion.points[0][6], motion.points[last][6]) == (0.0, points[49][6]));
        assert!((motion.times[last] - motion.times[last - 1] - 0.3).abs() < 1e-12);
        // The axis, which turns by 1.96 rad at ten times the speed of the hand, sets the pace.
        assert!(motion.duration() > 1.96 / 0.5);
        for pair in motion.points.windows(2).zip(motion.times.windows(2)) {
            let (points, times) = pair;
            let speed = (points[1][6] - points[0][6]) / (times[1] - times[0]);
            assert!(speed <= 0.5 * 1.001, "{speed}");
        }
    }
}
