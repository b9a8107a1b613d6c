//! A path of a hand that goes on from where its arm stands.

use super::plan::PlanError;
use super::resolved::Cell;
use crate::robot::{JointTrajectory, Limits, Pose, parametrise, subdivide};

/// Distance of the points of a joint path, m, and a tenth of it in rad.
const STEP: f64 = 1e-3;
/// Samples of the motion from point to point of its trajectory: 100 points a second.
const STRIDE: usize = 10;
/// Largest step of a joint from point to point, rad or m.
const LARGEST_STEP: f64 = 0.05;

/// What is planned on from where an arm stands.
#[derive(Clone, Copy, Debug)]
pub struct Onwards<'a> {
    /// Index of the arm.
    pub arm: usize,
    /// Where its joints stand, rad or m.
    pub from: &'a [f64],
    /// Poses of the hand in the cell; the first one is where it is.
    pub path: &'a [Pose],
    /// Least distance to anything else, m.
    pub margin: f64,
    /// Greatest speed of the hand, m/s (and ten times it in rad/s).
    pub speed: f64,
}

impl Cell {
    /// A motion of an arm along a path of its hand from where its joints are, without a change of posture: each point is found
    /// from the one before (Newton's method). What holds something must not jump, as [`Cell::plan`] may at its first point.
    ///
    /// # Errors
    /// A pose cannot be reached so, a joint would jump, or something is too near.
    pub fn onwards(&self, request: &Onwards<'_>) -> Result<JointTrajectory, PlanError> {
        let arm = &self.arms[request.arm];
        let surroundings = self.surroundings();
        let mut postures = surroundings.homes();
        let to_base = arm.base.inverse();
        let poses: Vec<Pose> = request.path.iter().map(|pose| to_base * pose).collect();
        let points = subdivide(&poses, STEP);
        let mut joints: Vec<Vec<f64>> = vec![request.from.to_vec()];
        for point in &points {
            let last = &joints[joints.len() - 1];
            let lost = |why: &str| {
                let [x, y, z] = (arm.base * point.pose).translation.vector.into();
                PlanError::Path(format!(
                    "arm {}: from where it stands the hand does not come to {x:.4}, {y:.4}, {z:.4}: {why}",
                    arm.name
                ))
            };
            let next = arm.chain.follow(&point.pose, last);
            let next = next.ok_or_else(|| lost("no posture nearby reaches it"))?;
            let steps = next.iter().zip(last).map(|(a, b)| (a - b).abs());
            if joints.len() > 1 && steps.fold(0.0, f64::max) > LARGEST_STEP {
                return Err(lost("the joints would jump"));
            }
            postures[request.arm].clone_from(&next);
            if surroundings.clearance(&postures, Some(request.arm)) < request.margin {
                return Err(lost("something is too near"));
            }
            joints.push(next);
        }
        // The first point is where the arm is.
        joints.remove(0);
        let way: Vec<f64> = points.iter().map(|point| point.way).collect();
        let limits: Vec<Limits> = arm.chain.joints.iter().map(|joint| joint.limits).collect();
        let motion = parametrise(&joints, &way, &limits, request.speed)?;
        Ok(arm.sampled(&motion.samples, STRIDE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion, Vector3};
    use std::path::Path;

    fn gantry() -> Cell {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/cells/gantry.toml");
        Cell::read(&path).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Ways that lead a hand from where it is at home to other poses.
    fn onwards(cell: &Cell, moves: &[Pose]) -> Result<JointTrajectory, PlanError> {
        let arm = &cell.arms[0];
        let hand = arm.base * arm.chain.hand(&arm.home);
        let path: Vec<Pose> = moves.iter().map(|by| hand * by).collect();
        cell.onwards(&Onwards {
            arm: 0,
            from: &arm.home,
            path: &path,
            margin: 0.01,
            speed: 0.1,
        })
    }

    #[test]
    fn a_motion_begins_where_the_joints_are_and_ends_at_the_last_pose() {
        let cell = gantry();
        let arm = &cell.arms[0];
        let turned = Pose::from_parts(
            Translation3::new(0.05, 0.0, -0.1),
            UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.7),
        );
        let motion = onwards(&cell, &[Pose::identity(), turned]).unwrap();
        let [first, last] = [&motion.points[0], &motion.points[motion.points.len() - 1]];
        let away = first.iter().zip(&arm.home).map(|(a, b)| (a - b).abs());
        assert!(away.fold(0.0, f64::max) < 1e-9, "{first:?}");
        let hand = arm.base * arm.chain.hand(&arm.home) * turned;
        let away = hand.inverse() * arm.base * arm.chain.hand(last);
        assert!(away.translation.vector.norm() < 1e-7 && away.rotation.angle() < 1e-7);
    }

    #[test]
    fn what_is_out_of_reach_from_there_is_told() {
        let cell = gantry();
        let far = Pose::translation(0.0, 0.0, 3.0);
        let error = onwards(&cell, &[Pose::identity(), far]).unwrap_err();
        assert!(error.to_string().contains("no posture nearby"), "{error}");
    }
}
