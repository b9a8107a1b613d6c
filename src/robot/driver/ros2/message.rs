//! ROS 2 messages for trajectories and pictures. The fields are in the order of their definitions,
//! as CDR requires.
//!
//! Trailing fields of an answer that are not needed are omitted.

use super::super::Interpolant;
use super::super::diagnostics::DiagnosticStatus;
use serde::{Deserialize, Serialize};

/// Identifier of a goal.
pub type GoalId = [u8; 16];

/// `std_msgs/Header`, including its `builtin_interfaces/Time`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    seconds: i32,
    nanoseconds: u32,
    frame: String,
}

/// `diagnostic_msgs/DiagnosticArray`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    header: Header,
    status: Vec<Status>,
}

/// `diagnostic_msgs/DiagnosticStatus`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Status {
    level: u8,
    name: String,
    message: String,
    hardware_id: String,
    /// `diagnostic_msgs/KeyValue`.
    values: Vec<(String, String)>,
}

impl DiagnosticArray {
    /// Statuses with a time since 1970.
    pub fn new(time: std::time::Duration, statuses: &[DiagnosticStatus]) -> Self {
        let status = |status: &DiagnosticStatus| Status {
            level: status.level as u8,
            name: status.name.clone(),
            message: status.message.clone(),
            hardware_id: status.hardware.clone(),
            values: (status.values.iter())
                .map(|(key, value)| ((*key).to_owned(), value.clone()))
                .collect(),
        };
        Self {
            header: Header {
                seconds: time.as_secs() as i32,
                nanoseconds: time.subsec_nanos(),
                frame: String::new(),
            },
            status: statuses.iter().map(status).collect(),
        }
    }
}

/// `builtin_interfaces/Duration`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Duration {
    seconds: i32,
    nanoseconds: u32,
}

impl Duration {
    fn of(seconds: f64) -> Self {
        let nanoseconds = (seconds * 1e9).round() as i64;
        Self {
            seconds: (nanoseconds / 1_000_000_000) as i32,
            nanoseconds: (nanoseconds % 1_000_000_000) as u32,
        }
    }
}

/// An empty sequence of any type: only its length.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Empty(u32);

/// `trajectory_msgs/JointTrajectoryPoint`.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Point {
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Empty,
    effort: Empty,
    time_from_start: Duration,
}

/// `trajectory_msgs/JointTrajectory`; a header without time means "at once".
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Trajectory {
    header: Header,
    joint_names: Vec<String>,
    points: Vec<Point>,
}

/// `trajectory_msgs/MultiDOFJointTrajectory` without joints.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct NoMultiDof {
    header: Header,
    joint_names: Empty,
    points: Empty,
}

/// `control_msgs/action/FollowJointTrajectory_SendGoal_Request`; the tolerances are those of the
/// controller.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SendGoal {
    goal_id: GoalId,
    trajectory: Trajectory,
    multi_dof_trajectory: NoMultiDof,
    path_tolerance: Empty,
    component_path_tolerance: Empty,
    goal_tolerance: Empty,
    component_goal_tolerance: Empty,
    goal_time_tolerance: Duration,
}

impl SendGoal {
    /// The goal of a motion.
    pub fn new(goal_id: GoalId, joints: &[String], motion: &Interpolant) -> Self {
        let points = motion.rows().map(|(time, positions, velocities)| Point {
            positions: positions.clone(),
            velocities: velocities.clone(),
            accelerations: Empty::default(),
            effort: Empty::default(),
            time_from_start: Duration::of(time),
        });
        Self {
            goal_id,
            trajectory: Trajectory {
                header: Header::default(),
                joint_names: joints.to_vec(),
                points: points.collect(),
            },
            multi_dof_trajectory: NoMultiDof::default(),
            path_tolerance: Empty::default(),
            component_path_tolerance: Empty::default(),
            goal_tolerance: Empty::default(),
            component_goal_tolerance: Empty::default(),
            goal_time_tolerance: Duration::default(),
        }
    }
}

/// `control_msgs/action/GripperCommand_SendGoal_Request`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct GripperCommand {
    goal_id: GoalId,
    /// Opening, m, and greatest effort, N.
    position: f64,
    max_effort: f64,
}

impl GripperCommand {
    /// The goal of an opening, m, with a maximum effort, N.
    pub fn new(goal_id: GoalId, opening: f64, max_effort: f64) -> Self {
        Self {
            goal_id,
            position: opening,
            max_effort,
        }
    }
}

/// `control_msgs/action/GripperCommand_GetResult_Response`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct GripperResult {
    /// `action_msgs/GoalStatus`.
    pub status: i8,
    position: f64,
    effort: f64,
    /// Whether the fingers exert their greatest effort without moving, which means that they hold
    /// something.
    pub stalled: bool,
    reached_goal: bool,
}

