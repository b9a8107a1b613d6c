//! `control_msgs/FollowJointTrajectory` through a rosbridge server: JSON over a WebSocket (rosbridge protocol 2).
//!
//! A ROS 1 action is a set of topics: goal and cancellation are published; status, feedback and
//! result are subscribed to. With ROS 2, the server itself is the action client, with the
//! operations `send_action_goal` and `cancel_action_goal`.

use super::action_driver::{ActionDriver, ActionLink, News, unique_name};
use super::rosbridge_goal::{RosVersion, cancellation, duration, goal, result_of, ros_1_topics};
use super::rosbridge_socket::{complaint, end_in_words, open_quiet_socket, read, send};
use super::{DriverError, Interpolant, read_within_bounds};
use serde_json::{Value, json};
use std::net::TcpStream;
use tungstenite::WebSocket;

/// Topic on which a simulated robot publishes its time.
const CLOCK: &str = "/clock";
/// Kind of the goals.
const FOLLOW: &str = "FollowJointTrajectory";

/// A driver through rosbridge.
pub type RosbridgeDriver = ActionDriver<RosbridgeLink>;

impl RosbridgeDriver {
    /// A driver for the server at `host:port`, an action and a topic of joint states.
    pub fn new(address: &str, version: RosVersion, action: &str, joint_states: &str) -> Self {
        Self::over(RosbridgeLink {
            address: address.to_owned(),
            version,
            action: action.to_owned(),
            joint_states: joint_states.to_owned(),
            socket: None,
        })
    }
}

/// A connection to an action server through rosbridge.
pub struct RosbridgeLink {
    address: String,
    version: RosVersion,
    action: String,
    joint_states: String,
    socket: Option<WebSocket<TcpStream>>,
}

impl RosbridgeLink {
    fn send(&mut self, value: &Value) -> Result<(), DriverError> {
        let Some(socket) = &mut self.socket else {
            return Err(self.lost(&"not connected"));
        };
        send(socket, value).map_err(|error| self.lost(&error))
    }

    fn hear(&self, message: &Value, news: &mut News<String>) {
        match (message["op"].as_str(), message["topic"].as_str()) {
            (Some("publish"), Some(topic)) if topic == self.joint_states => {
                hear_state(&message["msg"], news);
            }
            (Some("publish"), Some(CLOCK)) => {
                if let Some(time) = clock_time(&message["msg"]["clock"]) {
                    news.set_time(time);
                }
            }
            (Some("publish" | "action_feedback" | "action_result"), _) => {
                self.hear_action(message, news);
            }
            _ => self.hear_complaint(message, news),
        }
    }

    /// An error of the server ends the goal only if it names the goal. Other errors may concern
    /// other clients.
    fn hear_complaint(&self, message: &Value, news: &mut News<String>) {
        let (Some(words), Some(goal)) = (complaint(message), &mut news.goal) else {
            return;
        };
        if message["id"] == **goal.id() {
            let reason = format!("rosbridge at {}: {words}", self.address);
            goal.end(Err(DriverError::Refused(reason)));
        } else {
            goal.note_complaint(words);
        }
    }

    /// Stores reports about the goal.
    fn hear_action(&self, message: &Value, news: &mut News<String>) {
        let Some(goal) = &mut news.goal else { return };
        let feedback = feedback_of(&self.action, goal.id(), message);
        if let Some(outcome) = result_of(&self.action, goal.id(), message) {
            goal.end(outcome);
        } else if speaks_of(&self.action, goal.id(), message) {
            goal.acknowledge();
        }
        if let Some(feedback) = feedback
            && let Some(names) = feedback["joint_names"].as_array()
            && let Some(positions) = feedback["desired"]["positions"].as_array()
        {
            news.add_setpoint(names, |index| positions.get(index)?.as_f64());
        }
    }

