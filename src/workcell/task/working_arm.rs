//! Motions and grips of an arm in a task, with a log folder for each motion.

use super::error::WorkError;
use super::stopped::LaidAlong;
use super::workplace::Workplace;
use crate::cell::{ArmGuard, Fingers};
use rodlab_files::results::write_whole;
use rodlab_robot::{
    Ending, JointState, JointTrajectory, Moving, Pose, StreamLog, StreamState, Supervisor, stream,
};
use std::time::Duration;

/// Longest wait for a gripper.
const GRIPPER: Duration = Duration::from_secs(20);
/// Time in which a released rod or sheet comes to rest.
const SETTLING: Duration = Duration::from_secs(3);

/// An arm of a cell that does a task.
#[derive(Clone, Copy)]
pub struct WorkingArm<'a> {
    /// Cell and directory of the task; each motion has a folder in the directory.
    pub at: &'a Workplace<'a>,
    /// Index of the arm.
    pub arm: usize,
}

/// Command of a gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// Close.
    Close,
    /// Open.
    Open,
}

impl WorkingArm<'_> {
    /// Streams a motion of this arm, or of this arm and others. Writes its trajectory and log to a
    /// folder `name`.
    ///
    /// # Errors
    /// The motion cannot be done, or failed; all arms were commanded to hold.
    pub fn follow(&self, name: &str, motion: &JointTrajectory) -> Result<(), WorkError> {
        self.stream(name, motion, None, None)
    }

    /// Streams a motion with an object in the gripper. Fails if the object slips out, which is
    /// detected if the cell file names the joint of the fingers.
    ///
    /// # Errors
    /// Errors of [`Self::follow`], or the object slipped out.
    pub fn carry(&self, name: &str, motion: &JointTrajectory) -> Result<(), WorkError> {
        self.hold(name, motion, None)
    }

    /// Streams a motion that lays a rod along a path, see [`Self::carry`].
    ///
    /// # Errors
    /// Errors of [`Self::carry`].
    pub fn lay(
        &self,
        name: &str,
        motion: &JointTrajectory,
        along: &LaidAlong<'_>,
    ) -> Result<(), WorkError> {
        self.hold(name, motion, Some(along))
    }

    fn hold(
        &self,
        name: &str,
        motion: &JointTrajectory,
        along: Option<&LaidAlong<'_>>,
    ) -> Result<(), WorkError> {
        let fingers = self.at.cell.fingers(self.arm).map_err(WorkError::Failed)?;
        if fingers.as_ref().is_some_and(|fingers| !fingers.hold()) {
            return Err(WorkError::failed(
                "its fingers hold nothing: the object slipped out of the gripper, or was never grasped",
            ));
        }
        self.stream(name, motion, fingers.as_ref(), along)
    }

    fn stream(
        &self,
        name: &str,
        motion: &JointTrajectory,
        fingers: Option<&Fingers>,
        along: Option<&LaidAlong<'_>>,
    ) -> Result<(), WorkError> {
        let motion = &motion.scaled(self.at.speed_scale);
        let folder = self.at.directory.join(name);
        let unwritable = |error: std::io::Error| {
            WorkError::Failed(format!("{} cannot be written: {error}", folder.display()))
        };
        std::fs::create_dir_all(&folder).map_err(unwritable)?;
        let table = motion.to_csv().map_err(WorkError::failed)?;
        let written = write_whole(&folder.join("trajectory.csv"), table.as_bytes());
        written.map_err(WorkError::failed)?;
        let prepared = self.at.cell.prepare_stream(std::slice::from_ref(motion));
        let (mut parts, _) = prepared.map_err(WorkError::Failed)?;
        let mut log = StreamLog::open(&folder).map_err(unwritable)?;
        self.at.mark(self.arm)?;
        let watched = WatchedMotion {
            guard: ArmGuard::new(self.at.cell),
            arm: self,
            motion,
            fingers,
            along,
        };
        let ending = stream(&mut parts, &self.at.cell.streaming, &watched, &mut log);
        let logged = log.finish();
        match ending {
            Ending::Finished => logged.map_err(unwritable),
            Ending::Interrupted => Err(watched
                .slipped()
                .map_or(WorkError::Interrupted, WorkError::Failed)),
            Ending::Failed(reason) => Err(WorkError::Failed(reason)),
        }
    }

    /// Moves to joint positions along a straight line in joint space. The hand moves at `speed`,
    /// m/s, at most.
    ///
    /// # Errors
    /// Errors of [`Self::follow`].
    pub fn go(&self, name: &str, joints: &[f64], speed: f64) -> Result<(), WorkError> {
        let way = self.way_to(joints, speed)?;
        way.map_or(Ok(()), |way| self.follow(name, &way))
    }

    /// Moves to joint positions with an object in the gripper, see [`Self::carry`].
    ///
    /// # Errors
    /// Errors of [`Self::carry`].
    pub fn lead(&self, name: &str, joints: &[f64], speed: f64) -> Result<(), WorkError> {
        let way = self.way_to(joints, speed)?;
        way.map_or(Ok(()), |way| self.carry(name, &way))
    }

    /// Moves the arm home, so that the camera sees the result. If something is in the way, the arm
    /// stays where it is, since the work is done.
    ///
    /// # Errors
    /// The motion started, but did not finish.
    pub fn go_home(&self, name: &str, speed: f64) -> Result<(), WorkError> {
        let Some(way) = self.way_to(&self.at.cell.arms[self.arm].home, speed)? else {
            return Ok(());
        };
        if let Err(reason) = self.at.cell.prepare_stream(std::slice::from_ref(&way)) {
            tracing::warn!("the arm stays where it is, perhaps in the picture: {reason}");
            return Ok(());
        }
        self.follow(name, &way)
    }

    fn way_to(&self, joints: &[f64], speed: f64) -> Result<Option<JointTrajectory>, WorkError> {
        let from = self.at.cell.stands(self.arm).map_err(WorkError::Failed)?;
        let way = self.at.cell.approach(self.arm, &from, joints, speed);
        way.map_err(WorkError::failed)
    }

    /// Closes or opens the gripper.
    ///
    /// # Errors
    /// The arm has no gripper, or the gripper failed.
    pub fn grip(&self, grip: Grip) -> Result<(), WorkError> {
        let Some((gripper, [open, closed])) = self.at.cell.gripper(self.arm) else {
            return Err(WorkError::failed("the arm has no gripper in the cell file"));
        };
        let opening = match grip {
            Grip::Close => closed,
            Grip::Open => open,
        };
        let _moving = Moving::begin();
        self.at.check()?;
        let moved = gripper.command(opening, GRIPPER, &|| self.at.is_ended());
        moved.map_err(|error| match self.at.check() {
            Err(ended) => ended,
            Ok(()) => WorkError::failed(error),
        })
    }

    /// Opens the gripper, and waits until the released rod or sheet is at rest, see
    /// [`Self::rest`].
    ///
    /// # Errors
    /// The gripper did not open, or the user interrupted the task.
    pub fn let_go(&self) -> Result<(), WorkError> {
        self.grip(Grip::Open)?;
        self.rest(SETTLING)
    }

    /// Waits for `duration`, on the clock of the robot if it has one.
    ///
    /// # Errors
    /// The user interrupted the task.
    pub fn rest(&self, duration: Duration) -> Result<(), WorkError> {
        self.at
            .cell
            .rest(self.arm, duration, &|| self.at.is_ended());
        self.at.check()
    }

    /// Pose of the hand in the cell, at the joint positions that the driver reports.
    ///
    /// # Errors
    /// The driver does not report.
    pub fn hand(&self) -> Result<Pose, WorkError> {
        let joints = self.at.cell.stands(self.arm).map_err(WorkError::Failed)?;
        Ok(self.at.cell.arms[self.arm].hand(&joints))
    }
}

