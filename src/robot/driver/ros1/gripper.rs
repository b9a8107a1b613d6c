//! A gripper of ROS 1: the action `control_msgs/GripperCommand`.

use super::super::action_client::Goal;
use super::super::follow_joint_trajectory::ros_1_outcome;
use super::super::{DriverError, GripperDriver};
use super::message;
use super::node::{Heard, Node, Publication, mailbox, master_uri};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Longest wait for the action server.
const PATIENCE: Duration = Duration::from_secs(3);
/// Status of a goal that the controller broke off.
const ABORTED: u8 = 4;
/// Time between looks.
const LOOK: Duration = Duration::from_millis(5);

/// A gripper by its action at a master.
#[derive(Clone, Debug, PartialEq)]
pub struct Ros1Gripper {
    /// Such as `http://10.0.0.1:11311`.
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
            self.lost(format_args!(
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
        self.wait_for_server([&goals, &cancellations], is_interrupted)?;
        let goal = Goal::new();
        goals.publish(&message::gripper_goal(opening, self.max_effort, goal.id()));
        let ended = self.wait(&heard, &goal, patience, is_interrupted);
        if ended.is_err() {
            // Whatever ended it, the fingers must not move on.
            cancellations.publish(&message::cancel(goal.id()));
        }
        ended
    }
}

impl Ros1Gripper {
    /// Waits for the end of a goal.
    fn wait(
        &self,
        heard: &Receiver<Heard>,
        goal: &Goal,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let begin = Instant::now();
        while begin.elapsed() < patience {
            if is_interrupted() {
                return Err(DriverError::Aborted("interrupted".into()));
            }
            match heard.recv_timeout(LOOK) {
                Ok(Heard::Message(_, bytes)) => {
                    if let Some(status) = message::status_of(&bytes)
                        && status.id == goal.id()
                    {
                        // Fingers that hold something on the way have stalled; some controllers abort then.
                        if status.status == ABORTED && message::is_stalled(&bytes) {
                            return Ok(());
                        }
                        return ros_1_outcome(i64::from(status.status), 0, &status.text);
                    }
                }
                Ok(Heard::MasterIsGone) | Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(self.lost(format_args!("the connection is lost")));
                }
            }
        }
        Err(self.lost(format_args!(
            "the gripper {} has not moved within {} s; is it started, and is this its action?",
            self.action,
            patience.as_secs_f64()
        )))
    }

    /// Waits until the action server hears goals and cancellations.
    fn wait_for_server(
        &self,
        topics: [&Arc<Publication>; 2],
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let begin = Instant::now();
        while topics.iter().any(|topic| topic.subscribers() == 0) {
            if is_interrupted() {
                return Err(DriverError::Aborted("interrupted".into()));
            }
            if begin.elapsed() > PATIENCE {
                return Err(self.lost(format_args!(
                    "no action server listens to {}/goal; is the gripper started?",
                    self.action
                )));
            }
            std::thread::sleep(LOOK);
        }
        Ok(())
    }

    fn lost(&self, reason: std::fmt::Arguments<'_>) -> DriverError {
        DriverError::Lost(format!("ROS master {}: {reason}", self.master))
    }
}
