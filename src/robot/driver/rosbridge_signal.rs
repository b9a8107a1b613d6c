//! Signals behind a rosbridge server.

use super::DriverError;
use super::rosbridge_socket::{complaint, end_in_words, open_quiet_socket, read, send};
use super::signal::{Reading, Shape, SignalMessage, SignalTopic};
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::net::TcpStream;
use tungstenite::WebSocket;

/// A topic of a signal behind a rosbridge server.
pub struct RosbridgeSignal {
    address: String,
    topic: String,
    shape: Shape,
    socket: WebSocket<TcpStream>,
}

impl RosbridgeSignal {
    /// Subscribes to a topic of the server at `host:port`, whose version of ROS does not matter.
    ///
    /// # Errors
    /// There is no server.
    pub fn open(address: &str, topic: &str, message: SignalMessage) -> Result<Self, DriverError> {
        let lost = |reason: String| DriverError::Lost(format!("rosbridge at {address}: {reason}"));
        let mut socket = open_quiet_socket(address).map_err(lost)?;
        let request = json!({ "op": "subscribe", "topic": topic });
        send(&mut socket, &request).map_err(|error| lost(error.to_string()))?;
        Ok(Self {
            address: address.to_owned(),
            topic: topic.to_owned(),
            shape: message.shape,
            socket,
        })
    }

    fn lost(&self, reason: &str) -> DriverError {
        DriverError::Lost(format!(
            "{} of rosbridge at {}: {reason}",
            self.topic, self.address
        ))
    }
}

impl SignalTopic for RosbridgeSignal {
    fn readings(&mut self) -> Result<Vec<Reading>, DriverError> {
        let mut readings = Vec::new();
        loop {
            let message = read(&mut self.socket);
            let message = message.map_err(|error| self.lost(&end_in_words(&error)))?;
            let Some(message) = message else {
                return Ok(readings);
            };
            if message["op"] == "publish" && message["topic"] == *self.topic {
                let reading = reading(self.shape, &message["msg"]);
                readings.push(reading.ok_or_else(|| self.lost("a message of another type"))?);
            } else if let Some(said) = complaint(&message) {
                return Err(self.lost(said));
            }
        }
    }
}

/// The content of a message; `None` if it is of another type. `null` stands for numbers that are
/// not finite.
fn reading(shape: Shape, message: &Value) -> Option<Reading> {
    let number = |value: &Value| match value {
        Value::Null => Some(f64::NAN),
        value => value.as_f64(),
    };
    let data = message.get("data");
    Some(match shape {
        Shape::Flag => Reading::Flag(data?.as_bool()?),
        // Messages with one field of another name, such as the mode of a robot.
        Shape::Signed(_) | Shape::Unsigned(_) | Shape::Float(_) => {
            let only = || {
                message
                    .as_object()?
                    .values()
                    .find(|value| value.is_number())
            };
            Reading::Number(number(data.or_else(only)?)?)
        }
        Shape::Text => Reading::Text(data?.as_str()?.to_owned()),
        Shape::Wrench => {
            let vector = |name: &str| {
                let vector = message.get("wrench")?.get(name)?;
                let part = |axis: &str| number(vector.get(axis)?);
                Some(Vector3::new(part("x")?, part("y")?, part("z")?))
            };
            Reading::Wrench {
                force: vector("force")?,
                torque: vector("torque")?,
            }
        }
        Shape::Empty => Reading::Beat,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_by_their_layout() {
        let flag = reading(Shape::Flag, &json!({ "data": true }));
        assert_eq!(flag, Some(Reading::Flag(true)));
        assert_eq!(reading(Shape::Flag, &json!({ "data": 1 })), None);
        let mode = reading(Shape::Signed(1), &json!({ "mode": 7 }));
        assert_eq!(mode, Some(Reading::Number(7.0)));
        let unknown = reading(Shape::Float(8), &json!({ "data": null }));
        assert!(matches!(unknown, Some(Reading::Number(number)) if number.is_nan()));
        let vector = |z: f64| json!({ "x": 0.0, "y": -3.0, "z": z });
        let wrench =
            json!({ "header": {}, "wrench": { "force": vector(4.0), "torque": vector(0.0) } });
        let found = reading(Shape::Wrench, &wrench).unwrap();
        assert_eq!(found.to_string(), "5.00 N, 3.000 N m");
        assert_eq!(reading(Shape::Wrench, &json!({})), None);
        assert_eq!(reading(Shape::Empty, &json!({})), Some(Reading::Beat));
    }

    #[test]
    fn a_topic_is_read_until_the_server_ends() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let server = std::thread::spawn(move || {
            let (stream, _) = listener.accept().unwrap();
            let mut socket = tungstenite::accept(stream).unwrap();
            let request = socket.read().unwrap();
            let request: Value = serde_json::from_str(request.to_text().unwrap()).unwrap();
            assert_eq!(request, json!({ "op": "subscribe", "topic": "/stop" }));
            for (topic, flag) in [("/stop", false), ("/other", true), ("/stop", true)] {
                let message = json!({ "op": "publish", "topic": topic, "msg": { "data": flag } });
                socket
                    .send(tungstenite::Message::text(message.to_string()))
                    .unwrap();
            }
        });
        let bool = SignalMessage::named("std_msgs/Bool").unwrap();
        let mut signal = RosbridgeSignal::open(&address, "/stop", bool).unwrap();
        let mut readings = Vec::new();
        let lost = loop {
            match signal.readings() {
                Ok(new) => readings.extend(new),
                Err(error) => break error.to_string(),
            }
        };
        server.join().unwrap();
        // Messages that arrive together with the end of the connection may be lost with it.
        assert!(readings.len() <= 2, "{readings:?}");
        assert!(
            readings
                .iter()
                .zip([false, true])
                .all(|(r, flag)| *r == Reading::Flag(flag))
        );
        assert!(lost.contains("/stop of rosbridge at"), "{lost}");
    }
}
