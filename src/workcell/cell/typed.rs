//! The cell file as typed: every allowed key, before validation.

use rodlab_lab::scenario::dimension::{
    Angle, AngularVelocity, Dimensionless, Force, Length, Moment, Time, Velocity,
};
use rodlab_lab::scenario::{Quantity, Vector};
use serde::Deserialize;
use serde::de::IgnoredAny;

/// A robot cell.
#[derive(Debug, Deserialize)]
pub struct CellFile {
    /// The file that this one extends; merged before it is read.
    #[serde(rename = "extends")]
    pub _extends: Option<IgnoredAny>,
    /// Title for people.
    pub title: Option<String>,
    /// The arms.
    #[serde(default)]
    pub arms: Vec<Arm>,
    /// External axes.
    #[serde(default)]
    pub axes: Vec<Axis>,
    /// The chuck that holds one end of a rod.
    pub chuck: Option<Chuck>,
    /// The table.
    pub table: Option<Table>,
    /// Boxes that arms must not touch.
    #[serde(default)]
    pub obstacles: Vec<Obstacle>,
    /// The camera.
    pub camera: Option<Camera>,
    /// The rod for tasks that name no other rod.
    pub rod: Option<SuppliedRod>,
    /// Limits of the hands, and signals that end motions.
    pub safety: Option<Safety>,
    /// Settings of the streaming of trajectories.
    pub streaming: Option<Streaming>,
}

/// An arm.
#[derive(Debug, Deserialize)]
pub struct Arm {
    pub name: String,
    pub urdf: Option<String>,
    pub base_link: Option<String>,
    pub tip_link: Option<String>,
    #[serde(default)]
    pub joints: Vec<Joint>,
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub rpy: Option<Vector<Angle>>,
    pub tool: Option<Placement>,
    pub home: Option<Vec<f64>>,
    pub velocity: Option<OneOrMany>,
    pub acceleration: Option<OneOrMany>,
    pub jerk: Option<OneOrMany>,
    pub effort: Option<OneOrMany>,
    pub link_radius: Option<Quantity<Length>>,
    #[serde(default)]
    pub capsules: Vec<Capsule>,
    #[serde(default)]
    pub boxes: Vec<LinkBox>,
    #[serde(default)]
    pub may_touch: Vec<[String; 2]>,
    pub driver: Option<Driver>,
    pub gripper: Option<Gripper>,
}

/// The gripper of an arm: an action at the server of the arm's driver.
#[derive(Debug, Deserialize)]
pub struct Gripper {
    pub action: String,
    pub open: Option<Quantity<Length>>,
    pub closed: Option<Quantity<Length>>,
    pub max_effort: Option<Quantity<Force>>,
    pub joint: Option<String>,
}

/// The rod that is handed to the arms.
#[derive(Debug, Deserialize)]
pub struct SuppliedRod {
    pub file: String,
}

/// One number for all joints, or one for each.
#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, or an array with a number for each joint"
)]
pub enum OneOrMany {
    One(f64),
    Many(Vec<f64>),
}

/// A joint of an arm.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Joint {
    Revolute(MovingJoint<Angle, AngularVelocity>),
    Prismatic(MovingJoint<Length, Velocity>),
    Fixed(FixedJoint),
}

/// A joint that turns or slides, with the dimensions of its position and its velocity.
#[derive(Debug, Deserialize)]
#[serde(bound = "")]
pub struct MovingJoint<P, V> {
    pub name: String,
    pub link: Option<String>,
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub rpy: Option<Vector<Angle>>,
    pub axis: Option<[f64; 3]>,
    pub lower: Option<Quantity<P>>,
    pub upper: Option<Quantity<P>>,
    pub velocity: Option<Quantity<V>>,
    pub acceleration: Option<f64>,
    pub jerk: Option<f64>,
    pub mimic: Option<Mimic>,
}

/// Another joint that this one follows.
#[derive(Debug, Deserialize)]
pub struct Mimic {
    pub joint: String,
    pub multiplier: Option<f64>,
    pub offset: Option<f64>,
}

/// A joint that does not move.
#[derive(Debug, Deserialize)]
pub struct FixedJoint {
    pub name: String,
    pub link: Option<String>,
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub rpy: Option<Vector<Angle>>,
}

/// A pose.
#[derive(Debug, Deserialize)]
pub struct Placement {
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub rpy: Option<Vector<Angle>>,
}

/// A capsule on a link.
#[derive(Debug, Deserialize)]
pub struct Capsule {
    pub link: String,
    pub from: Vector<Length>,
    pub to: Vector<Length>,
    pub radius: Quantity<Length>,
}

