//! A gripper behind rosbridge: the action `control_msgs/GripperCommand`.

use super::action_driver::unique_name;
use super::gripper_goal::{GripperGoal, LOOK, wait_for_end};
use super::rosbridge_goal::{RosVersion, cancellation, goal, result_of, ros_1_topics};
use super::rosbridge_socket::{complaint, open_quiet_socket, read, send};
use super::{DriverError, GripperDriver};
use serde_json::{Value, json};
use std::fmt::Display;
use std::net::TcpStream;
use std::time::Duration;
use tungstenite::WebSocket;

/// Kind of the goals.
const COMMAND: &str = "GripperCommand";

/// A gripper by its action at a rosbridge server.
#[derive(Clone, Debug, PartialEq)]
pub struct RosbridgeGripper {
    /// `host:port`.
    pub address: String,
    /// ROS version behind the server.
    pub version: RosVersion,
    /// Name of the action.
    pub action: String,
    /// Greatest effort, N.
    pub max_effort: f64,
}

impl GripperDriver for RosbridgeGripper {
    fn command(
        &self,
        opening: f64,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let socket = open_quiet_socket(&self.address).map_err(|error| self.lost(error))?;
        let mut sent = SentGoal {
            gripper: self,
            socket,
            id: unique_name(),
            complaint: String::new(),
        };
        if self.version == RosVersion::One {
            for message in ros_1_topics(&self.action, COMMAND, &["result"]) {
                sent.send(&message)?;
            }
        }
        let command = json!({ "position": opening, "max_effort": self.max_effort });
        let body = json!({ "command": command });
        sent.send(&goal(self.version, &self.action, COMMAND, &sent.id, body))?;
        wait_for_end(&mut sent, &self.action, patience, is_interrupted)
    }
}

impl RosbridgeGripper {
    fn lost(&self, reason: impl Display) -> DriverError {
        DriverError::Lost(self.in_words(reason))
    }

    fn in_words(&self, reason: impl Display) -> String {
        format!("rosbridge at {}: {reason}", self.address)
    }
}

/// A goal, and the connection over which it was sent.
struct SentGoal<'a> {
    gripper: &'a RosbridgeGripper,
    socket: WebSocket<TcpStream>,
    id: String,
    /// The last error of the server; it may concern another client.
    complaint: String,
}

impl SentGoal<'_> {
    fn send(&mut self, message: &Value) -> Result<(), DriverError> {
        send(&mut self.socket, message).map_err(|error| self.gripper.lost(error))
    }
}

impl GripperGoal for SentGoal<'_> {
    fn has_ended(&mut self) -> Result<bool, DriverError> {
        let message = read(&mut self.socket).map_err(|error| self.gripper.lost(error))?;
        let Some(message) = message else {
            std::thread::sleep(LOOK);
            return Ok(false);
        };
        if let Some(outcome) = result_of(&self.gripper.action, &self.id, &message) {
            return match is_stalled(&message) {
                true => Ok(true),
                false => outcome.map(|()| true),
            };
        }
        if let Some(words) = complaint(&message) {
            if message["id"] == *self.id {
                return Err(DriverError::Refused(self.gripper.in_words(words)));
            }
            self.complaint = format!(" (the server reported: {words})");
        }
        Ok(false)
    }

    /// The connection may already be closed.
    fn cancel(&mut self, error: DriverError) -> DriverError {
        let gripper = self.gripper;
        let message = cancellation(gripper.version, &gripper.action, &self.id);
        self.send(&message).err().unwrap_or(error)
    }

    fn lost(&self, reason: &dyn Display) -> DriverError {
        self.gripper.lost(reason)
    }

    fn advice(&self) -> String {
        format!("; is it started, and is this its action?{}", self.complaint)
    }
}

/// Whether the fingers stalled on an object, upon which some controllers abort.
fn is_stalled(result: &Value) -> bool {
    let (status, values) = match result["op"] == "action_result" {
        true => (result["status"] == 6, &result["values"]),
        false => {
            let message = &result["msg"];
            (message["status"]["status"] == 4, &message["result"])
        }
    };
    status && values["stalled"] == true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_aborted_goal_of_stalled_fingers_is_a_grip() {
        let one = |status: u8, stalled: bool| {
            json!({ "op": "publish", "topic": "/grip/result", "msg": {
                "status": { "goal_id": { "id": "g" }, "status": status },
                "result": { "stalled": stalled } } })
        };
        let two = |status: u8, stalled: bool| json!({ "op": "action_result", "id": "g", "status": status, "values": { "stalled": stalled } });
        assert!(is_stalled(&one(4, true)) && is_stalled(&two(6, true)));
        for other in [one(4, false), one(2, true), two(6, false), two(5, true)] {
            assert!(!is_stalled(&other), "{other}");
        }
    }
}
