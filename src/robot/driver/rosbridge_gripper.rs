//! A gripper behind rosbridge: the action `control_msgs/GripperCommand`.

use super::rosbridge_goal::{ActionName, RosVersion, cancellation, goal, result_of};
use super::rosbridge_socket::{open_socket, send};
use super::{DriverError, GripperDriver};
use serde_json::{Value, json};
use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use tungstenite::{Message, WebSocket};

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
#[derive(Clone, Debug, PartialEq)]
pub struct RosbridgeGripper {
    /// `host:port`.
    pub address: String,
    /// Which ROS is behind the server.
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
        let mut socket =
            open_socket(&self.address, LARGEST_MESSAGE).map_err(|error| self.lost(error))?;
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
        let command = json!({ "position": opening, "max_effort": self.max_effort });
        let body = json!({ "command": command });
        let message = goal(self.version, &self.action, &COMMAND, &id, body);
        send(&mut socket, &message).map_err(|error| self.lost(error))?;
        let ended = self.wait(&mut socket, &id, patience, is_interrupted);
        if ended.is_err() {
            // Whatever ended it, the fingers must not move on; the connection may be gone.
            let cancel = cancellation(self.version, &self.action, &id);
            send(&mut socket, &cancel).map_err(|error| self.lost(error))?;
        }
        ended
    }
}

/// Whether a result is that of fingers that hold something on the way: they have stalled, and some controllers abort then.
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

impl RosbridgeGripper {
    /// Waits for the end of a goal.
    fn wait(
        &self,
        socket: &mut WebSocket<TcpStream>,
        id: &str,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let mut complaint = String::new();
        let begin = Instant::now();
        while begin.elapsed() < patience {
            if is_interrupted() {
                return Err(DriverError::Aborted("interrupted".into()));
            }
            match socket.read() {
                Ok(Message::Text(text)) => {
                    let message: Value = serde_json::from_str(&text).unwrap_or_default();
                    if let Some(outcome) = result_of(&self.action, id, &message) {
                        return match is_stalled(&message) {
                            true => Ok(()),
                            false => outcome,
                        };
                    }
                    if message["op"] == "status" && message["level"] == "error" {
                        let words = message["msg"].as_str().unwrap_or("an error without words");
                        if message["id"] == *id {
                            return Err(DriverError::Refused(self.in_words(words)));
                        }
                        // It may be about another client.
                        complaint = format!(" (the server reported: {words})");
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
            "the gripper {} has not moved within {} s; is it started, and is this its action?{complaint}",
            self.action,
            patience.as_secs_f64()
        )))
    }

    fn lost(&self, reason: impl std::fmt::Display) -> DriverError {
        DriverError::Lost(self.in_words(reason))
    }

    fn in_words(&self, reason: impl std::fmt::Display) -> String {
        format!("rosbridge at {}: {reason}", self.address)
    }
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
