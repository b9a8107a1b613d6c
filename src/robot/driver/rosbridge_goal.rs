//! Goals of actions over rosbridge: topics for ROS 1, operations of rosbridge for ROS 2.

use super::DriverError;
use super::follow_joint_trajectory::{ros_1_outcome, ros_2_outcome};
use serde_json::{Value, json};

/// ROS version behind the server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RosVersion {
    /// ROS 1.
    One,
    /// ROS 2.
    Two,
}

/// Package of the action messages.
const PACKAGE: &str = "control_msgs";

impl RosVersion {
    /// Name of a message type in a package.
    pub(super) fn message_type(self, package: &str, name: &str) -> String {
        match self {
            Self::One => format!("{package}/{name}"),
            Self::Two => format!("{package}/msg/{name}"),
        }
    }
}

/// The messages that open the topics of a ROS 1 action: they subscribe to the topics `heard`, and
/// advertise goal and cancellation.
pub(super) fn ros_1_topics(action: &str, kind: &str, heard: &[&str]) -> Vec<Value> {
    let message = |part: &str| format!("{PACKAGE}/{kind}Action{part}");
    let open = |op: &str, topic: &str| {
        let message_type = match topic {
            "status" => "actionlib_msgs/GoalStatusArray".to_owned(),
            "feedback" => message("Feedback"),
            "result" => message("Result"),
            "goal" => message("Goal"),
            _ => "actionlib_msgs/GoalID".to_owned(),
        };
        json!({ "op": op, "topic": format!("{action}/{topic}"), "type": message_type })
    };
    let subscribed = heard.iter().map(|topic| open("subscribe", topic));
    let advertised = ["goal", "cancel"].map(|topic| open("advertise", topic));
    subscribed.chain(advertised).collect()
}

/// A duration or time, s.
pub(super) fn duration(version: RosVersion, seconds: f64) -> Value {
    let (whole, rest) = (seconds.floor(), (seconds.fract() * 1e9).round());
    let (whole, rest) = if rest >= 1e9 {
        (whole + 1.0, 0.0)
    } else {
        (whole, rest)
    };
    match version {
        RosVersion::One => json!({ "secs": whole as i64, "nsecs": rest as i64 }),
        RosVersion::Two => json!({ "sec": whole as i64, "nanosec": rest as i64 }),
    }
}

/// The message that sends a goal of a kind, such as `GripperCommand`.
pub(super) fn goal(version: RosVersion, action: &str, kind: &str, id: &str, body: Value) -> Value {
    match version {
        RosVersion::One => json!({
            "op": "publish",
            // Servers quote this id in errors about the message.
            "id": id,
            "topic": format!("{action}/goal"),
            "msg": { "goal_id": { "stamp": duration(version, 0.0), "id": id }, "goal": body },
        }),
        RosVersion::Two => json!({
            "op": "send_action_goal",
            "id": id,
            "action": action,
            "action_type": format!("{PACKAGE}/action/{kind}"),
            "args": body,
            "feedback": true,
        }),
    }
}

/// The message that cancels a goal.
pub(super) fn cancellation(version: RosVersion, action: &str, id: &str) -> Value {
    match version {
        RosVersion::One => json!({
            "op": "publish",
            "topic": format!("{action}/cancel"),
            "msg": { "stamp": duration(version, 0.0), "id": id },
        }),
        RosVersion::Two => json!({ "op": "cancel_action_goal", "id": id, "action": action }),
    }
}

/// How a goal ended, if a message reports it.
pub(super) fn result_of(
    action: &str,
    id: &str,
    message: &Value,
) -> Option<Result<(), DriverError>> {
    if message["op"] == "action_result" {
        return (message["id"] == *id).then(|| bridged_outcome(message));
    }
    let topic = message["topic"].as_str().unwrap_or_default();
    let said = &message["msg"];
    let is_ours = said["status"]["goal_id"]["id"] == *id;
    if topic.strip_prefix(action) != Some("/result") || !is_ours {
        return None;
    }
    let status = said["status"]["status"].as_i64().unwrap_or(0);
    let code = said["result"]["error_code"].as_i64().unwrap_or(0);
    let words = [&said["status"]["text"], &said["result"]["error_string"]];
    let words: Vec<&str> = words.iter().filter_map(|text| text.as_str()).collect();
    Some(ros_1_outcome(status, code, &words.join(" ")))
}

/// The end of a ROS 2 goal as reported by the server.
fn bridged_outcome(message: &Value) -> Result<(), DriverError> {
    let values = &message["values"];
    let said = values["error_string"].as_str().or(values.as_str());
    let status = match (&message["result"], message["status"].as_i64()) {
        (Value::Bool(false), _) => None,
        // The first versions of the server report success without a status.
        (_, status) => Some(status.unwrap_or(4)),
    };
    let code = values["error_code"].as_i64().unwrap_or(0);
    ros_2_outcome(status, code, said.unwrap_or_default())
}