/// Beginning of `FollowJointTrajectory_SendGoal_Response`: whether the goal is accepted.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct GoalAnswer {
    /// Whether the controller accepts the goal.
    pub accepted: bool,
}

/// `FollowJointTrajectory_GetResult_Request`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct GetResult {
    /// The goal.
    pub goal_id: GoalId,
}

/// `FollowJointTrajectory_GetResult_Response`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ResultAnswer {
    /// `action_msgs/GoalStatus`.
    pub status: i8,
    /// 0, or an error code.
    pub error_code: i32,
    /// Message of the controller.
    pub error_string: String,
}

/// `action_msgs/srv/CancelGoal_Request`for one goal, independent of its time.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct CancelGoal {
    goal_id: GoalId,
    stamp: Duration,
}

impl CancelGoal {
    /// Cancels a goal.
    pub fn new(goal_id: GoalId) -> Self {
        Self {
            goal_id,
            stamp: Duration::default(),
        }
    }
}

/// Beginning of `action_msgs/srv/CancelGoal_Response`: its code.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct CancelAnswer {
    /// 0 if the goal is being cancelled, 1 if the controller rejects the request.
    pub return_code: i8,
}

/// Beginning of `FollowJointTrajectory_FeedbackMessage`, including the setpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Feedback {
    /// The goal.
    pub goal_id: GoalId,
    header: Header,
    /// Names of joints.
    pub joints: Vec<String>,
    /// Positions of the setpoint, rad or m.
    pub setpoint: Vec<f64>,
}

/// `sensor_msgs/JointState`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct JointStates {
    header: Header,
    /// Names of joints.
    pub name: Vec<String>,
    /// Their positions, rad or m.
    pub position: Vec<f64>,
    /// Their velocities, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Their efforts, N m or N; empty if none are reported.
    pub effort: Vec<f64>,
}

/// `geometry_msgs/WrenchStamped`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct WrenchStamped {
    /// Time stamp and frame.
    pub header: Header,
    /// Force, N.
    pub force: [f64; 3],
    /// Torque, N m.
    pub torque: [f64; 3],
}

/// `std_msgs/Empty`, which has one byte in DDS.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct NoContent(u8);

/// `sensor_msgs/Image`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Image {
    /// Time stamp and camera.
    pub header: Header,
    /// Rows.
    pub height: u32,
    /// Pixels along a row.
    pub width: u32,
    /// Such as `rgb8`.
    pub encoding: String,
    /// Whether numbers of two bytes are big-endian.
    pub is_bigendian: u8,
    /// Number of bytes per row.
    pub step: u32,
    /// Rows from top to bottom.
    pub data: Vec<u8>,
}

/// `sensor_msgs/CompressedImage`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CompressedImage {
    /// Time stamp and camera.
    pub header: Header,
    /// Such as `jpeg`.
    pub format: String,
    /// A PNG or JPEG file.
    pub data: Vec<u8>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_never_have_a_billion_nanoseconds() {
        let almost = Duration::of(1.999_999_999_9);
        assert_eq!((almost.seconds, almost.nanoseconds), (2, 0));
    }

    /// The expected bytes were encoded by hand from the definitions and the rules of CDR:
    /// little-endian, each number at a multiple of its size.
    #[test]
    fn a_goal_has_the_bytes_of_its_definition() {
        let motion = Interpolant::new(&[0.0, 1.5], &[vec![0.0], vec![2.0]]);
        let goal = SendGoal::new([7; 16], &["j".into()], &motion);
        let mut written = Vec::new();
        rustdds::serialization::to_writer_with_rep_id(
            &mut written,
            &goal,
            rustdds::RepresentationIdentifier::CDR_LE,
        )
        .unwrap();
        let mut expected = vec![7; 16];
        let word = |bytes: &mut Vec<u8>, number: u32| bytes.extend(number.to_le_bytes());
        let header = |bytes: &mut Vec<u8>| {
            (0..2).for_each(|_| word(bytes, 0));
            // An empty text is a single closing zero; the next number starts at a multiple of
            // four.
            bytes.extend([1, 0, 0, 0, 0, 0, 0, 0]);
        };
        header(&mut expected);
        word(&mut expected, 1);
        expected.extend([2, 0, 0, 0, b'j', 0, 0, 0]);
        word(&mut expected, 2);
        for (position, seconds, nanoseconds) in [(0.0_f64, 0, 0), (2.0, 1, 500_000_000)] {
            for number in [position, 0.0] {
                word(&mut expected, 1);
                while !expected.len().is_multiple_of(8) {
                    expected.push(0);
                }
                expected.extend(number.to_le_bytes());
            }
            for number in [0, 0, seconds, nanoseconds] {
                word(&mut expected, number);
            }
        }
        header(&mut expected);
        (0..2 + 4 + 2).for_each(|_| word(&mut expected, 0));
        assert_eq!(written, expected);
    }
}
