//! An arm at work: its motions and grips, with the log of each in a folder.

use crate::cell::Cell;
use crate::results::{ResultsError, write_whole};
use crate::robot::{Ending, JointTrajectory, Pose, StreamLog, stream};
use std::path::Path;
use std::time::Duration;

/// Longest wait for a gripper.
const GRIPPER: Duration = Duration::from_secs(20);

/// An arm of a cell that does a task.
#[derive(Clone, Copy)]
pub struct WorkingArm<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Index of the arm.
    pub arm: usize,
    /// Where the logs are written.
    pub directory: &'a Path,
}

/// Why something was not done.
#[derive(Debug, thiserror::Error)]
pub enum WorkError {
    /// Something failed; the arm was told to hold.
    #[error("{0}")]
    Failed(String),
    /// Somebody asked for the end; the arm holds.
    #[error("interrupted; the arm holds")]
    Interrupted,
    /// A file could not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl WorkingArm<'_> {
    /// Streams a motion; its log is a folder of that name.
    ///
    /// # Errors
    /// It cannot be done, or was not.
    pub fn follow(
        &self,
        name: &str,
        trajectory: &JointTrajectory,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), WorkError> {
        let folder = self.directory.join(name);
        let unwritable = |error: std::io::Error| {
            WorkError::Failed(format!("{} cannot be written: {error}", folder.display()))
        };
        std::fs::create_dir_all(&folder).map_err(unwritable)?;
        let table = trajectory.to_csv();
        write_whole(&folder.join("trajectory.csv"), table.as_bytes())?;
        let prepared = self.cell.prepare_stream(std::slice::from_ref(trajectory));
        let (mut parts, _) = prepared.map_err(WorkError::Failed)?;
        let mut log = StreamLog::open(&folder).map_err(unwritable)?;
        let bounds = self.cell.stream_bounds();
        let ending = stream(&mut parts, &bounds, is_interrupted, &mut log);
        let logged = log.finish();
        match ending {
            Ending::Finished => logged.map_err(unwritable),
            Ending::Interrupted => Err(WorkError::Interrupted),
            Ending::Failed(reason) => Err(WorkError::Failed(reason)),
        }
    }

    /// Goes to joints, each straight from where it stands; its log is a folder of that name.
    ///
    /// # Errors
    /// It cannot be done, or was not.
    pub fn go(
        &self,
        name: &str,
        joints: &[f64],
        speed: f64,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), WorkError> {
        let way = self.way_to(joints, speed)?;
        way.map_or(Ok(()), |way| self.follow(name, &way, is_interrupted))
    }

    /// The same where nothing is in the way; otherwise the arm stays where it is. Whether it went.
    ///
    /// # Errors
    /// It was begun, and not done.
    pub fn go_if_free(
        &self,
        name: &str,
        joints: &[f64],
        speed: f64,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<bool, WorkError> {
        let Some(way) = self.way_to(joints, speed)? else {
            return Ok(true);
        };
        if let Err(reason) = self.cell.prepare_stream(std::slice::from_ref(&way)) {
            tracing::warn!("the arm stays where it is, perhaps in the picture: {reason}");
            return Ok(false);
        }
        self.follow(name, &way, is_interrupted).map(|()| true)
    }

    fn way_to(&self, joints: &[f64], speed: f64) -> Result<Option<JointTrajectory>, WorkError> {
        let from = self.cell.stands(self.arm).map_err(WorkError::Failed)?;
        let way = self.cell.approach(self.arm, &from, joints, speed);
        way.map_err(|error| WorkError::Failed(error.to_string()))
    }

    /// Closes or opens the gripper.
    ///
    /// # Errors
    /// There is none, or it did not.
    pub fn grip(&self, closes: bool, is_interrupted: &dyn Fn() -> bool) -> Result<(), WorkError> {
        let Some((gripper, [open, closed])) = self.cell.gripper(self.arm) else {
            let missing = "the arm has no gripper in the cell file";
            return Err(WorkError::Failed(missing.into()));
        };
        let opening = if closes { closed } else { open };
        let moved = gripper.command(opening, GRIPPER, is_interrupted);
        moved.map_err(|error| {
            if is_interrupted() {
                WorkError::Interrupted
            } else {
                WorkError::Failed(error.to_string())
            }
        })
    }

    /// Where its hand is in the cell, by what its driver reports.
    ///
    /// # Errors
    /// It reports nothing.
    pub fn hand(&self) -> Result<Pose, WorkError> {
        let joints = self.cell.stands(self.arm).map_err(WorkError::Failed)?;
        let arm = &self.cell.arms[self.arm];
        Ok(arm.base * arm.chain.hand(&joints))
    }
}
