//! Drivers: what moves an arm or an axis, behind one trait.
//!
//! A driver is polled by the stream's loop every few milliseconds; none of its methods waits for long, but
//! [`Driver::connect`] and [`Driver::hold`].

mod action_client;
mod camera_name;
mod file;
mod follow_joint_trajectory;
mod picture;
mod ros1;
mod ros2;
mod rosbridge;
mod rosbridge_camera;
mod rosbridge_goal;
mod rosbridge_gripper;
mod rosbridge_socket;
mod stepper;

pub use camera_name::{CameraError, open_camera};
pub use file::FileDriver;
pub use picture::{CameraPicture, PictureTopic};
pub use ros1::{Bag, BagError, BagPicture, Ros1Camera, Ros1Driver, Ros1Gripper};
pub use ros2::{Middleware, Ros2Address, Ros2CameraAddress};
pub use rosbridge::RosbridgeDriver;
pub use rosbridge_camera::RosbridgeCamera;
pub use rosbridge_goal::RosVersion;
pub use rosbridge_gripper::RosbridgeGripper;
pub use stepper::{SerialLine, StepperAnswer, StepperDriver, StepperLink, StepperRequest};

use std::time::{Duration, Instant};

/// The motion of one arm or axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PartTrajectory {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Growing times from zero, s.
    pub times: Vec<f64>,
    /// Positions, rad or m: a row per time.
    pub points: Vec<Vec<f64>>,
}

impl PartTrajectory {
    /// Positions at a time, straight between the points; the first before them, the last after.
    pub fn at(&self, time: f64) -> Vec<f64> {
        let after = self.times.partition_point(|known| *known <= time);
        if after == 0 || after == self.times.len() {
            return self.points[after.saturating_sub(1)].clone();
        }
        let (from, to) = (self.times[after - 1], self.times[after]);
        let part = (time - from) / (to - from);
        let pairs = self.points[after - 1].iter().zip(&self.points[after]);
        pairs.map(|(a, b)| a + part * (b - a)).collect()
    }

    /// Velocities at each point by the points around it; rest at both ends.
    pub fn velocities(&self) -> Vec<Vec<f64>> {
        let last = self.times.len() - 1;
        let at = |k: usize| {
            if k == 0 || k == last {
                return vec![0.0; self.joints.len()];
            }
            let span = self.times[k + 1] - self.times[k - 1];
            let pairs = self.points[k - 1].iter().zip(&self.points[k + 1]);
            pairs.map(|(a, b)| (b - a) / span).collect()
        };
        (0..=last).map(at).collect()
    }

    /// Its last time, s.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }
}

/// Where the joints are.
#[derive(Clone, Debug, PartialEq)]
pub struct JointState {
    /// When this was heard.
    pub received: Instant,
    /// Positions in the order of the trajectory's joints, rad or m.
    pub positions: Vec<f64>,
}

impl JointState {
    /// What a message says of `joints`, heard now; `position` looks up one of them. Messages may name more joints than these,
    /// and in another order; `None` where one is missing: such a message is of another part of the robot.
    fn heard(joints: &[String], position: impl Fn(&String) -> Option<f64>) -> Option<Self> {
        let positions: Option<Vec<f64>> = joints.iter().map(position).collect();
        positions.map(|positions| Self {
            received: Instant::now(),
            positions,
        })
    }
}

/// How far a motion has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// It goes on.
    Running,
    /// It ended as it should.
    Done,
}

/// What is wrong with a driver, in words that say what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DriverError {
    /// There is nobody at the other end, or not any more.
    #[error("{0}")]
    Lost(String),
    /// The other end refuses the motion.
    #[error("{0}")]
    Refused(String),
    /// The other end broke the motion off.
    #[error("{0}")]
    Aborted(String),
}

/// What opens and closes the gripper of an arm.
pub trait GripperDriver {
    /// Moves the fingers to an opening, m, and waits until they are there, or hold something on the way.
    ///
    /// # Errors
    /// There is nobody at the other end, it refuses, nothing is heard in time, or somebody asked for the end: then the command is
    /// cancelled.
    fn command(
        &self,
        opening: f64,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError>;
}

/// What moves an arm or an axis.
pub trait Driver: Send {
    /// Connects for motions of the given joints.
    ///
    /// # Errors
    /// If there is nobody at the other end within a few seconds.
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError>;

    /// Whether it hears where the joints are. If not, [`Driver::state`] is always `None`.
    fn reports_state(&self) -> bool;

    /// Whether its reports are where the joints are, rather than what they were told: a motor without a sensor begins
    /// a motion where it stands.
    fn knows_position(&self) -> bool {
        self.reports_state()
    }

    /// Where the joints were when last heard of; `None` before that.
    ///
    /// # Errors
    /// If the connection is lost.
    fn state(&mut self) -> Result<Option<JointState>, DriverError>;

    /// Time of the robot's own clock, s, where it keeps one, and when it was heard: a simulated robot may be faster or slower
    /// than real time.
    fn clock(&self) -> Option<(f64, Instant)> {
        None
    }

    /// Begins a motion, at once.
    ///
    /// # Errors
    /// If the connection is lost.
    fn start(&mut self, trajectory: &PartTrajectory) -> Result<(), DriverError>;

    /// Carries the motion on, `elapsed` seconds after its start.
    ///
    /// # Errors
    /// If the connection is lost, or the other end refuses the motion or breaks it off.
    fn advance(&mut self, elapsed: f64) -> Result<Progress, DriverError>;

    /// Ends the motion: the joints are left still. Returns once that is confirmed, or cannot be within half a second.
    ///
    /// # Errors
    /// If it could not be confirmed.
    fn hold(&mut self) -> Result<(), DriverError>;
}
