//! `control_msgs/FollowJointTrajectory` of ROS 1, natively, without a ROS installation or a bridge.
//!
//! A node (`node`) uses XML-RPC (`xmlrpc`) for the master and TCPROS for the action server. The
//! node sends goals and cancellations, and receives joint states, feedback, results and the clock
//! of a simulated robot (`message`). A `gripper` uses another action. Pictures come from a `camera`
//! or from a recording (`bag`), and what ends motions from a `signal`;
//! `diagnostics` go to monitors.

mod bag;
mod bag_record;
mod bag_topic;
mod camera;
mod diagnostics;
mod gripper;
mod message;
mod node;
mod signal;
mod xmlrpc;

pub use bag::{Bag, BagError, BagPicture};
pub use camera::Ros1Camera;
pub use diagnostics::Ros1Diagnostics;
pub use gripper::Ros1Gripper;
pub use signal::Ros1Signal;

use super::action_driver::{ActionDriver, ActionLink, News, unique_name};
use super::follow_joint_trajectory::ros_1_outcome;
use super::gripper_goal::wait_for_server;
use super::{DriverError, Interpolant, read_within_bounds};
use node::{Heard, Node, Publication, mailbox};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::Duration;

/// Longest wait for the action server.
const PATIENCE: Duration = Duration::from_secs(3);

/// Topic on which a simulated robot publishes its time.
const CLOCK_TOPIC: &str = "/clock";

const CLOCK: &str = "clock";
const STATES: &str = "joint states";
const FEEDBACK: &str = "feedback";
const RESULT: &str = "result";

/// A driver for an action server of ROS 1.
pub type Ros1Driver = ActionDriver<Ros1Link>;

impl Ros1Driver {
    /// A driver at a master such as `http://10.0.0.1:11311`, for an action and a topic of joint
    /// states.
    pub fn new(master: &str, action: &str, joint_states: &str) -> Self {
        Self::over(Ros1Link {
            master: node::master_uri(master),
            action: action.trim_end_matches('/').to_owned(),
            joint_states: joint_states.to_owned(),
            connection: None,
        })
    }
}

/// A connection to an action server of ROS 1.
pub struct Ros1Link {
    master: String,
    action: String,
    joint_states: String,
    connection: Option<Connection>,
}

struct Connection {
    heard: Receiver<Heard>,
    goals: Arc<Publication>,
    cancellations: Arc<Publication>,
    _node: Node,
}

impl Ros1Link {
    fn connect(&self) -> std::io::Result<Connection> {
        let node = Node::start(&self.master)?;
        let (sender, heard) = mailbox();
        let topic = |what: &str| format!("{}/{what}", self.action);
        node.subscribe(STATES, &self.joint_states, message::JOINT_STATE, &sender)?;
        node.subscribe(CLOCK, CLOCK_TOPIC, message::CLOCK, &sender)?;
        node.subscribe(FEEDBACK, &topic("feedback"), message::FEEDBACK, &sender)?;
        node.subscribe(RESULT, &topic("result"), message::RESULT, &sender)?;
        let goals = node.advertise(&topic("goal"), message::GOAL)?;
        let cancellations = node.advertise(&topic("cancel"), message::CANCEL)?;
        node.watch_master(&sender);
        Ok(Connection {
            heard,
            goals,
            cancellations,
            _node: node,
        })
    }

    fn connection(&self) -> Result<&Connection, DriverError> {
        let connection = self.connection.as_ref();
        connection.ok_or_else(|| self.lost(&"not connected"))
    }

    /// Reads one message; `false` if none has arrived.
    fn read_message(&self, news: &mut News<String>) -> Result<bool, DriverError> {
        match self.connection()?.heard.try_recv() {
            Ok(Heard::Message(label, message)) => {
                // Damaged messages are ignored.
                let _ = hear(label, &message, news);
                Ok(true)
            }
            Ok(Heard::MasterIsGone) => Err(self.lost(&format_args!(
                "it no longer answers; the motion is cancelled"
            ))),
            Err(TryRecvError::Empty) => Ok(false),
            Err(TryRecvError::Disconnected) => Err(self.lost(&"the connection is lost")),
        }
    }

    /// Sends a message to the action server.
    fn publish(&self, topic: &Publication, message: &[u8]) -> Result<(), DriverError> {
        match topic.publish(message) {
            0 => Err(self.lost(&format_args!(
                "the action server of {} has disconnected",
                self.action
            ))),
            _ => Ok(()),
        }
    }
}

/// Stores the content of a message; `None` if it is damaged.
fn hear(label: &str, bytes: &[u8], news: &mut News<String>) -> Option<()> {
    match label {
        STATES => {
            let states = message::joint_state(bytes)?;
            let of = |numbers: &[f64], index: usize| numbers.get(index).copied();
            let position = |index| of(&states.positions, index);
            let effort = |index| of(&states.efforts, index);
            news.add_state(&states.names, position, effort, Some(states.time));
        }
        CLOCK => news.set_time(message::clock(bytes)?),
        FEEDBACK => {
            let (status, names, positions) = message::feedback(bytes)?;
            let goal = news.goal.as_mut().filter(|goal| status.id == *goal.id())?;
            goal.acknowledge();
            news.add_setpoint(&names, |index| positions.get(index).copied());
        }
        _ => {
            let (status, code, words) = message::result(bytes)?;
            let goal = news.goal.as_mut().filter(|goal| status.id == *goal.id())?;
            let said = format!("{} {words}", status.text);
            goal.end(ros_1_outcome(status.status.into(), code.into(), &said));
        }
    }
    Some(())
}

impl ActionLink for Ros1Link {
    type Id = String;

    fn unique() -> String {
        unique_name()
    }

    fn action(&self) -> &str {
        &self.action
    }

    fn lost(&self, reason: &dyn std::fmt::Display) -> DriverError {
        DriverError::Lost(format!("ROS master {}: {reason}", self.master))
    }

    fn open(&mut self) -> Result<(), DriverError> {
        let connection = self.connect().map_err(|error| {
            self.lost(&format_args!(
                "{error}; is it started, and is `master` its address?"
            ))
        })?;
        let topics = [&connection.goals, &connection.cancellations];
        let is_there = || topics.iter().all(|topic| topic.subscribers() > 0);
        if !wait_for_server(PATIENCE, &|| false, &is_there)? {
            return Err(self.lost(&format_args!(
                "no action server listens to {}/goal; is the controller started?",
                self.action
            )));
        }
        self.connection = Some(connection);
        Ok(())
    }

    fn listen(&mut self, news: &mut News<String>) -> Result<(), DriverError> {
        read_within_bounds(|| self.read_message(news))
    }

    fn send_goal(
        &mut self,
        joints: &[String],
        motion: &Interpolant,
        id: &String,
    ) -> Result<(), DriverError> {
        let goals = &self.connection()?.goals;
        self.publish(goals, &message::goal(joints, motion, id))
    }

    fn cancel(&mut self, id: &String) -> Result<(), DriverError> {
        let cancellations = &self.connection()?.cancellations;
        self.publish(cancellations, &message::cancel(id))
    }
}