/// A motion that ends when the user interrupts it or the object slips out, and that is shown.
struct WatchedMotion<'a> {
    guard: ArmGuard<'a>,
    arm: &'a WorkingArm<'a>,
    motion: &'a JointTrajectory,
    fingers: Option<&'a Fingers>,
    along: Option<&'a LaidAlong<'a>>,
}

impl WatchedMotion<'_> {
    /// The reason why the object is lost; `None` if the gripper holds it.
    fn slipped(&self) -> Option<String> {
        self.fingers.and_then(Fingers::slipped)
    }
}

impl Supervisor for WatchedMotion<'_> {
    fn is_interrupted(&self) -> bool {
        (self.arm.at.is_interrupted)() || self.slipped().is_some()
    }

    fn forbids(&self) -> Option<String> {
        self.arm.at.forbidden()
    }

    fn refuses(&self, part: &str, time: f64, state: &JointState) -> Option<String> {
        self.arm.at.display.joints(part, &state.positions);
        self.guard.fault(part, time, state)
    }

    fn pace(&self) -> f64 {
        self.arm.at.pace()
    }

    fn show(&self, state: &StreamState) {
        let WorkingArm { at, arm } = self.arm;
        let laid = self.along.and_then(|along| {
            let begin = self.motion.times.first()?;
            let passed = (self.motion.times).partition_point(|time| time - begin <= state.time);
            let joints = self.motion.points.get(passed.saturating_sub(1))?;
            Some(along.at(&at.cell.arms[*arm].hand(joints)))
        });
        at.display.motion(state, laid);
    }
}
