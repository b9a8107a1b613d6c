//! A gripper behind rosbridge: the action `control_msgs/GripperCommand`.

use super::rosbridge_goal::{ActionName, RosVersion, cancellation, goal, result_of};
use super::rosbridge_socket::{open_socket, send};
use super::{DriverError, GripperDriver};
use serde_json::{Value, json};
use std::io::ErrorKind;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use tungstenite::Message;
use tungstenite::protocol::WebSocketConfig;

/// Largest message of the server, bytes.
const LARGEST_MESSAGE: usize = 1 << 20;
/// Time between looks.
const LOOK: Duration = Duration::from_millis(2);
/// What it is sent to do.
const COMMAND: ActionName = ActionName {
    package: "control_msgs",
    name: "GripperCommand",
};

/// A gripper by its action at a rosbridge server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosbridgeGripper {
    /// `host:port`.
    pub address: String,
    /// Which ROS is behind the server.
    pub version: RosVersion,
    /// Name of the action.
    pub action: String,
}

impl GripperDriver for RosbridgeGripper {
    fn command(
        &self,
        opening: f64,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let config = WebSocketConfig::default()
            .max_message_size(Some(LARGEST_MESSAGE))
            .max_frame_size(Some(LARGEST_MESSAGE));
        let mut socket = open_socket(&self.address, config).map_err(|error| self.lost(error))?;
        let quiet = socket.get_ref().set_nonblocking(true);
        quiet.map_err(|error| self.lost(error))?;
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let id = format!("rodlab-{}", now.map_or(0, |now| now.as_nanos()));
        if self.version == RosVersion::One {
            for (op, topic, kind) in [
                (
                    "subscribe",
                    "result",
                    "control_msgs/GripperCommandActionResult",
                ),
                ("advertise", "goal", "control_msgs/GripperCommandActionGoal"),
                ("advertise", "cancel", "actionlib_msgs/GoalID"),
            ] {
                let topic = format!("{}/{topic}", self.action);
                let message = json!({ "op": op, "topic": topic, "type": kind });
                send(&mut socket, &message).map_err(|error| self.lost(error))?;
            }
        }
        let body = json!({ "command": { "position": opening, "max_effort": 0.0 } });
        let message = goal(self.version, &self.action, &COMMAND, &id, body);
        send(&mut socket, &message).map_err(|error| self.lost(error))?;
        let begin = Instant::now();
        while begin.elapsed() < patience {
            if is_interrupted() {
                let cancel = cancellation(self.version, &self.action, &id);
                send(&mut socket, &cancel).map_err(|error| self.lost(error))?;
                return Err(DriverError::Aborted("interrupted".into()));
            }
            match socket.read() {
                Ok(Message::Text(text)) => {
                    let message: Value = serde_json::from_str(&text).unwrap_or_default();
                    if let Some(outcome) = result_of(&self.action, &id, &message) {
                        return outcome;
                    }
                    if message["op"] == "status" && message["level"] == "error" {
                        let said = message["msg"].as_str().unwrap_or("an error without words");
                        return Err(DriverError::Refused(self.in_words(said)));
                    }
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => {
                    std::thread::sleep(LOOK);
                }
                Err(error) => return Err(self.lost(error)),
            }
        }
        Err(self.lost(format_args!(
            "the gripper {} has not moved within {} s; is it started, and is this its action?",
            self.action,
            patience.as_secs_f64()
        )))
    }
}

impl RosbridgeGripper {
    fn lost(&self, reason: impl std::fmt::Display) -> DriverError {
        DriverError::Lost(self.in_words(reason))
    }

    fn in_words(&self, reason: impl std::fmt::Display) -> String {
        format!("rosbridge at {}: {reason}", self.address)
    }
}
