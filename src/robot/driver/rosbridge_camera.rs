//! Pictures of a camera of ROS 1 or ROS 2 through a rosbridge server: JSON over a WebSocket, bytes in base64.

use super::DriverError;
use super::picture::{CameraPicture, LARGEST_PICTURE, PictureTopic, RawImage, pixels};
use super::rosbridge_socket::{complaint, end_in_words, open_socket, read, send};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::WebSocket;

/// Largest message, bytes; base64 needs four bytes for three.
const LARGEST_MESSAGE: usize = LARGEST_PICTURE / 3 * 4 + (1 << 16);

/// A topic of pictures behind a rosbridge server. The messages of a topic show whether it sends
/// pixels or files.
pub struct RosbridgeCamera {
    address: String,
    topic: String,
    socket: WebSocket<TcpStream>,
}

impl RosbridgeCamera {
    /// Subscribes to a topic of the server at `host:port`. The server determines the type of the
    /// topic, of ROS 1 or ROS 2.
    ///
    /// # Errors
    /// There is no server.
    pub fn open(address: &str, topic: &str) -> Result<Self, DriverError> {
        let lost = |reason: String| DriverError::Lost(format!("rosbridge at {address}: {reason}"));
        let mut socket = open_socket(address, LARGEST_MESSAGE).map_err(lost)?;
        // The server keeps only the newest unread picture.
        let request = json!({ "op": "subscribe", "topic": topic, "queue_length": 1 });
        send(&mut socket, &request).map_err(|error| lost(error.to_string()))?;
        Ok(Self {
            address: address.to_owned(),
            topic: topic.to_owned(),
            socket,
        })
    }

    fn lost(&self, reason: impl std::fmt::Display) -> DriverError {
        DriverError::Lost(format!("rosbridge at {}: {reason}", self.address))
    }

    /// The next message of the topic; returns at once if `patience` is zero.
    fn next(&mut self, patience: Duration) -> Result<Option<Value>, DriverError> {
        let end = Instant::now() + patience;
        loop {
            let rest = end.saturating_duration_since(Instant::now());
            let stream = self.socket.get_ref();
            let prepared = match rest.is_zero() {
                true => stream.set_nonblocking(true),
                false => stream
                    .set_nonblocking(false)
                    .and_then(|()| stream.set_read_timeout(Some(rest))),
            };
            prepared.map_err(|error| self.lost(error))?;
            let message = match read(&mut self.socket) {
                Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::TimedOut => None,
                Err(tungstenite::Error::Capacity(_)) => {
                    return Err(DriverError::Aborted(format!(
                        "{}: a message has more than {LARGEST_MESSAGE} bytes",
                        self.topic
                    )));
                }
                read => read.map_err(|error| self.lost(end_in_words(&error)))?,
            };
            let Some(message) = message else {
                if rest.is_zero() || Instant::now() >= end {
                    return Ok(None);
                }
                continue;
            };
            if message["op"] == "publish" && message["topic"] == *self.topic {
                return Ok(Some(message));
            }
            if let Some(said) = complaint(&message) {
                return Err(DriverError::Refused(format!(
                    "rosbridge at {}: {said}",
                    self.address
                )));
            }
        }
    }
}

impl PictureTopic for RosbridgeCamera {
    fn picture(&mut self, patience: Duration) -> Result<CameraPicture, DriverError> {
        let mut newest = None;
        while let Some(message) = self.next(Duration::ZERO)? {
            newest = Some(message);
        }
        let newest = match newest {
            Some(newest) => Some(newest),
            None => self.next(patience)?,
        };
        let newest = newest.ok_or_else(|| {
            self.lost(format_args!(
                "no picture on {} in {} s; is the camera started, and is this its topic?",
                self.topic,
                patience.as_secs_f64()
            ))
        })?;
        picture(&newest["msg"])
            .map_err(|reason| DriverError::Aborted(format!("{}: {reason}", self.topic)))
    }
}

