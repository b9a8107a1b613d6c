//! The cell in SI units.

use super::safety::Safety;
use rodlab_robot::{
    Body, Chain, Column, Limits, Pose, Ros2Address, RosVersion, StreamBounds, TopicName,
};
use std::path::PathBuf;

/// A robot cell. Bases, table and camera are placed in its frame; z is up.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Title in reports.
    pub title: String,
    /// The arms, with unique names.
    pub arms: Vec<Arm>,
    /// External axes, with unique names.
    pub axes: Vec<Axis>,
    /// The chuck that holds one end of a rod.
    pub chuck: Option<Chuck>,
    /// The table.
    pub table: Option<Table>,
    /// Boxes that arms must not touch.
    pub obstacles: Vec<Obstacle>,
    /// The camera.
    pub camera: Option<Camera>,
    /// File of the rod for tasks that name no other rod.
    pub rod: Option<PathBuf>,
    /// Limits of the hands, and signals.
    pub safety: Safety,
    /// Settings for streaming trajectories.
    pub streaming: StreamBounds,
    /// Topic of the diagnostics of a task.
    pub diagnostics: Option<TopicName>,
    /// Warnings about input that was ignored.
    pub warnings: Vec<String>,
}

/// An arm.
#[derive(Clone, Debug)]
pub struct Arm {
    /// Name of the arm.
    pub name: String,
    /// Joints and links of the arm, tool included.
    pub chain: Chain,
    /// Pose of its base in the cell.
    pub base: Pose,
    /// Joint positions at rest.
    pub home: Vec<f64>,
    /// Shapes of base and links.
    pub bodies: Vec<Body>,
    /// Pairs of links that may touch: indices of segments, `None` for the base.
    pub may_touch: Vec<[Option<usize>; 2]>,
    /// Greatest reported effort of each joint, N m or N; empty without limits.
    pub efforts: Vec<f64>,
    /// Driver that moves it.
    pub driver: Option<Driver>,
    /// Gripper of the arm.
    pub gripper: Option<Gripper>,
}

/// The gripper of an arm: a `control_msgs/GripperCommand` action at the rosbridge server, the ROS
/// 1 master or in the ROS 2 domain of the arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Gripper {
    /// Name of the action.
    pub action: String,
    /// Opening of its fingers when it holds nothing, m.
    pub open: f64,
    /// Opening to which it closes, m.
    pub closed: f64,
    /// Greatest effort of its fingers, N; 0 leaves the choice to the controller.
    pub max_effort: f64,
    /// Name of the joint of its fingers in the reports of the arm, if they include it.
    pub joint: Option<String>,
}

/// An external axis, such as the motor that twists a rod's end.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name of the axis.
    pub name: String,
    /// Limits of its angle, velocity and acceleration.
    pub limits: Limits,
    /// Driver that moves it.
    pub driver: Option<Driver>,
}

/// A chuck that holds one end of a rod and turns it.
#[derive(Clone, Copy, Debug)]
pub struct Chuck {
    /// Index of the external axis that turns it.
    pub axis: usize,
    /// Pose in the cell of the end of the chuck, where the rod begins, with the axis at zero. x
    /// points along the rod, out of the chuck, and is the axis of rotation.
    pub pose: Pose,
}

/// The table: a box.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Pose in the cell of the centre of its top, z out of the table.
    pub top: Pose,
    /// Sides of the table along x and y and its thickness, m.
    pub size: [f64; 3],
}

/// A box that arms must not touch.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// Name of the obstacle.
    pub name: String,
    /// Pose of its centre in the cell.
    pub pose: Pose,
    /// Sides of the obstacle, m.
    pub size: [f64; 3],
}

/// A pinhole camera.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Width and height of its images, pixels.
    pub size: [u32; 2],
    /// Focal lengths fx and fy and principal point cx, cy, pixels.
    pub intrinsics: [f64; 4],
    /// Distortion coefficients k1, k2, p1, p2, k3 as OpenCV orders them; missing ones are zero.
    pub distortion: Vec<f64>,
    /// Pose in the cell; the camera looks along its z axis, and its y axis points down in the
    /// picture.
    pub pose: Pose,
    /// Source of its pictures, such as `rosbridge://127.0.0.1:9090/camera/image_raw`.
    pub source: Option<String>,
}

/// Driver of an arm or an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Driver {
    /// Points are written to a file.
    File {
        /// The file; `None` for standard output.
        path: Option<PathBuf>,
        /// Whether the points are JSON lines instead of CSV.
        json_lines: bool,
    },
    /// A rosbridge server in front of a `control_msgs/FollowJointTrajectory` action.
    Rosbridge {
        /// `host:port`.
        address: String,
        /// 1 or 2.
        ros: u8,
        /// Name of the action.
        action: String,
        /// Topic of the joint states.
        joint_states: String,
    },
    /// A `control_msgs/FollowJointTrajectory` action of ROS 1.
    Ros1 {
        /// Address of the master, `http://host:port`.
        master: String,
        /// Name of the action.
        action: String,
        /// Topic of the joint states.
        joint_states: String,
    },
    /// A `control_msgs/FollowJointTrajectory` action of ROS 2.
    Ros2(Ros2Address),
    /// A stepper motor on a serial line.
    Stepper {
        /// The port, such as `/dev/ttyACM0`.
        port: String,
        /// Bits per second.
        baud: u32,
        /// Steps per turn of the axis, microsteps and gear included.
        steps_per_turn: u32,
    },
}

impl Cell {
    /// The arm with a name.
    pub fn arm(&self, name: &str) -> Option<&Arm> {
        self.arms.iter().find(|arm| arm.name == name)
    }
}

impl Arm {
    /// The columns of the joints in a trajectory.
    pub(crate) fn columns(&self) -> impl Iterator<Item = Column> + '_ {
        self.chain.joints.iter().map(|joint| Column {
            part: self.name.clone(),
            joint: Some(joint.name.clone()),
            kind: joint.kind,
        })
    }

    /// The limits of the joints.
    pub(crate) fn limits(&self) -> Vec<Limits> {
        let joints = self.chain.joints.iter();
        joints.map(|joint| joint.limits).collect()
    }

    /// Pose of the hand in the cell.
    pub(crate) fn hand(&self, joints: &[f64]) -> Pose {
        self.base * self.chain.hand(joints)
    }
}

/// The version of ROS behind a rosbridge server, from its number.
pub(crate) fn ros_version(number: u8) -> RosVersion {
    match number {
        1 => RosVersion::One,
        _ => RosVersion::Two,
    }
}