    /// Reads one message; `false` if none has arrived.
    fn read_message(&mut self, news: &mut News<String>) -> Result<bool, DriverError> {
        let Some(socket) = &mut self.socket else {
            return Err(self.lost(&"not connected"));
        };
        let message = read(socket).map_err(|error| {
            self.socket = None;
            self.lost(&end_in_words(&error))
        })?;
        if let Some(message) = &message {
            self.hear(message, news);
        }
        Ok(message.is_some())
    }
}

impl ActionLink for RosbridgeLink {
    type Id = String;

    fn unique() -> String {
        unique_name()
    }

    fn action(&self) -> &str {
        &self.action
    }

    fn lost(&self, reason: &dyn std::fmt::Display) -> DriverError {
        DriverError::Lost(format!("rosbridge at {}: {reason}", self.address))
    }

    fn open(&mut self) -> Result<(), DriverError> {
        let socket = open_quiet_socket(&self.address).map_err(|reason| self.lost(&reason))?;
        self.socket = Some(socket);
        // Subscribe to the clock before the joint states: a motion starts when these arrive, and
        // needs the clock then.
        for (topic, package, name) in [
            (CLOCK, "rosgraph_msgs", "Clock"),
            (&self.joint_states.clone(), "sensor_msgs", "JointState"),
        ] {
            let message_type = self.version.message_type(package, name);
            self.send(&json!({ "op": "subscribe", "topic": topic, "type": message_type }))?;
        }
        if self.version == RosVersion::One {
            let heard = ["status", "feedback", "result"];
            for message in ros_1_topics(&self.action, FOLLOW, &heard) {
                self.send(&message)?;
            }
        }
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
        let point = |(time, point, velocities): (f64, &Vec<f64>, &Vec<f64>)| {
            json!({
                "positions": rounded(point),
                "velocities": rounded(velocities),
                "accelerations": [],
                "effort": [],
                "time_from_start": duration(self.version, time),
            })
        };
        let points: Vec<Value> = motion.rows().map(point).collect();
        let body = json!({ "trajectory": { "joint_names": joints, "points": points } });
        self.send(&goal(self.version, &self.action, FOLLOW, id, body))
    }

    fn cancel(&mut self, id: &String) -> Result<(), DriverError> {
        self.send(&cancellation(self.version, &self.action, id))
    }
}

fn hear_state(message: &Value, news: &mut News<String>) {
    let (Some(names), Some(positions)) =
        (message["name"].as_array(), message["position"].as_array())
    else {
        return;
    };
    let stamp = clock_time(&message["header"]["stamp"]);
    let position = |index: usize| positions.get(index)?.as_f64();
    let effort = |index: usize| message["effort"].get(index)?.as_f64();
    news.add_state(names, position, effort, stamp);
}

/// Rounds numbers to a nanoradian or nanometre, which halves the size of messages; servers limit
/// this size.
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

/// Whether a message acknowledges a goal: the status list of ROS 1, or feedback.
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
    use super::super::action_driver::Goal;
    use super::*;
    use proptest::prelude::*;

    /// Random messages composed of words that servers use.
    fn message() -> impl Strategy<Value = Value> {
        let words = "op publish status action_result action_feedback topic /arm/status /arm/feedback /arm/result /joint_states /clock msg name position \
                     a clock secs nsecs goal_id id level error feedback desired positions joint_names values error_code result status_list";
        let word = prop::sample::select(words.split(' ').collect::<Vec<_>>());
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
        fn no_message_causes_a_panic(messages in prop::collection::vec(message(), 1..4)) {
            let link = RosbridgeLink {
                address: "server".into(),
                version: RosVersion::One,
                action: "/arm".into(),
                joint_states: "/joint_states".into(),
                socket: None,
            };
            let mut news = News::of(vec!["a".into(), "position".into()]);
            news.goal = Some(Goal::after(None, "g".to_owned()));
            for message in messages {
                link.hear(&message, &mut news);
            }
        }
    }
}
