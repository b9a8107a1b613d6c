//! The motions of a deployment, planned and checked before anything moves.

use super::room::is_in_room;
use crate::cell::{Cell, Place, PlanError, PlanReport, PlanRequest};
use nalgebra::Translation3;
use rodlab_planning::plan::deployment::{GripperPose, LaidPath, Spare};
use rodlab_robot::{JointTrajectory, Pose, pose};
use rodlab_vision::Point;

/// Points per second of the motion.
const RATE: u32 = 100;

/// Request for a motion.
pub struct MotionRequest<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// Place of the frame of the pattern in the cell.
    pub place: Place,
    /// Greatest speed of the hand, m/s.
    pub speed: f64,
    /// Least distance to anything else, m.
    pub margin: f64,
}

/// Fractions of the spare length of a rod that is longer than its pattern. The largest one that
/// the arm can lay is used.
const SPARE_PARTS: [f64; 3] = [1.0, 0.5, 0.0];

/// A planned motion.
pub struct DeployMotion {
    /// Joint trajectory while the rod is laid.
    pub laying: JointTrajectory,
    /// Numbers of the plan.
    pub report: PlanReport,
    /// The frame of the pattern in the cell.
    pub frame: Pose,
}

impl MotionRequest<'_> {
    /// Plans how an arm lays a rod along a path that fits the room on the table. If the rod is
    /// longer than its pattern, the arm lays as much of the rest as it can. Returns the motion
    /// with the other results of `path`.
    ///
    /// # Errors
    /// No path exists, or the arm cannot follow it.
    pub fn plan<T, E: From<PlanError>>(
        &self,
        path: impl Fn(&Spare<'_>) -> Result<(T, LaidPath), E>,
    ) -> Result<(T, LaidPath, DeployMotion), E> {
        let frame = self.place.pose();
        let mut parts = SPARE_PARTS.into_iter().peekable();
        loop {
            let spare = Spare {
                part: parts.next().unwrap_or_default(),
                is_free: &|place| frame.is_none_or(|frame| is_in_room(self.cell, &frame, place)),
            };
            let (rest, path) = path(&spare)?;
            match self.along(&path.poses) {
                Ok(motion) => return Ok((rest, path, motion)),
                Err(PlanError::Path(_)) if path.lays_spare && parts.peek().is_some() => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn along(&self, poses: &[GripperPose]) -> Result<DeployMotion, PlanError> {
        let poses = poses.iter();
        let poses =
            poses.map(|pose| Pose::from_parts(Translation3::from(pose.position), pose.rotation));
        let plan = self.cell.plan(&PlanRequest {
            arm: self.arm,
            path: poses.collect(),
            place: self.place,
            margin: self.margin,
            speed: self.speed,
            rate: RATE,
        })?;
        let report = plan.report;
        let frame = pose(report.place_position, report.place_quaternion);
        Ok(DeployMotion {
            laying: plan.trajectory,
            frame: frame.expect("the pose of a plan"),
            report,
        })
    }
}

/// The place that puts the middle of a pattern, m, in the middle of the table; `None` without a
/// table.
pub fn middle_of_table(cell: &Cell, pattern: &[Point]) -> Option<Place> {
    let table = cell.table?;
    let first = pattern.first()?;
    let low = pattern.iter().fold(*first, |low, point| low.inf(point));
    let high = pattern.iter().fold(*first, |high, point| high.sup(point));
    let middle = (low + high) * 0.5;
    let top = table.top.translation;
    let place = top * Translation3::new(-middle.x, -middle.y, 0.0);
    Some(Place::At([place.x, place.y, place.z, 0.0]))
}
