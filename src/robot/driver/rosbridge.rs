//! `control_msgs/FollowJointTrajectory` through a rosbridge server: JSON over a WebSocket (rosbridge protocol 2).
//!
//! A ROS 1 action is a set of topics: the goal and its cancellation are published, status, feedback and result are
//! subscribed. For ROS 2 the server itself is the action client: `send_action_goal`, `cancel_action_goal`.

use super::action_client::{ActionClient, Goal};
use super::follow_joint_trajectory::{ros_1_outcome, ros_2_outcome};
use super::{Driver, DriverError, JointState, PartTrajectory, Progress};
use serde_json::{Value, json};
use std::io::ErrorKind;
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// Longest time for a connection, and for a message to leave.
const PATIENCE: Duration = Duration::from_secs(2);

/// Which ROS is behind the server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RosVersion {
    /// ROS 1.
    One,
    /// ROS 2.
    Two,
}

/// A driver through rosbridge.
pub struct RosbridgeDriver {
    address: String,
    version: RosVersion,
    action: String,
    joint_states: String,
    joints: Vec<String>,
    socket: Option<WebSocket<TcpStream>>,
    state: Option<JointState>,
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
            state: None,
            goal: None,
        }
    }

    fn send(&mut self, value: &Value) -> Result<(), DriverError> {
        let Some(socket) = &mut self.socket else {
            return Err(self.lost(format_args!("not connected")));
        };
        let mut result = socket.send(Message::text(value.to_string()));
        let begin = Instant::now();
        // A long goal may fill the socket's buffer; the rest follows as the server reads.
        while let Err(tungstenite::Error::Io(error)) = &result {
            if error.kind() != ErrorKind::WouldBlock || begin.elapsed() > PATIENCE {
                break;
            }
            std::thread::sleep(Duration::from_millis(1));
            result = socket.flush();
        }
        result.map_err(|error| self.lost(format_args!("{error}")))
    }

    fn hear(&mut self, message: &Value) {
        match (message["op"].as_str(), message["topic"].as_str()) {
            (Some("publish"), Some(topic)) if topic == self.joint_states => {
                self.hear_state(&message["msg"]);
            }
            (Some("publish"), Some(topic)) => {
                if let Some(what) = topic.strip_prefix(&self.action) {
                    let what = what.to_owned();
                    self.hear_action(&what, &message["msg"]);
                }
            }
            (Some("action_feedback"), _) => {
                if let Some(goal) = self
                    .goal
                    .as_mut()
                    .filter(|goal| message["id"] == *goal.id())
                {
                    goal.acknowledge();
                }
            }
            (Some("action_result"), _) => {
                if let Some(goal) = self
                    .goal
                    .as_mut()
                    .filter(|goal| message["id"] == *goal.id())
                {
                    goal.end(bridged_outcome(message));
                }
            }
            (Some("status"), _) if message["level"] == "error" => {
                let said = message["msg"].as_str().unwrap_or("an error without words");
                let error = DriverError::Refused(format!("rosbridge at {}: {said}", self.address));
                if let Some(goal) = &mut self.goal {
                    goal.end(Err(error));
                }
            }
            _ => {}
        }
    }

    fn hear_state(&mut self, message: &Value) {
        let (Some(names), Some(positions)) =
            (message["name"].as_array(), message["position"].as_array())
        else {
            return;
        };
        let heard = JointState::heard(&self.joints, |joint| {
            let index = names.iter().position(|name| name == joint.as_str())?;
            positions.get(index)?.as_f64()
        });
        self.state = heard.or(self.state.take());
    }

    /// Topics of a ROS 1 action.
    fn hear_action(&mut self, what: &str, message: &Value) {
        let Some(goal) = &mut self.goal else { return };
        let ours = |status: &Value| status["goal_id"]["id"] == *goal.id();
        match what {
            "/status" => {
                let list = message["status_list"].as_array();
                if list.is_some_and(|list| list.iter().any(ours)) {
                    goal.acknowledge();
                }
            }
            "/feedback" if ours(&message["status"]) => goal.acknowledge(),
            "/result" if ours(&message["status"]) => {
                let status = message["status"]["status"].as_i64().unwrap_or(0);
                let code = message["result"]["error_code"].as_i64().unwrap_or(0);
                let said = [
                    &message["status"]["text"],
                    &message["result"]["error_string"],
                ];
                let said: Vec<&str> = said.iter().filter_map(|text| text.as_str()).collect();
                goal.end(ros_1_outcome(status, code, &said.join(" ")));
            }
            _ => {}
        }
    }

    fn goal_message(&self, trajectory: &PartTrajectory, id: &str) -> Value {
        let one = self.version == RosVersion::One;
        let duration = |seconds: f64| {
            let (whole, rest) = (seconds.floor(), (seconds.fract() * 1e9).round());
            let (whole, rest) = if rest >= 1e9 {
                (whole + 1.0, 0.0)
            } else {
                (whole, rest)
            };
            if one {
                json!({ "secs": whole as i64, "nsecs": rest as i64 })
            } else {
                json!({ "sec": whole as i64, "nanosec": rest as i64 })
            }
        };
        let rows = trajectory.times.iter().zip(&trajectory.points);
        let points: Vec<Value> = rows
            .zip(trajectory.velocities())
            .map(|((time, point), velocities)| {
                json!({
                    "positions": point,
                    "velocities": velocities,
                    "accelerations": [],
                    "effort": [],
                    "time_from_start": duration(*time),
                })
            })
            .collect();
        let body = json!({
            "trajectory": { "joint_names": trajectory.joints, "points": points },
        });
        if one {
            json!({
                "op": "publish",
                "topic": format!("{}/goal", self.action),
                "msg": { "goal_id": { "stamp": duration(0.0), "id": id }, "goal": body },
            })
        } else {
            json!({
                "op": "send_action_goal",
                "id": id,
                "action": self.action,
                "action_type": "control_msgs/action/FollowJointTrajectory",
                "args": body,
                "feedback": true,
            })
        }
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
        loop {
            let Some(socket) = &mut self.socket else {
                return Err(self.lost(format_args!("not connected")));
            };
            match socket.read() {
                Ok(Message::Text(text)) => {
                    if let Ok(message) = serde_json::from_str::<Value>(&text) {
                        self.hear(&message);
                    }
                }
                Ok(Message::Close(_)) => {
                    self.socket = None;
                    return Err(self.lost(format_args!("the server closed the connection")));
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => {
                    return Ok(());
                }
                Err(error) => {
                    self.socket = None;
                    return Err(self.lost(format_args!("the connection is lost: {error}")));
                }
            }
        }
    }

    fn cancel(&mut self, id: &str) -> Result<(), DriverError> {
        let cancel = match self.version {
            RosVersion::One => json!({
                "op": "publish",
                "topic": format!("{}/cancel", self.action),
                "msg": { "stamp": { "secs": 0, "nsecs": 0 }, "id": id },
            }),
            RosVersion::Two => {
                json!({ "op": "cancel_action_goal", "id": id, "action": self.action })
            }
        };
        self.send(&cancel)
    }

    fn lost(&self, reason: std::fmt::Arguments<'_>) -> DriverError {
        DriverError::Lost(format!("rosbridge at {}: {reason}", self.address))
    }
}

