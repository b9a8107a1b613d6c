//! A gripper of ROS 1: the action `control_msgs/GripperCommand`.

use super::super::action_driver::unique_name;
use super::super::follow_joint_trajectory::ros_1_outcome;
use super::super::gripper_goal::{GripperGoal, LOOK, wait_for_end, wait_for_server};
use super::super::{DriverError, GripperDriver};
use super::PATIENCE;
use super::message;
use super::node::{Heard, Node, Publication, mailbox, master_uri};
use std::fmt::Display;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

/// Status of a goal that the controller aborted.
const ABORTED: u8 = 4;

/// A gripper by its action at a master.
#[derive(Clone, Debug, PartialEq)]
pub struct Ros1Gripper {
    /// Address, such as `http://10.0.0.1:11311`.
    pub master: String,
    /// Name of the action.
    pub action: String,
    /// Greatest effort, N.
    pub max_effort: f64,
}

impl GripperDriver for Ros1Gripper {
    fn command(
        &self,
        opening: f64,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let unreachable = |error: std::io::Error| {
            self.lost(&format_args!(
                "{error}; is it started, and is `master` its address?"
            ))
        };
        let node = Node::start(&master_uri(&self.master)).map_err(unreachable)?;
        let (sender, heard) = mailbox();
        let topic = |what: &str| format!("{}/{what}", self.action.trim_end_matches('/'));
        node.subscribe("result", &topic("result"), message::GRIPPER_RESULT, &sender)
            .map_err(unreachable)?;
        let goals = node.advertise(&topic("goal"), message::GRIPPER_GOAL);
        let goals = goals.map_err(unreachable)?;
        let cancellations = node.advertise(&topic("cancel"), message::CANCEL);
        let cancellations = cancellations.map_err(unreachable)?;
        let is_there = || goals.subscribers() > 0 && cancellations.subscribers() > 0;
        if !wait_for_server(PATIENCE, is_interrupted, &is_there)? {
            return Err(self.lost(&format_args!(
                "no action server listens to {}/goal; is the gripper started?",
                self.action
            )));
        }
        let id = unique_name();
        goals.publish(&message::gripper_goal(opening, self.max_effort, &id));
        let mut sent = SentGoal {
            gripper: self,
            heard,
            cancellations,
            id,
        };
        wait_for_end(&mut sent, &self.action, patience, is_interrupted)
    }
}

impl Ros1Gripper {
    fn lost(&self, reason: &dyn Display) -> DriverError {
        DriverError::Lost(format!("ROS master {}: {reason}", self.master))
    }
}

/// A goal, and the topics of its action.
struct SentGoal<'a> {
    gripper: &'a Ros1Gripper,
    heard: Receiver<Heard>,
    cancellations: Arc<Publication>,
    id: String,
}

impl GripperGoal for SentGoal<'_> {
    fn has_ended(&mut self) -> Result<bool, DriverError> {
        let bytes = match self.heard.recv_timeout(LOOK) {
            Ok(Heard::Message(_, bytes)) => bytes,
            Ok(Heard::MasterIsGone) | Err(RecvTimeoutError::Timeout) => return Ok(false),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(self.lost(&"the connection is lost"));
            }
        };
        let status = message::status_of(&bytes).filter(|status| status.id == self.id);
        let Some(status) = status else {
            return Ok(false);
        };
        // Fingers stall when they hold an object; some controllers then abort the goal.
        if status.status == ABORTED && message::is_stalled(&bytes) {
            return Ok(true);
        }
        ros_1_outcome(status.status.into(), 0, &status.text).map(|()| true)
    }

    fn cancel(&mut self, error: DriverError) -> DriverError {
        self.cancellations.publish(&message::cancel(&self.id));
        error
    }

    fn lost(&self, reason: &dyn Display) -> DriverError {
        self.gripper.lost(reason)
    }
}
