//! The motions of a deployment, planned and checked before anything moves.

use crate::cell::{Cell, Place, PlanError, PlanReport, PlanRequest};
use crate::robot::{JointTrajectory, Pose, pose};
use crate::vision::Point;
use nalgebra::Translation3;

/// Points per second of the motion.
const RATE: u32 = 100;

/// What is to be planned.
pub struct MotionRequest<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// Poses of the gripper in the frame of the pattern.
    pub poses: &'a [Pose],
    /// Where that frame lies in the cell.
    pub place: Place,
    /// Greatest speed of the hand, m/s.
    pub speed: f64,
    /// Least distance to anything else, m.
    pub margin: f64,
}

/// A planned motion.
pub struct DeployMotion {
    /// The joints while the rod is laid.
    pub laying: JointTrajectory,
    /// Its numbers.
    pub report: PlanReport,
    /// The frame of the pattern in the cell.
    pub frame: Pose,
}

impl MotionRequest<'_> {
    /// Plans the laying.
    ///
    /// # Errors
    /// The path cannot be followed.
    pub fn plan(&self) -> Result<DeployMotion, PlanError> {
        let plan = self.cell.plan(&PlanRequest {
            arm: self.arm,
            path: self.poses.to_vec(),
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

/// The place at which the middle of a pattern, m, lies in the middle of the table; `None` without a table.
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
