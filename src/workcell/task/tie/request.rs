//! Request to two arms to tie a knot.

use crate::cell::{Cell, Place, PlanError, PlanReport, PlanRequest};
use rodlab_robot::Pose;

/// Points per second of motions.
pub const RATE: u32 = 100;

/// Request for the motions of a knot.
pub struct TieMotionRequest<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Indices of the arms: the one that lays the first rod, then the other one.
    pub arms: [usize; 2],
    /// Place of the frame of the patterns in the cell.
    pub place: Place,
    /// Greatest speed of a hand that holds the rod, m/s.
    pub speed: f64,
    /// Greatest speed of a hand that holds nothing, m/s.
    pub free_speed: f64,
    /// Least distance to anything else, m.
    pub margin: f64,
}

impl TieMotionRequest<'_> {
    /// Joint positions of one of the arms at rest.
    pub fn home(&self, which: usize) -> &Vec<f64> {
        &self.cell.arms[self.arms[which]].home
    }

    /// The best joint positions at the first pose of a path for one of the arms, and the numbers
    /// of the plan.
    ///
    /// # Errors
    /// The arm cannot follow the path.
    pub fn best(
        &self,
        which: usize,
        path: Vec<Pose>,
        place: Place,
    ) -> Result<(Vec<f64>, PlanReport), PlanError> {
        let plan = self.cell.plan(&PlanRequest {
            arm: self.arms[which],
            path,
            place,
            margin: self.margin,
            speed: self.speed,
            rate: RATE,
        })?;
        Ok((plan.trajectory.points[0].clone(), plan.report))
    }
}
