//! Signals of ROS 1.

use super::super::DriverError;
use super::super::signal::{Reading, Shape, SignalMessage, SignalTopic};
use super::message::{MessageType, Reader};
use super::node::{Heard, Node, master_uri, subscriber};
use nalgebra::Vector3;
use std::sync::mpsc::{Receiver, TryRecvError};

/// A topic of a signal.
pub struct Ros1Signal {
    master: String,
    topic: String,
    shape: Shape,
    heard: Receiver<Heard>,
    _node: Node,
}

impl Ros1Signal {
    /// Subscribes to a topic at a master such as `http://10.0.0.1:11311`.
    ///
    /// # Errors
    /// The master does not answer.
    pub fn open(master: &str, topic: &str, message: SignalMessage) -> Result<Self, DriverError> {
        let master = master_uri(master);
        // Publishers compare names, and accept any sum.
        let kind = MessageType {
            name: message.name,
            md5: "*",
        };
        let (node, sender, heard) = subscriber(&master, "signal", topic, kind)?;
        node.watch_master(&sender);
        Ok(Self {
            master,
            topic: topic.to_owned(),
            shape: message.shape,
            heard,
            _node: node,
        })
    }

    fn lost(&self, reason: &str) -> DriverError {
        DriverError::Lost(format!(
            "{} of the ROS master {}: {reason}",
            self.topic, self.master
        ))
    }
}

impl SignalTopic for Ros1Signal {
    fn readings(&mut self) -> Result<Vec<Reading>, DriverError> {
        let mut readings = Vec::new();
        loop {
            match self.heard.try_recv() {
                Ok(Heard::Message(_, bytes)) => {
                    let reading = reading(self.shape, &bytes);
                    readings.push(reading.ok_or_else(|| self.lost("a message is damaged"))?);
                }
                Ok(Heard::MasterIsGone) => return Err(self.lost("the master does not answer")),
                Err(TryRecvError::Empty) => return Ok(readings),
                Err(TryRecvError::Disconnected) => return Err(self.lost("the connection is lost")),
            }
        }
    }
}

/// The content of a message; `None` if it is too short.
fn reading(shape: Shape, bytes: &[u8]) -> Option<Reading> {
    let mut reader = Reader::new(bytes);
    let mut whole = |size: usize| -> Option<[u8; 8]> {
        let mut whole = [0; 8];
        whole[..size].copy_from_slice(reader.bytes(size)?);
        Some(whole)
    };
    Some(match shape {
        Shape::Flag => Reading::Flag(whole(1)?[0] != 0),
        Shape::Signed(size) => {
            // The sign is in the highest of the bytes that are sent.
            let unused = 64 - 8 * size as u32;
            Reading::Number(((i64::from_le_bytes(whole(size)?) << unused) >> unused) as f64)
        }
        Shape::Unsigned(size) => Reading::Number(u64::from_le_bytes(whole(size)?) as f64),
        Shape::Float(4) => {
            let [a, b, c, d, ..] = whole(4)?;
            Reading::Number(f64::from(f32::from_le_bytes([a, b, c, d])))
        }
        Shape::Float(_) => Reading::Number(f64::from_le_bytes(whole(8)?)),
        Shape::Text => Reading::Text(reader.text()?),
        Shape::Wrench => {
            reader.header()?;
            let mut vector = || Some(Vector3::new(reader.f64()?, reader.f64()?, reader.f64()?));
            Reading::Wrench {
                force: vector()?,
                torque: vector()?,
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
        let number = |shape, bytes: &[u8]| reading(shape, bytes);
        assert_eq!(number(Shape::Flag, &[1]), Some(Reading::Flag(true)));
        assert_eq!(
            number(Shape::Signed(1), &[0xff]),
            Some(Reading::Number(-1.0))
        );
        let minus = (-300_i32).to_le_bytes();
        assert_eq!(
            number(Shape::Signed(4), &minus),
            Some(Reading::Number(-300.0))
        );
        assert_eq!(
            number(Shape::Unsigned(1), &[0xff]),
            Some(Reading::Number(255.0))
        );
        let half = 0.5_f32.to_le_bytes();
        assert_eq!(number(Shape::Float(4), &half), Some(Reading::Number(0.5)));
        assert_eq!(number(Shape::Float(8), &half), None);
        let text = [3, 0, 0, 0, b'r', b'u', b'n'];
        assert_eq!(
            number(Shape::Text, &text),
            Some(Reading::Text("run".into()))
        );
        // Sequence number, time and the name of the frame before the numbers.
        let mut wrench = vec![0; 12];
        wrench.extend([1, 0, 0, 0, b't']);
        wrench.extend(
            [3.0_f64, 4.0, 0.0, 0.0, 0.0, 2.0]
                .map(f64::to_le_bytes)
                .concat(),
        );
        let found = number(Shape::Wrench, &wrench).unwrap();
        assert_eq!(found.to_string(), "5.00 N, 2.000 N m");
        assert_eq!(number(Shape::Wrench, &wrench[1..]), None);
        assert_eq!(number(Shape::Empty, &[]), Some(Reading::Beat));
    }
}
