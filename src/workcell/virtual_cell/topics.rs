//! Names of the actions and topics of a virtual cell, as in its cell file.

use super::axis::moving_parts;
use crate::cell::{Cell, Driver, ros_version};
use rodlab_robot::RosVersion;

/// Topic of the clock.
pub const CLOCK: &str = "/clock";
/// Topic of the camera if the cell file names none.
const CAMERA: &str = "/camera/image_raw";
/// Largest number of pixels of the camera.
const MOST_PIXELS: u64 = 4_000_000;

/// Index of the action that moves an arm; [`GRIP`] is that of its gripper.
pub const MOTION: usize = 0;
/// See [`MOTION`].
pub const GRIP: usize = 1;

/// Names of an arm, or of an axis.
pub struct ArmTopics {
    /// Name of the arm or axis.
    pub name: String,
    /// Version of ROS.
    pub version: RosVersion,
    /// The action that moves the arm or the axis.
    pub action: String,
    /// The topic of the joint states.
    pub joint_states: String,
    /// The action of the gripper.
    pub gripper: Option<String>,
    /// The joint of the fingers.
    pub fingers: Option<String>,
}

/// Names of all actions and topics of a cell.
pub struct Topics {
    /// Names of the arms, then of the axes.
    pub arms: Vec<ArmTopics>,
    /// Version of ROS of the clock and the camera: that of the first arm.
    pub version: RosVersion,
    /// The topic of the camera.
    pub camera: String,
}

impl Topics {
    /// The names of a cell.
    ///
    /// # Errors
    /// A message: an arm has another driver, two arms share an action, or the picture of the
    /// camera is too large.
    pub fn of(cell: &Cell) -> Result<Self, String> {
        let mut arms: Vec<ArmTopics> = Vec::new();
        for arm in moving_parts(cell) {
            let Some(Driver::Rosbridge {
                ros,
                action,
                joint_states,
                ..
            }) = &arm.driver
            else {
                return Err(format!(
                    "arm {}: a virtual cell moves arms with a driver of kind \"rosbridge\"",
                    arm.name
                ));
            };
            if arms.iter().any(|known| known.action == *action) {
                return Err(format!(
                    "arm {}: another one has the action {action}",
                    arm.name
                ));
            }
            let gripper = arm.gripper.as_ref();
            arms.push(ArmTopics {
                name: arm.name.clone(),
                version: ros_version(*ros),
                action: action.clone(),
                joint_states: joint_states.clone(),
                gripper: gripper.map(|gripper| gripper.action.clone()),
                fingers: gripper.and_then(|gripper| gripper.joint.clone()),
            });
        }
        let version = arms.first().ok_or("a virtual cell needs an arm")?.version;
        let mut camera = CAMERA.to_owned();
        if let Some(known) = &cell.camera {
            let [width, height] = known.size.map(u64::from);
            if width * height > MOST_PIXELS {
                return Err(format!(
                    "the camera has {width} × {height} pixels; a virtual one may have {MOST_PIXELS}"
                ));
            }
            let source = known.source.as_deref();
            let place = source.and_then(|source| source.strip_prefix("rosbridge://"));
            if let Some((_, topic)) = place.and_then(|place| place.split_once('/')) {
                camera = format!("/{topic}");
            }
        }
        Ok(Self {
            arms,
            version,
            camera,
        })
    }

    /// Checks that a topic exists.
    ///
    /// # Errors
    /// The topic does not exist.
    pub fn know(&self, topic: &str) -> Result<(), String> {
        let of_action = |action: &String| {
            let rest = topic.strip_prefix(action.as_str());
            rest.is_some_and(|rest| ["/status", "/feedback", "/result"].contains(&rest))
        };
        let is_of_arm = |arm: &ArmTopics| {
            arm.joint_states == topic
                || of_action(&arm.action)
                || arm.gripper.as_ref().is_some_and(of_action)
        };
        if topic == CLOCK || topic == self.camera || self.arms.iter().any(is_of_arm) {
            return Ok(());
        }
        let mut names = vec![CLOCK, self.camera.as_str()];
        names.extend(self.arms.iter().map(|arm| arm.joint_states.as_str()));
        Err(format!(
            "no topic is called {topic}; topics: {}, and those of actions",
            names.join(", ")
        ))
    }

    /// The arm of an action, and the kind of the action: [`MOTION`] or [`GRIP`].
    ///
    /// # Errors
    /// The action does not exist.
    pub fn action(&self, action: &str) -> Result<(usize, usize), String> {
        let mut names: Vec<&str> = Vec::new();
        for (index, arm) in self.arms.iter().enumerate() {
            let of_arm = std::iter::once(&arm.action).chain(&arm.gripper);
            for (which, name) in of_arm.enumerate() {
                if name == action {
                    return Ok((index, which));
                }
                names.push(name);
            }
        }
        Err(format!(
            "no action is called {action}; actions: {}",
            names.join(", ")
        ))
    }
}
