//! Robot arms: kinematic chains and their limits, inverse kinematics, joint paths, trajectories,
//! and drivers.
//!
//! The crate uses plain poses and trajectories and does not depend on rods.
//!
//! | file | what |
//! |---|---|
//! | `pose`, `chain`, `body` | rigid motions; joints and links; shapes of links |
//! | `urdf`, `mesh` | chains from URDF files; meshes of their links |
//! | `kinematics`, `posture` | the hand and its Jacobian; manipulability, distance to singularities and limits |
//! | `collision` | distances between arms and obstacles |
//! | `path` | smooth joint paths along a path of the hand; the best place for one |
//! | `timing` | from a joint path to a motion within limits of velocity, acceleration and jerk |
//! | `trajectory` | joint trajectories as tables |
//! | `driver` | ROS 1, ROS 2, rosbridge, steppers and files behind one trait |
//! | `stream` | checks before the first point, one clock, watchdogs, the log |
//! | `inverse`, `self_motion` | joint positions for a pose: one, every branch, curves of redundant chains |

// Tests compare with a tolerance, and may call any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod body;
mod chain;
mod collision;
mod driver;
mod inverse;
mod kinematics;
mod mesh;
mod path;
mod pose;
mod posture;
mod self_motion;
mod stream;
#[cfg(test)]
mod tests;
mod timing;
mod trajectory;
mod unix_time;
mod urdf;

pub use body::{Body, Hull, Shape};
pub use chain::{Chain, Follower, Joint, JointKind, Limits, MOST_JOINTS, Motion, Segment};
pub use collision::{Approach, FAR, Member, StandingBox, Surroundings};
pub use driver::{
    Bag, BagError, BagPicture, CameraError, CameraPicture, DiagnosticLevel, DiagnosticStatus,
    DiagnosticTopic, Driver, DriverError, FileDriver, GripperDriver, Interpolant, JointState,
    Middleware, PartTrajectory, PictureTopic, Progress, Reading, Ros1Camera, Ros1Driver,
    Ros1Gripper, Ros2Address, Ros2GripperAddress, Ros2Topic, RosVersion, RosbridgeCamera,
    RosbridgeDriver, RosbridgeGripper, SerialLine, SignalMessage, SignalShape, SignalTopic,
    StepperAnswer, StepperDriver, StepperLink, StepperRequest, TopicName, open_camera,
    open_diagnostics, open_signal,
};
pub use inverse::{Nearest, REACHED};
pub use kinematics::Jacobian;
pub use path::{
    JointPath, LARGEST_JUMP, Obstruction, PathFailure, PathPoint, PathProblem, Placement, place,
    subdivide,
};
pub use pose::{Pose, between, difference, distance_and_angle, parts, pose, pose_of_angles};
pub use posture::Posture;
pub use stream::{
    Ending, Fault, Moving, Part, StreamBounds, StreamLog, StreamState, Supervisor, Tolerance,
    check, check_stops, stream,
};
pub use timing::{
    Motion as TimedMotion, SAMPLE, TimingError, Utilisation, parametrise, utilisation,
};
pub use trajectory::{Column, JointTrajectory, Table, TableError, read_table};
pub use unix_time::unix_time;
pub use urdf::{UrdfArm, UrdfError, read_urdf};
