//! `control_msgs/FollowJointTrajectory` through a rosbridge server: JSON over a WebSocket (rosbridge protocol 2).
//!
//! A ROS 1 action is a set of topics: the goal and its cancellation are published, status, feedback and result are
//! subscribed. For ROS 2 the server itself is the action client: `send_action_goal`, `cancel_action_goal`.

use super::action_client::{ActionClient, Goal};
use super::clocked_reports::ClockedReports;
use super::rosbridge_goal::{ActionName, RosVersion, cancellation, duration, goal, result_of};
use super::rosbridge_socket::{open_socket, send};
use super::{Driver, DriverError, Interpolant, JointState, Progress, read_within_bounds};
use serde_json::{Value, json};
use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::Instant;
use tungstenite::{Message, WebSocket};

/// Topic on which a simulated robot publishes its time.
const CLOCK: &str = "/clock";
/// What it is sent to do.
const FOLLOW: ActionName = ActionName {
    package: "control_msgs",
    name: "FollowJointTrajectory",
};

/// Largest message of the server, bytes: states and results of robots are far smaller.
const LARGEST_MESSAGE: usize = 1 << 20;

/// A driver through rosbridge.
pub struct RosbridgeDriver {
    address: String,
    version: RosVersion,
    action: String,
    joint_states: String,
    joints: Vec<String>,
    socket: Option<WebSocket<TcpStream>>,
    reports: ClockedReports,
    setpoint: Option<JointState>,
    goal: Option<Goal>,
}

impl RosbridgeDriver {
    /// A driver for the server at `host:port`, the action of that name and the topic of joint states.
    pub fn new(address: &str, version: RosVersion, action: &str, joint_states: &str) -> Self {
        Self {
            address: address.to_owned(),
            version,
            action: action.to_owned(),
            joint_states: joint_states.to_owned(),
            joints: Vec::new(),
            socket: None,
            reports: ClockedReports::default(),
            setpoint: None,
            goal: None,
        }
    }

    fn send(&mut self, value: &Value) -> Result<(), DriverError> {
        let Some(socket) = &mut self.socket else {
            return Err(self.lost(format_args!("not connected")));
        };
        send(socket, value).map_err(|error| self.lost(format_args!("{error}")))
    }

    fn hear(&mut self, message: &Value) {
        match (message["op"].as_str(), message["topic"].as_str()) {
            (Some("publish"), Some(topic)) if topic == self.joint_states => {
                self.hear_state(&message["msg"]);
            }
            (Some("publish"), Some(CLOCK)) => {
                if let Some(time) = clock_time(&message["msg"]["clock"]) {
                    self.reports.set_time(time);
                }
            }
            (Some("publish" | "action_feedback" | "action_result"), _) => {
                self.hear_action(message);
            }
            (Some("status"), _) if message["level"] == "error" => self.hear_complaint(message),
            _ => {}
        }
    }

    /// An error of the server ends the goal where it names the goal. Others may be about other clients.
    fn hear_complaint(&mut self, message: &Value) {
        let words = message["msg"].as_str().unwrap_or("an error without words");
        let Some(goal) = &mut self.goal else { return };
        if message["id"] == *goal.id() {
            let reason = format!("rosbridge at {}: {words}", self.address);
            goal.end(Err(DriverError::Refused(reason)));
        } else {
            goal.note_complaint(words);
        }
    }

    fn hear_state(&mut self, message: &Value) {
        let (Some(names), Some(positions)) =
            (message["name"].as_array(), message["position"].as_array())
        else {
            return;
        };
        let position = |index: usize| positions.get(index)?.as_f64();
        let heard = JointState::heard(&self.joints, names, position);
        let stamp = clock_time(&message["header"]["stamp"]);
        self.reports.add(heard, stamp);
    }