impl Driver for RosbridgeDriver {
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError> {
        self.joints = joints.to_vec();
        let socket = open_socket(&self.address, WebSocketConfig::default())
            .map_err(|reason| self.lost(format_args!("{reason}")))?;
        let prepared = socket.get_ref().set_nonblocking(true);
        self.socket = Some(socket);
        prepared.map_err(|error| self.lost(format_args!("{error}")))?;
        let one = self.version == RosVersion::One;
        let state_type = if one {
            "sensor_msgs/JointState"
        } else {
            "sensor_msgs/msg/JointState"
        };
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
        Ok(self.state.clone())
    }

    fn start(&mut self, trajectory: &PartTrajectory) -> Result<(), DriverError> {
        let goal = Goal::new();
        let message = self.goal_message(trajectory, goal.id());
        self.send(&message)?;
        self.goal = Some(goal);
        Ok(())
    }

    fn advance(&mut self, _: f64) -> Result<Progress, DriverError> {
        self.progress()
    }

    fn hold(&mut self) -> Result<(), DriverError> {
        self.cancel_and_wait()
    }
}

/// A WebSocket to the server at `host:port`.
///
/// # Errors
/// In words.
pub(super) fn open_socket(
    address: &str,
    config: WebSocketConfig,
) -> Result<WebSocket<TcpStream>, String> {
    let resolved = address
        .to_socket_addrs()
        .map_err(|error| error.to_string())?;
    let mut stream = Err(std::io::Error::from(ErrorKind::AddrNotAvailable));
    for address in resolved {
        stream = TcpStream::connect_timeout(&address, PATIENCE);
        if stream.is_ok() {
            break;
        }
    }
    let stream =
        stream.map_err(|error| format!("no connection: {error}; is the server started?"))?;
    stream
        .set_nodelay(true)
        .and_then(|()| stream.set_read_timeout(Some(PATIENCE)))
        .map_err(|error| error.to_string())?;
    let url = format!("ws://{address}/");
    let (socket, _) = tungstenite::client::client_with_config(url, stream, Some(config))
        .map_err(|error| format!("no WebSocket: {error}"))?;
    Ok(socket)
}

/// The end of a ROS 2 goal as the server tells it.
fn bridged_outcome(message: &Value) -> Result<(), DriverError> {
    let values = &message["values"];
    let said = values["error_string"].as_str().or(values.as_str());
    let status = match (&message["result"], message["status"].as_i64()) {
        (Value::Bool(false), _) => None,
        // Servers of the first versions tell no status of a success.
        (_, status) => Some(status.unwrap_or(4)),
    };
    let code = values["error_code"].as_i64().unwrap_or(0);
    ros_2_outcome(status, code, said.unwrap_or_default())
}
