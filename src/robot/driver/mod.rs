//! Drivers of arms and axes, with a common trait.
//!
//! A driver is polled by the stream's loop every few milliseconds. Only [`Driver::connect`] may
//! wait. The other methods return at once, and read for at most [`READING`], however much arrives.

mod action_driver;
mod camera_name;
mod clocked_reports;
mod diagnostics;
mod diagnostics_name;
mod file;
mod follow_joint_trajectory;
mod gripper_goal;
mod interpolant;
mod part_trajectory;
mod picture;
mod ros1;
mod ros2;
mod rosbridge;
mod rosbridge_camera;
mod rosbridge_goal;
mod rosbridge_gripper;
mod rosbridge_signal;
mod rosbridge_socket;
mod signal;
mod signal_name;
mod stepper;
mod topic_name;

pub use camera_name::{CameraError, open_camera};
pub use diagnostics::{DiagnosticLevel, DiagnosticStatus, DiagnosticTopic};
pub use diagnostics_name::open_diagnostics;
pub use file::FileDriver;
pub use interpolant::Interpolant;
pub(crate) use interpolant::range_of;
pub use part_trajectory::PartTrajectory;
pub use picture::{CameraPicture, PictureTopic};
pub use ros1::{Bag, BagError, BagPicture, Ros1Camera, Ros1Driver, Ros1Gripper};
pub use ros2::{Middleware, Ros2Address, Ros2GripperAddress, Ros2Topic};
pub use rosbridge::RosbridgeDriver;
pub use rosbridge_camera::RosbridgeCamera;
pub use rosbridge_goal::RosVersion;
pub use rosbridge_gripper::RosbridgeGripper;
pub use signal::{Reading, Shape as SignalShape, SignalMessage, SignalTopic};
pub use signal_name::open_signal;
pub use stepper::{SerialLine, StepperAnswer, StepperDriver, StepperLink, StepperRequest};
pub use topic_name::TopicName;

use std::time::{Duration, Instant};

/// A report of joint positions.
#[derive(Clone, Debug, PartialEq)]
pub struct JointState {
    /// When the report was received.
    pub received: Instant,
    /// Time of the report on the clock of the robot, s, if it has one.
    pub stamp: Option<f64>,
    /// Positions in the order of the trajectory's joints, rad or m.
    pub positions: Vec<f64>,
    /// Efforts in the same order, N m or N; empty if not all joints report one.
    pub efforts: Vec<f64>,
}

impl JointState {
    /// Positions and efforts of `joints` in a message received now; `position` and `effort` return
    /// those of the joint with an index in `names`. A message may name more joints, in another
    /// order. `None` if a position is missing, since such a message concerns another part of the
    /// robot.
    fn heard<Name: PartialEq<str>>(
        joints: &[String],
        names: &[Name],
        position: impl Fn(usize) -> Option<f64>,
        effort: impl Fn(usize) -> Option<f64>,
    ) -> Option<Self> {
        let all = |number: &dyn Fn(usize) -> Option<f64>| {
            let numbers = joints.iter().map(|joint| {
                let index = names.iter().position(|name| *name == **joint)?;
                number(index)
            });
            numbers.collect::<Option<Vec<f64>>>()
        };
        Some(Self {
            received: Instant::now(),
            stamp: None,
            positions: all(&position)?,
            efforts: all(&effort).unwrap_or_default(),
        })
    }
}

/// Longest time for which a driver reads messages at a time, so that a peer that sends endlessly
/// cannot block the loop.
pub const READING: Duration = Duration::from_millis(2);
/// Largest number of messages that a driver reads at a time.
const MOST_MESSAGES: usize = 200;

/// Calls `read` until it returns `false`, for [`READING`] and [`MOST_MESSAGES`] at most.
///
/// # Errors
/// The errors of `read`.
fn read_within_bounds<E>(mut read: impl FnMut() -> Result<bool, E>) -> Result<(), E> {
    let begin = Instant::now();
    for _ in 0..MOST_MESSAGES {
        if !read()? || begin.elapsed() > READING {
            break;
        }
    }
    Ok(())
}

/// Progress of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The motion is running.
    Running,
    /// The motion has succeeded.
    Done,
}

impl Progress {
    /// The progress of a motion that may be over.
    pub(crate) fn over(is_over: bool) -> Self {
        match is_over {
            true => Self::Done,
            false => Self::Running,
        }
    }
}

/// An error of a driver, with advice for the user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DriverError {
    /// The other end does not answer.
    #[error("{0}")]
    Lost(String),
    /// The other end rejected the motion.
    #[error("{0}")]
    Refused(String),
    /// The other end aborted the motion.
    #[error("{0}")]
    Aborted(String),
}

/// Driver of a gripper.
pub trait GripperDriver {
    /// Moves the fingers to an opening, m, and waits until they arrive or hold an object.
    ///
    /// # Errors
    /// The gripper is not connected, rejects the command or does not answer in time, or the user
    /// interrupts; the command is then cancelled.
    fn command(
        &self,
        opening: f64,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError>;
}

/// Driver of an arm or an axis.
pub trait Driver: Send {
    /// Connects for motions of the given joints. Can be called again after a lost connection.
    ///
    /// # Errors
    /// No answer from the server within a few seconds.
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError>;

    /// Whether the driver reports joint positions. If not, [`Driver::state`] is always `None`.
    fn reports_state(&self) -> bool;

    /// Whether its reports are measured positions rather than commanded ones. A motor without a
    /// sensor reports commanded ones, and starts a motion at its present position.
    fn knows_position(&self) -> bool {
        self.reports_state()
    }

    /// The last report of the joints; `None` before the first. Reads what has arrived, for 2 ms at most.
    ///
    /// # Errors
    /// The connection is lost.
    fn state(&mut self) -> Result<Option<JointState>, DriverError>;

    /// The last setpoint that the controller reported in the feedback of the motion, if there is
    /// one.
    fn setpoint(&self) -> Option<&JointState> {
        None
    }

    /// Time of the robot's own clock, s, if it has one, and the time of reception. A simulated
    /// robot may be faster or slower than real time.
    fn clock(&self) -> Option<(f64, Instant)> {
        None
    }

    /// Whether the other end executes a goal by itself, even after this program has ended.
    fn sends_goals(&self) -> bool {
        false
    }

    /// Starts a motion at once. If [`Driver::sends_goals`], it replaces the current motion, and
    /// its first time may be later than zero.
    ///
    /// # Errors
    /// The connection is lost.
    fn start(&mut self, motion: &Interpolant) -> Result<(), DriverError>;

    /// Whether the other end has accepted the motion.
    fn is_accepted(&self) -> bool {
        true
    }

    /// Continues the motion, `elapsed` seconds after its start.
    ///
    /// # Errors
    /// The connection is lost, or the other end rejects or aborts the motion.
    fn advance(&mut self, elapsed: f64) -> Result<Progress, DriverError>;

    /// Requests the end of the last motion, whether or not the other end has reported that it is
    /// over, and returns without waiting for an answer. Only joint reports show that the joints
    /// are at rest.
    ///
    /// # Errors
    /// The request could not be sent.
    fn stop(&mut self) -> Result<(), DriverError>;
}