    /// Reports about the goal.
    fn hear_action(&mut self, message: &Value) {
        let Some(goal) = &mut self.goal else { return };
        if let Some(feedback) = feedback_of(&self.action, goal.id(), message)
            && let Some(names) = feedback["joint_names"].as_array()
            && let Some(positions) = feedback["desired"]["positions"].as_array()
        {
            let heard =
                JointState::heard(&self.joints, names, |index| positions.get(index)?.as_f64());
            self.setpoint = heard.or(self.setpoint.take());
        }
        if let Some(outcome) = result_of(&self.action, goal.id(), message) {
            goal.end(outcome);
        } else if speaks_of(&self.action, goal.id(), message) {
            goal.acknowledge();
        }
    }

    /// Reads one message; `false` where none has arrived.
    fn read_message(&mut self) -> Result<bool, DriverError> {
        let Some(socket) = &mut self.socket else {
            return Err(self.lost(format_args!("not connected")));
        };
        match socket.read() {
            Ok(Message::Text(text)) => {
                if let Ok(message) = serde_json::from_str::<Value>(&text) {
                    self.hear(&message);
                }
                Ok(true)
            }
            Ok(Message::Close(_)) => {
                self.socket = None;
                Err(self.lost(format_args!("the server closed the connection")))
            }
            Ok(_) => Ok(true),
            Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => {
                Ok(false)
            }
            Err(error) => {
                self.socket = None;
                Err(self.lost(format_args!("the connection is lost: {error}")))
            }
        }
    }

    fn goal_message(&self, motion: &Interpolant, id: &str) -> Value {
        let rows = motion.times().iter().zip(motion.points());
        let points: Vec<Value> = rows
            .zip(motion.velocities())
            .map(|((time, point), velocities)| {
                json!({
                    "positions": rounded(point),
                    "velocities": rounded(velocities),
                    "accelerations": [],
                    "effort": [],
                    "time_from_start": duration(self.version, *time),
                })
            })
            .collect();
        let body = json!({
            "trajectory": { "joint_names": self.joints, "points": points },
        });
        goal(self.version, &self.action, &FOLLOW, id, body)
    }
}

impl ActionClient for RosbridgeDriver {
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
        self.send(&cancellation(self.version, &self.action, id))
    }

    fn lost(&self, reason: std::fmt::Arguments<'_>) -> DriverError {
        DriverError::Lost(format!("rosbridge at {}: {reason}", self.address))
    }
}

impl Driver for RosbridgeDriver {
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError> {
        self.joints = joints.to_vec();
        let socket = open_socket(&self.address, LARGEST_MESSAGE)
            .map_err(|reason| self.lost(format_args!("{reason}")))?;
        let prepared = socket.get_ref().set_nonblocking(true);
        self.socket = Some(socket);
        self.reports.open();
        prepared.map_err(|error| self.lost(format_args!("{error}")))?;
        let one = self.version == RosVersion::One;
        let state_type = if one {
            "sensor_msgs/JointState"
        } else {
            "sensor_msgs/msg/JointState"
        };
        let clock_type = if one {
            "rosgraph_msgs/Clock"
        } else {
            "rosgraph_msgs/msg/Clock"
        };
        // Before the states of joints: a motion begins once these are heard, and its clock must be known then.
        self.send(&json!({ "op": "subscribe", "topic": CLOCK, "type": clock_type }))?;
        self.send(&json!({ "op": "subscribe", "topic": self.joint_states, "type": state_type }))?;
        if one {
            for (topic, kind) in [
                ("status", "actionlib_msgs/GoalStatusArray"),
                (
                    "feedback",
                    "control_msgs/FollowJointTrajectoryActionFeedback",
                ),
                ("result", "control_msgs/FollowJointTrajectoryActionResult"),
            ] {
                let topic = format!("{}/{topic}", self.action);
                self.send(&json!({ "op": "subscribe", "topic": topic, "type": kind }))?;
            }
            for (topic, kind) in [
                ("goal", "control_msgs/FollowJointTrajectoryActionGoal"),
                ("cancel", "actionlib_msgs/GoalID"),
            ] {
                let topic = format!("{}/{topic}", self.action);
                self.send(&json!({ "op": "advertise", "topic": topic, "type": kind }))?;
            }
        }
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
        self.setpoint = None;
        let goal = Goal::after(self.goal.as_ref());
        let message = self.goal_message(motion, goal.id());
        self.send(&message)?;
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

/// Numbers to a nanoradian or nanometre, for messages half as long: servers bound the size of a message.
fn rounded(numbers: &[f64]) -> Vec<f64> {
    let to_nano = |number: &f64| (number * 1e9).round() / 1e9;
    numbers.iter().map(to_nano).collect()
}

/// The body of a feedback message of a goal.
fn feedback_of<'a>(action: &str, id: &str, message: &'a Value) -> Option<&'a Value> {
    if message["op"] == "action_feedback" {
        return (message["id"] == *id).then(|| &message["values"]);
    }
    let topic = message["topic"].as_str()?;
    let is_ours = message["msg"]["status"]["goal_id"]["id"] == *id;
    let is_feedback = topic.strip_prefix(action) == Some("/feedback");
    (is_feedback && is_ours).then(|| &message["msg"]["feedback"])
}

