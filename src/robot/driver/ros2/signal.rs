//! Signals of ROS 2.

use super::super::DriverError;
use super::super::signal::{Reading, Shape, SignalMessage, SignalTopic};
use super::Ros2Topic;
use super::action::participant;
use super::message::{NoContent, WrenchStamped};
use super::service::{Reader, best_effort, latched, reliable, subscribe};
use rustdds::DomainParticipant;
use serde::de::DeserializeOwned;

/// Reads the next message of a subscription, if one has arrived.
type Next = Box<dyn FnMut() -> Result<Option<Reading>, String> + Send>;

/// A topic of a signal.
pub struct Ros2Signal {
    address: Ros2Topic,
    readers: Vec<Next>,
    _participant: DomainParticipant,
}

impl Ros2Signal {
    /// Subscribes to a topic.
    ///
    /// # Errors
    /// A message: there is no such network, or no free participant index.
    pub fn open(address: &Ros2Topic, message: SignalMessage) -> Result<Self, String> {
        let participant = participant(address.domain, address.interface)?;
        let place = Place {
            participant: &participant,
            topic: format!("rt/{}", address.topic.trim_matches('/')),
            kind: message.dds_name(),
        };
        let readers = match message.shape {
            Shape::Flag => place.readers(Reading::Flag),
            Shape::Signed(1) => place.readers(number::<i8>),
            Shape::Signed(2) => place.readers(number::<i16>),
            Shape::Signed(4) => place.readers(number::<i32>),
            Shape::Signed(_) => place.readers(|number: i64| Reading::Number(number as f64)),
            Shape::Unsigned(1) => place.readers(number::<u8>),
            Shape::Unsigned(2) => place.readers(number::<u16>),
            Shape::Unsigned(4) => place.readers(number::<u32>),
            Shape::Unsigned(_) => place.readers(|number: u64| Reading::Number(number as f64)),
            Shape::Float(4) => place.readers(number::<f32>),
            Shape::Float(_) => place.readers(number::<f64>),
            Shape::Text => place.readers(Reading::Text),
            Shape::Wrench => place.readers(|wrench: WrenchStamped| Reading::Wrench {
                force: wrench.force.into(),
                torque: wrench.torque.into(),
            }),
            Shape::Empty => place.readers(|_: NoContent| Reading::Beat),
        }?;
        Ok(Self {
            address: address.clone(),
            readers,
            _participant: participant,
        })
    }
}

fn number<Number: Into<f64>>(number: Number) -> Reading {
    Reading::Number(number.into())
}

/// A topic of DDS.
struct Place<'a> {
    participant: &'a DomainParticipant,
    topic: String,
    kind: String,
}

impl Place<'_> {
    /// Subscriptions for publishers that repeat their last message to later subscribers, for
    /// other reliable ones, and for best-effort ones. A message may arrive twice.
    fn readers<T: DeserializeOwned + 'static>(
        &self,
        content: fn(T) -> Reading,
    ) -> Result<Vec<Next>, String> {
        let qualities = [latched(), reliable(), best_effort()];
        let readers = qualities.iter().map(|quality| {
            let mut reader: Reader<T> =
                subscribe(self.participant, &self.topic, &self.kind, quality)?;
            let next: Next = Box::new(move || Ok(reader.next()?.map(content)));
            Ok(next)
        });
        readers.collect()
    }
}

impl SignalTopic for Ros2Signal {
    fn readings(&mut self) -> Result<Vec<Reading>, DriverError> {
        let mut readings = Vec::new();
        for next in &mut self.readers {
            loop {
                let reading = next().map_err(|reason| {
                    DriverError::Lost(format!(
                        "{} of ROS 2, domain {}: {reason}",
                        self.address.topic, self.address.domain
                    ))
                })?;
                match reading {
                    Some(reading) => readings.push(reading),
                    None => break,
                }
            }
        }
        Ok(readings)
    }
}

#[cfg(test)]
mod tests {
    use super::super::service::{Encoded, publish};
    use super::*;
    use std::net::{IpAddr, Ipv4Addr};
    use std::time::{Duration, Instant};

    /// What a subscription reads when a message is published repeatedly.
    fn read(name: &str, message: &impl serde::Serialize) -> Reading {
        let loopback = IpAddr::V4(Ipv4Addr::LOCALHOST);
        let process = std::process::id();
        let signal = SignalMessage::named(name).unwrap();
        let address = Ros2Topic {
            domain: (process % 100 + 1) as u16,
            interface: Some(loopback),
            topic: format!("/signal_{process}/{}", name.replace('/', "_")),
        };
        let publisher = participant(address.domain, address.interface).unwrap();
        let writer = publish(
            &publisher,
            &format!("rt/{}", address.topic.trim_matches('/')),
            &signal.dds_name(),
        );
        let (writer, message) = (writer.unwrap(), Encoded::of(message).unwrap());
        let mut subscription = Ros2Signal::open(&address, signal).unwrap();
        let begin = Instant::now();
        loop {
            // There may be no subscriber yet.
            let _ = writer.write(message.clone(), None);
            std::thread::sleep(Duration::from_millis(50));
            if let Some(last) = subscription.readings().unwrap().pop() {
                return last;
            }
            assert!(begin.elapsed() < Duration::from_secs(30), "no {name}");
        }
    }

    #[test]
    fn messages_are_read_by_their_type() {
        assert_eq!(read("std_msgs/msg/Bool", &true), Reading::Flag(true));
        let mode = read("ur_dashboard_msgs/RobotMode", &-1_i8);
        assert_eq!(mode, Reading::Number(-1.0));
        let wrench = WrenchStamped {
            force: [0.0, 3.0, -4.0],
            torque: [0.5, 0.0, 0.0],
            ..WrenchStamped::default()
        };
        let found = read("geometry_msgs/WrenchStamped", &wrench);
        assert_eq!(found.to_string(), "5.00 N, 0.500 N m");
        assert_eq!(read("std_msgs/Empty", &NoContent::default()), Reading::Beat);
    }
}
