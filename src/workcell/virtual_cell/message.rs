//! Messages between clients and a rosbridge server: JSON, by the rosbridge protocol 2.

use super::subscription::Wish;
use rodlab_robot::{PartTrajectory, RosVersion};
use serde_json::{Value, json};
use std::time::Duration;

/// Largest number of points of a trajectory.
const MOST_POINTS: usize = 200_000;
/// Largest number of joints of a trajectory.
const MOST_JOINTS: usize = 64;
/// Largest number of values in a message: a trajectory with 100,000 points of six joints with
/// velocities.
const MOST_VALUES: usize = 2_000_000;
/// Greatest length of the name of a topic, an action or a goal, bytes.
const LONGEST_NAME: usize = 256;

/// Longest time between two messages that a client may request, ms.
const LONGEST_THROTTLE: u64 = 3_600_000;
/// Largest number of messages that a client may queue.
const MOST_QUEUED: u64 = 100;

/// Request of a client.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Subscribes to a topic.
    Subscribe(String, Wish),
    /// Ends the subscription with an id, or all subscriptions to the topic.
    Unsubscribe(String, Option<String>),
    /// Sends a goal to an action.
    Goal {
        /// Name of the action.
        action: String,
        /// Name of the goal.
        id: String,
        /// Body of the goal.
        body: Value,
    },
    /// Cancels a goal, or every goal if the id is empty.
    Cancel {
        /// Name of the action.
        action: String,
        /// Name of the goal.
        id: String,
    },
    /// A request that the server of a simulated cell ignores.
    Nothing,
}

impl Request {
    /// Reads a message.
    ///
    /// # Errors
    /// A message: the text is not JSON, or the request is not supported.
    pub fn read(text: &str) -> Result<Self, String> {
        // Each JSON value takes far more memory than its text.
        let separators = text.bytes().filter(|byte| b",[{".contains(byte)).count();
        if separators > MOST_VALUES {
            return Err(format!(
                "a message of {separators} values; at most {MOST_VALUES} are allowed"
            ));
        }
        let message: Value =
            serde_json::from_str(text).map_err(|error| format!("not JSON: {error}"))?;
        let name = |value: &Value, what: &str| match value.as_str() {
            Some(name) if name.len() <= LONGEST_NAME => Ok(name.to_owned()),
            _ => Err(format!(
                "a {what} of at most {LONGEST_NAME} bytes is needed"
            )),
        };
        let number = |key: &str| match &message[key] {
            Value::Null => Ok(None),
            value => value
                .as_u64()
                .map(Some)
                .ok_or_else(|| format!("{key}: a whole number from 0 up is needed")),
        };
        let subscription = || match &message["id"] {
            Value::Null => Ok(None),
            id => name(id, "id").map(Some),
        };
        let op = message["op"].as_str().unwrap_or_default();
        match op {
            "subscribe" => {
                let throttle = number("throttle_rate")?.unwrap_or(0);
                let wish = Wish {
                    id: subscription()?,
                    throttle: Duration::from_millis(throttle.min(LONGEST_THROTTLE)),
                    // Messages are not queued unless a client requests it.
                    queue: number("queue_length")?
                        .map_or(0, |length| length.min(MOST_QUEUED) as usize),
                };
                Ok(Self::Subscribe(name(&message["topic"], "topic")?, wish))
            }
            "unsubscribe" => {
                let topic = name(&message["topic"], "topic")?;
                Ok(Self::Unsubscribe(topic, subscription()?))
            }
            "advertise" | "unadvertise" | "set_level" | "status" => Ok(Self::Nothing),
            "publish" => {
                let topic = name(&message["topic"], "topic")?;
                let said = &message["msg"];
                if let Some(action) = topic.strip_suffix("/goal") {
                    return Ok(Self::Goal {
                        action: action.to_owned(),
                        id: name(&said["goal_id"]["id"], "goal_id")?,
                        body: said["goal"].clone(),
                    });
                }
                if let Some(action) = topic.strip_suffix("/cancel") {
                    return Ok(Self::Cancel {
                        action: action.to_owned(),
                        id: name(&said["id"], "id")?,
                    });
                }
                Err(format!("no subscriber for {topic}"))
            }
            "send_action_goal" => Ok(Self::Goal {
                action: name(&message["action"], "action")?,
                id: name(&message["id"], "id")?,
                body: message["args"].clone(),
            }),
            "cancel_action_goal" => Ok(Self::Cancel {
                action: name(&message["action"], "action")?,
                id: name(&message["id"], "id")?,
            }),
            _ => {
                let op: String = op.chars().take(LONGEST_NAME).collect();
                Err(format!("the operation {op:?} is not supported"))
            }
        }
    }
}

