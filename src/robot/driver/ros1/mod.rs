//! `control_msgs/FollowJointTrajectory` of ROS 1, natively: no ROS installation, no bridge.
//!
//! A node (`node`) speaks XML-RPC (`xmlrpc`) with the master and TCPROS with the action server: goal and cancellation
//! out, joint states, feedback, result and the clock of a simulated robot in (`message`). A `gripper` is another action. Pictures come from a `camera` or from a recording (`bag`).

mod bag;
mod bag_record;
mod bag_topic;
mod camera;
mod gripper;
mod message;
mod node;
mod xmlrpc;

pub use bag::{Bag, BagError, BagPicture};
pub use camera::Ros1Camera;
pub use gripper::Ros1Gripper;

use super::action_client::{ActionClient, Goal};
use super::clocked_reports::ClockedReports;
use super::follow_joint_trajectory::ros_1_outcome;
use super::{Driver, DriverError, Interpolant, JointState, Progress, read_within_bounds};
use node::{Heard, Node, Publication, mailbox};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};

/// Longest wait for the action server.
const PATIENCE: Duration = Duration::from_secs(3);

/// Topic on which a simulated robot publishes its time.
const CLOCK_TOPIC: &str = "/clock";

const CLOCK: &str = "clock";
const STATES: &str = "joint states";
const FEEDBACK: &str = "feedback";
const RESULT: &str = "result";

/// A driver for an action server of ROS 1.
pub struct Ros1Driver {
    master: String,
    action: String,
    joint_states: String,
    joints: Vec<String>,
    connection: Option<Connection>,
    reports: ClockedReports,
    setpoint: Option<JointState>,
    goal: Option<Goal>,
}

struct Connection {
    heard: Receiver<Heard>,
    goals: Arc<Publication>,
    cancellations: Arc<Publication>,
    _node: Node,
}

impl Ros1Driver {
    /// A driver at a master such as `http://10.0.0.1:11311`, for the action of that name and the topic of joint
    /// states.
    pub fn new(master: &str, action: &str, joint_states: &str) -> Self {
        Self {
            master: node::master_uri(master),
            action: action.trim_end_matches('/').to_owned(),
            joint_states: joint_states.to_owned(),
            joints: Vec::new(),
            connection: None,
            reports: ClockedReports::default(),
            setpoint: None,
            goal: None,
        }
    }

    fn open(&self) -> std::io::Result<Connection> {
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

    /// Reads one message; `false` where none has arrived.
    fn read_message(&mut self) -> Result<bool, DriverError> {
        let Some(connection) = &self.connection else {
            return Err(self.lost(format_args!("not connected")));
        };
        match connection.heard.try_recv() {
            Ok(Heard::Message(label, message)) => {
                self.hear(label, &message);
                Ok(true)
            }
            Ok(Heard::MasterIsGone) => Err(self.lost(format_args!(
                "it does not answer any more; the motion is cancelled"
            ))),
            Err(TryRecvError::Empty) => Ok(false),
            Err(TryRecvError::Disconnected) => {
                Err(self.lost(format_args!("the connection is lost")))
            }
        }
    }

    fn hear(&mut self, label: &str, bytes: &[u8]) {
        match label {
            STATES => {
                let Some((stamp, names, positions)) = message::joint_state(bytes) else {
                    return;
                };
                let position = |index: usize| positions.get(index).copied();
                let heard = JointState::heard(&self.joints, &names, position);
                self.reports.add(heard, Some(stamp));
            }
            CLOCK => {
                if let Some(time) = message::clock(bytes) {
                    self.reports.set_time(time);
                }
            }
            FEEDBACK => {
                let Some((status, names, positions)) = message::feedback(bytes) else {
                    return;
                };
                if let Some(goal) = &mut self.goal
                    && status.id == goal.id()
                {
                    goal.acknowledge();
                    let heard = JointState::heard(&self.joints, &names, |index| {
                        positions.get(index).copied()
                    });
                    self.setpoint = heard.or(self.setpoint.take());
                }
            }
            _ => {
                let (Some(goal), Some((status, code, words))) =
                    (&mut self.goal, message::result(bytes))
                else {
                    return;
                };
                if status.id == goal.id() {
                    let said = format!("{} {words}", status.text);
                    goal.end(ros_1_outcome(
                        i64::from(status.status),
                        i64::from(code),
                        &said,
                    ));
                }
            }
        }
    }
}

impl ActionClient for Ros1Driver {
    fn goal(&self) -> Option<&Goal> {
        self.goal.as_ref()
    }

    fn action(&self) -> &str {
        &self.action
    }

    fn listen(&mut self) -> Result<(), DriverError> {
        read_within_bounds(|| self.read_message())
    }

    fn cancel(&mut self, id: &str) -> Result<(), DriverError> {
        let Some(connection) = &self.connection else {
            return Err(self.lost(format_args!("not connected")));
        };
        match connection.cancellations.publish(&message::cancel(id)) {
            0 => Err(self.lost(format_args!("the action server of {} is gone", self.action))),
            _ => Ok(()),
        }
    }

    fn lost(&self, reason: std::fmt::Arguments<'_>) -> DriverError {
        DriverError::Lost(format!("ROS master {}: {reason}", self.master))
    }
}

impl Driver for Ros1Driver {
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError> {
        self.joints = joints.to_vec();
        let connection = self.open().map_err(|error| {
            self.lost(format_args!(
                "{error}; is it started, and is `master` its address?"
            ))
        })?;
        let begin = Instant::now();
        while connection.goals.subscribers() == 0 || connection.cancellations.subscribers() == 0 {
            if begin.elapsed() > PATIENCE {
                return Err(self.lost(format_args!(
                    "no action server listens to {}/goal; is the controller started?",
                    self.action
                )));
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        self.connection = Some(connection);
        self.reports.open();
        Ok(())
    }

    fn reports_state(&self) -> bool {
        true
    }

    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        self.listen()?;
        Ok(self.reports.state())
    }

    fn setpoint(&self) -> Option<&JointState> {
        self.setpoint.as_ref()
    }

    fn clock(&self) -> Option<(f64, Instant)> {
        self.reports.clock()
    }

    fn sends_goals(&self) -> bool {
        true
    }

    fn start(&mut self, motion: &Interpolant) -> Result<(), DriverError> {
        let Some(connection) = &self.connection else {
            return Err(self.lost(format_args!("not connected")));
        };
        self.setpoint = None;
        let goal = Goal::after(self.goal.as_ref());
        let message = message::goal(&self.joints, motion, goal.id());
        if connection.goals.publish(&message) == 0 {
            return Err(self.lost(format_args!("the action server of {} is gone", self.action)));
        }
        self.goal = Some(goal);
        Ok(())
    }

    fn advance(&mut self, _: f64) -> Result<Progress, DriverError> {
        self.progress()
    }

    fn is_accepted(&self) -> bool {
        self.goal.as_ref().is_some_and(Goal::is_accepted)
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        self.cancel_goal()
    }
}