/// Whether a message says that a goal is known: the status list of ROS 1, feedback of either.
fn speaks_of(action: &str, id: &str, message: &Value) -> bool {
    if message["op"] == "action_feedback" {
        return message["id"] == *id;
    }
    let ours = |status: &Value| status["goal_id"]["id"] == *id;
    let topic = message["topic"].as_str().unwrap_or_default();
    match topic.strip_prefix(action) {
        Some("/status") => {
            let list = message["msg"]["status_list"].as_array();
            list.is_some_and(|list| list.iter().any(ours))
        }
        Some("/feedback") => ours(&message["msg"]["status"]),
        _ => false,
    }
}

/// A time of ROS 1 or ROS 2, s.
fn clock_time(time: &Value) -> Option<f64> {
    let part = |one: &str, two: &str| time[one].as_f64().or_else(|| time[two].as_f64());
    Some(part("secs", "sec")? + 1e-9 * part("nsecs", "nanosec")?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Messages of words that servers use, in any place.
    fn message() -> impl Strategy<Value = Value> {
        let words = [
            "op",
            "publish",
            "status",
            "action_result",
            "action_feedback",
            "topic",
            "/arm/status",
            "/arm/feedback",
            "/arm/result",
            "/joint_states",
            "/clock",
            "msg",
            "name",
            "position",
            "a",
            "clock",
            "secs",
            "nsecs",
            "goal_id",
            "id",
            "level",
            "error",
            "feedback",
            "desired",
            "positions",
            "joint_names",
            "values",
            "error_code",
            "result",
            "status_list",
        ];
        let word = prop::sample::select(words.to_vec());
        let leaf = prop_oneof![
            word.clone().prop_map(|word| json!(word)),
            any::<f64>().prop_map(|number| json!(number)),
            any::<i64>().prop_map(|number| json!(number)),
            any::<bool>().prop_map(|truth| json!(truth)),
            Just(Value::Null),
        ];
        let inner = leaf.prop_recursive(5, 40, 6, move |inner| {
            let pairs = prop::collection::vec((word.clone(), inner.clone()), 0..6);
            prop_oneof![
                prop::collection::vec(inner, 0..6).prop_map(Value::Array),
                pairs.prop_map(|pairs| pairs
                    .into_iter()
                    .map(|(key, value)| (key.to_owned(), value))
                    .collect()),
            ]
        });
        let op = prop::sample::select(vec![
            "publish",
            "status",
            "action_result",
            "action_feedback",
        ]);
        let topic = prop::sample::select(vec![
            "/clock",
            "/joint_states",
            "/arm/feedback",
            "/arm/result",
            "/arm/status",
        ]);
        (op, topic, inner).prop_map(|(op, topic, inner)| {
            json!({ "op": op, "topic": topic, "id": "g", "level": "error", "msg": inner, "values": inner })
        })
    }

    proptest! {
        #[test]
        fn no_message_makes_it_panic(messages in prop::collection::vec(message(), 1..4)) {
            let mut driver = RosbridgeDriver::new("server", RosVersion::One, "/arm", "/joint_states");
            driver.joints = vec!["a".into(), "position".into()];
            driver.goal = Some(Goal::new());
            for message in messages {
                driver.hear(&message);
            }
        }
    }
}