/// The trajectory in the goal of a `control_msgs/FollowJointTrajectory`.
///
/// # Errors
/// The body has no trajectory, or the trajectory is too long.
pub fn trajectory(body: &Value) -> Result<PartTrajectory, String> {
    let given = &body["trajectory"];
    let list = |value: &Value, what: &str, most: usize| match value.as_array() {
        Some(list) if list.len() <= most => Ok(list.clone()),
        Some(_) => Err(format!("{what}: at most {most} are allowed")),
        None => Err(format!("{what}: a list is needed")),
    };
    let joints = list(&given["joint_names"], "joint_names", MOST_JOINTS)?;
    let joints: Option<Vec<String>> = joints
        .iter()
        .map(|name| name.as_str().map(str::to_owned))
        .collect();
    let joints = joints.ok_or("joint_names: names are needed")?;
    let mut times = Vec::new();
    let mut points = Vec::new();
    for point in list(&given["points"], "points", MOST_POINTS)? {
        let positions = list(&point["positions"], "positions", MOST_JOINTS)?;
        let positions: Option<Vec<f64>> = positions.iter().map(Value::as_f64).collect();
        let positions = positions.filter(|positions| positions.len() == joints.len());
        points.push(positions.ok_or("positions: a number for each joint is needed")?);
        times.push(seconds(&point["time_from_start"]).ok_or("time_from_start: a time is needed")?);
    }
    Ok(PartTrajectory {
        joints,
        times,
        points,
    })
}

/// The opening in the goal of a `control_msgs/GripperCommand`, m.
///
/// # Errors
/// The body has no opening.
pub fn opening(body: &Value) -> Result<f64, String> {
    let opening = body["command"]["position"].as_f64();
    opening.ok_or_else(|| "command.position: a number is needed".into())
}

/// A time of ROS 1 or ROS 2, s.
fn seconds(time: &Value) -> Option<f64> {
    let part = |one: &str, two: &str| time[one].as_f64().or_else(|| time[two].as_f64());
    Some(part("secs", "sec")? + 1e-9 * part("nsecs", "nanosec")?)
}

/// A time, s, in the format of either ROS version.
pub fn stamp(version: RosVersion, time: f64) -> Value {
    let (whole, rest) = (time.floor() as i64, (time.fract() * 1e9) as i64);
    match version {
        RosVersion::One => json!({ "secs": whole, "nsecs": rest }),
        RosVersion::Two => json!({ "sec": whole, "nanosec": rest }),
    }
}

/// A message on a topic.
pub fn published(topic: &str, message: Value) -> String {
    json!({ "op": "publish", "topic": topic, "msg": message }).to_string()
}

/// An error about a message of a client, with the id of the goal to which the message refers.
pub fn complaint(words: &str, goal: Option<&str>) -> String {
    let mut message = json!({ "op": "status", "level": "error", "msg": words });
    if let Some(goal) = goal {
        message["id"] = json!(goal);
    }
    message.to_string()
}

/// A goal as its client identifies it.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalName {
    /// Version of ROS of the action.
    pub version: RosVersion,
    /// Name of the action.
    pub action: String,
    /// Name of the goal.
    pub id: String,
}