/// The picture in a message: `sensor_msgs/Image` names its encoding, `sensor_msgs/CompressedImage` does not.
fn picture(message: &Value) -> Result<CameraPicture, String> {
    let damaged = || "the picture is damaged".to_owned();
    let data = message["data"].as_str().ok_or_else(damaged)?;
    let data = STANDARD.decode(data).map_err(|_| damaged())?;
    let Some(encoding) = message["encoding"].as_str() else {
        return Ok(CameraPicture::File(data));
    };
    let number = |name: &str| {
        let number = message[name].as_u64().ok_or_else(damaged)?;
        u32::try_from(number).map_err(|_| damaged())
    };
    let raw = RawImage {
        size: [number("width")?, number("height")?],
        encoding: encoding.to_owned(),
        is_big_endian: number("is_bigendian").unwrap_or(0) != 0,
        step: number("step")? as usize,
        data: &data,
    };
    pixels(&raw).map(CameraPicture::Pixels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;
    use tungstenite::Message;

    /// A server that answers the first subscription with some messages and is silent afterwards.
    fn serve(messages: Vec<Value>) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        std::thread::spawn(move || {
            let (stream, _) = listener.accept().unwrap();
            let mut socket = tungstenite::accept(stream).unwrap();
            let request: Value =
                serde_json::from_str(socket.read().unwrap().to_text().unwrap()).unwrap();
            assert_eq!(
                (request["op"].as_str(), request["queue_length"].as_u64()),
                (Some("subscribe"), Some(1))
            );
            for message in messages {
                socket.send(Message::text(message.to_string())).unwrap();
            }
            // Read until the client disconnects.
            while socket.read().is_ok() {}
        });
        address
    }

    fn published(message: Value) -> Value {
        json!({ "op": "publish", "topic": "/camera", "msg": message })
    }

    fn raw(data: &[u8]) -> Value {
        published(json!({
            "header": { "frame_id": "camera" },
            "height": 1, "width": 2, "encoding": "bgr8", "is_bigendian": 0, "step": 6,
            "data": STANDARD.encode(data),
        }))
    }

    const PATIENCE: Duration = Duration::from_secs(5);

    #[test]
    fn pixels_and_files_come_through() {
        let file = published(json!({ "format": "png", "data": STANDARD.encode([1, 2, 3]) }));
        let other = json!({ "op": "publish", "topic": "/tf", "msg": {} });
        let address = serve(vec![other, raw(&[1, 2, 3, 4, 5, 6])]);
        let mut camera = RosbridgeCamera::open(&address, "/camera").unwrap();
        let CameraPicture::Pixels(pixels) = camera.picture(PATIENCE).unwrap() else {
            panic!("it sends pixels");
        };
        assert_eq!(pixels.as_raw()[..], [3, 2, 1, 6, 5, 4]);

        let mut camera = RosbridgeCamera::open(&serve(vec![file]), "/camera").unwrap();
        let found = camera.picture(PATIENCE).unwrap();
        assert_eq!(found, CameraPicture::File(vec![1, 2, 3]));
    }

    #[test]
    fn faults_are_named() {
        let fault = |messages: Vec<Value>| {
            let mut camera = RosbridgeCamera::open(&serve(messages), "/camera").unwrap();
            let error = camera.picture(Duration::from_millis(300)).unwrap_err();
            error.to_string()
        };
        let unknown = "Cannot infer topic type for topic /camera as it is not yet advertised";
        let refused = json!({ "op": "status", "level": "error", "msg": unknown });
        assert!(fault(vec![refused]).contains(unknown));
        assert!(fault(Vec::new()).contains("is the camera started"));
        assert!(fault(vec![raw(&[1, 2, 3])]).contains("do not fit"));
        let nonsense = published(json!({ "data": "ä", "format": "png" }));
        assert!(fault(vec![nonsense]).contains("damaged"));
        let absent = RosbridgeCamera::open("127.0.0.1:1", "/camera")
            .err()
            .unwrap();
        assert!(
            absent.to_string().contains("is the server started"),
            "{absent}"
        );
    }

    #[test]
    fn messages_are_bounded() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        std::thread::spawn(move || {
            use std::io::Write;
            let (stream, _) = listener.accept().unwrap();
            let mut socket = tungstenite::accept(stream).unwrap();
            // A text message with a stated length of 2⁴⁰ bytes.
            let header = [0x81, 127, 0, 0, 1, 0, 0, 0, 0, 0];
            socket.get_mut().write_all(&header).unwrap();
            while socket.read().is_ok() {}
        });
        let mut camera = RosbridgeCamera::open(&address, "/camera").unwrap();
        let error = camera.picture(PATIENCE).unwrap_err().to_string();
        assert!(error.contains("more than"), "{error}");
    }
}