/// A box on a link.
#[derive(Debug, Deserialize)]
pub struct LinkBox {
    pub link: String,
    pub size: Vector<Length>,
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub rpy: Option<Vector<Angle>>,
}

/// An external axis.
#[derive(Debug, Deserialize)]
pub struct Axis {
    pub name: String,
    pub lower: Option<Quantity<Angle>>,
    pub upper: Option<Quantity<Angle>>,
    pub velocity: Quantity<AngularVelocity>,
    pub acceleration: f64,
    pub jerk: Option<f64>,
    pub driver: Option<Driver>,
}

/// The chuck; its x axis points along the rod, out of the chuck.
#[derive(Debug, Deserialize)]
pub struct Chuck {
    pub axis: String,
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub rpy: Option<Vector<Angle>>,
}

/// The table: a box whose top is centred at `position`.
#[derive(Debug, Deserialize)]
pub struct Table {
    pub size: Vector<Length>,
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub rpy: Option<Vector<Angle>>,
}

/// A box as an obstacle.
#[derive(Debug, Deserialize)]
pub struct Obstacle {
    pub name: String,
    pub size: Vector<Length>,
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub rpy: Option<Vector<Angle>>,
}

/// A pinhole camera.
#[derive(Debug, Deserialize)]
pub struct Camera {
    pub width: u32,
    pub height: u32,
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
    #[serde(default)]
    pub distortion: Vec<f64>,
    pub position: Option<Vector<Length>>,
    pub quaternion: Option<[Quantity<Dimensionless>; 4]>,
    pub table_height: Option<Quantity<Length>>,
    pub source: Option<String>,
}

/// Limits of the hands, and signals that end motions.
#[derive(Debug, Deserialize)]
pub struct Safety {
    pub workspace: Option<Workspace>,
    pub hand_speed: Option<Quantity<Velocity>>,
    pub first_run: Option<f64>,
    #[serde(default)]
    pub signals: Vec<Signal>,
}

/// A topic whose messages, or whose silence, end motions.
#[derive(Debug, Deserialize)]
pub struct Signal {
    pub name: String,
    pub topic: String,
    pub message: String,
    pub stop_at: Option<bool>,
    pub allowed: Option<Vec<Allowed>>,
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    pub force: Option<Quantity<Force>>,
    pub torque: Option<Quantity<Moment>>,
    pub full_speed: Option<f64>,
    pub silence: Option<Quantity<Time>>,
}

/// A number or a text.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected a number or a text")]
pub enum Allowed {
    Number(f64),
    Text(String),
}

/// A box, by its corners.
#[derive(Debug, Deserialize)]
pub struct Workspace {
    pub lower: Vector<Length>,
    pub upper: Vector<Length>,
}

/// Settings of the streaming of trajectories.
#[derive(Debug, Deserialize)]
pub struct Streaming {
    pub start_tolerance: Option<Quantity<Angle>>,
    pub start_tolerance_prismatic: Option<Quantity<Length>>,
    pub tracking_tolerance: Option<Quantity<Angle>>,
    pub tracking_tolerance_prismatic: Option<Quantity<Length>>,
    pub watchdog: Option<Quantity<Time>>,
    pub longest_pause: Option<Quantity<Time>>,
    pub horizon: Option<Quantity<Time>>,
    pub diagnostics: Option<String>,
}

/// Driver of an arm or an axis.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Driver {
    File(FileDriver),
    Rosbridge(RosbridgeDriver),
    Ros1(Ros1Driver),
    Ros2(Ros2Driver),
    Stepper(StepperDriver),
}

/// Writes points to a file, or to standard output where `path` is "-".
#[derive(Debug, Deserialize)]
pub struct FileDriver {
    pub path: String,
    pub format: Option<String>,
}

/// A rosbridge server.
#[derive(Debug, Deserialize)]
pub struct RosbridgeDriver {
    pub address: String,
    pub ros: Option<u8>,
    pub action: String,
    pub joint_states: String,
}

/// A ROS 1 action server.
#[derive(Debug, Deserialize)]
pub struct Ros1Driver {
    pub master: String,
    pub action: String,
    pub joint_states: String,
}

/// A ROS 2 action server.
#[derive(Debug, Deserialize)]
pub struct Ros2Driver {
    pub domain: Option<u16>,
    pub middleware: Option<String>,
    pub interface: Option<String>,
    pub action: String,
    pub joint_states: String,
}

/// A stepper motor on a serial line.
#[derive(Debug, Deserialize)]
pub struct StepperDriver {
    pub port: String,
    pub baud: Option<u32>,
    pub steps_per_turn: u32,
}