/// Result of a goal.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Succeeded.
    Succeeded,
    /// Cancelled by a client.
    Cancelled,
    /// Rejected or aborted: error code and message.
    Aborted(i64, String),
}

impl Verdict {
    /// The corresponding `actionlib_msgs/GoalStatus`.
    pub fn status_of_ros_1(&self) -> u8 {
        match self {
            Self::Succeeded => 3,
            Self::Cancelled => 2,
            Self::Aborted(..) => 4,
        }
    }
}

impl GoalName {
    /// Message that the goal is active.
    pub fn feedback(&self) -> String {
        match self.version {
            RosVersion::One => published(
                &format!("{}/feedback", self.action),
                json!({ "status": { "goal_id": { "id": self.id }, "status": 1 }, "feedback": {} }),
            ),
            RosVersion::Two => json!({
                "op": "action_feedback", "id": self.id, "action": self.action, "values": {},
            })
            .to_string(),
        }
    }

    /// Message with the result of the goal.
    pub fn result(&self, verdict: &Verdict) -> String {
        let (status_2, code, words) = match verdict {
            Verdict::Succeeded => (4, 0, ""),
            Verdict::Cancelled => (5, 0, ""),
            Verdict::Aborted(code, words) => (6, *code, words.as_str()),
        };
        let status_1 = verdict.status_of_ros_1();
        let values = json!({ "error_code": code, "error_string": words });
        match self.version {
            RosVersion::One => published(
                &format!("{}/result", self.action),
                json!({
                    "status": { "goal_id": { "id": self.id }, "status": status_1, "text": "" },
                    "result": values,
                }),
            ),
            RosVersion::Two => json!({
                "op": "action_result", "id": self.id, "action": self.action,
                "status": status_2, "result": true, "values": values,
            })
            .to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_of_both_versions_are_equivalent() {
        let body = json!({ "trajectory": { "joint_names": ["a"], "points": [
            { "positions": [0.5], "time_from_start": { "secs": 1, "nsecs": 500_000_000 } } ] } });
        let one = json!({ "op": "publish", "topic": "/arm/goal",
            "msg": { "goal_id": { "id": "g" }, "goal": body } });
        let two = json!({ "op": "send_action_goal", "action": "/arm", "id": "g", "args": body });
        let [one, two] = [one, two].map(|message| Request::read(&message.to_string()).unwrap());
        assert_eq!(one, two);
        let Request::Goal { body, .. } = one else {
            panic!("a goal");
        };
        let found = trajectory(&body).unwrap();
        assert_eq!((found.times, found.points), (vec![1.5], vec![vec![0.5]]));
    }

    #[test]
    fn invalid_messages_are_rejected_with_a_reason() {
        let long = "x".repeat(300);
        let throttled = json!({ "op": "subscribe", "topic": "/clock", "throttle_rate": -1 });
        for (message, expected) in [
            (json!({ "op": "shout" }), "not supported"),
            (json!({ "op": "subscribe" }), "a topic"),
            (throttled, "throttle_rate"),
            (json!({ "op": "subscribe", "topic": long }), "a topic"),
            (
                json!({ "op": "publish", "topic": "/chat", "msg": {} }),
                "no subscriber",
            ),
        ] {
            let error = Request::read(&message.to_string()).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
        assert!(Request::read("{").unwrap_err().contains("not JSON"));
        for body in [
            json!({}),
            json!({ "trajectory": { "joint_names": ["a"], "points": [{ "positions": [] }] } }),
            json!({ "trajectory": { "joint_names": vec!["a"; 65], "points": [] } }),
            json!({ "trajectory": { "joint_names": [1], "points": [] } }),
        ] {
            assert!(trajectory(&body).is_err(), "{body}");
        }
        assert!(opening(&json!({ "command": { "position": "wide" } })).is_err());
    }
}
