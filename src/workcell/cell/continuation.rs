//! A motion of an arm from its current joints along a new path.

use super::plan::{PlanError, STEP};
use super::resolved::Cell;
use nalgebra::Translation3;
use rodlab_robot::{JointTrajectory, LARGEST_JUMP, Pose, parametrise, subdivide};

impl Cell {
    /// Plans the motion of an arm along poses of its hand in the cell. The first pose is that of
    /// the joints `from`. The hand moves at `speed`, m/s, at most. The motion has `rate` points
    /// per second, a divisor of 1000. Collisions are checked when it is prepared for a stream.
    ///
    /// # Errors
    /// The hand cannot follow the path from these joints.
    pub fn continuation(
        &self,
        arm: usize,
        poses: &[Pose],
        from: &[f64],
        speed: f64,
        rate: u32,
    ) -> Result<JointTrajectory, PlanError> {
        let known = &self.arms[arm];
        let chain = &known.chain;
        let to_base = known.base.inverse();
        let poses: Vec<Pose> = poses.iter().map(|pose| to_base * pose).collect();
        let points = subdivide(&poses, STEP);
        let mut joints = vec![from.to_vec()];
        for point in points.iter().skip(1) {
            let before = &joints[joints.len() - 1];
            let next = chain.follow(&point.pose, before);
            let is_near = |next: &Vec<f64>| {
                let steps = next.iter().zip(before).map(|(a, b)| (a - b).abs());
                steps.fold(0.0, f64::max) <= LARGEST_JUMP
            };
            joints.push(next.filter(is_near).ok_or_else(|| {
                let [x, y, z] = (known.base * point.pose).translation.vector.into();
                PlanError::Path(format!(
                    "arm {}: its hand cannot reach {x:.4},{y:.4},{z:.4} from its current joints",
                    known.name
                ))
            })?);
        }
        let way: Vec<f64> = points.iter().map(|point| point.way).collect();
        let motion = parametrise(&joints, &way, &known.limits(), self.safety.planned(speed))?;
        Ok(self.sampled(arm, rate, &motion.samples))
    }

    /// Plans a motion in which the hand rises straight by a height, m.
    ///
    /// # Errors
    /// As [`Self::continuation`].
    pub(crate) fn rising(
        &self,
        arm: usize,
        height: f64,
        from: &[f64],
        speed: f64,
        rate: u32,
    ) -> Result<JointTrajectory, PlanError> {
        let hand = self.arms[arm].hand(from);
        let path = [hand, Translation3::new(0.0, 0.0, height) * hand];
        self.continuation(arm, &path, from, speed, rate)
    }
}
