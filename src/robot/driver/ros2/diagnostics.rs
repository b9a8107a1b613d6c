//! Diagnostics of ROS 2.

use super::super::DriverError;
use super::super::diagnostics::{DiagnosticStatus, DiagnosticTopic};
use super::Ros2Topic;
use super::action::participant;
use super::message::DiagnosticArray;
use super::service::{Encoded, Writer, publish};
use rustdds::DomainParticipant;
use std::time::Duration;

/// A topic of diagnostics.
pub struct Ros2Diagnostics {
    address: Ros2Topic,
    writer: Writer,
    _participant: DomainParticipant,
}

impl Ros2Diagnostics {
    /// Advertises a topic.
    ///
    /// # Errors
    /// A message: there is no such network, or no free participant index.
    pub fn open(address: &Ros2Topic) -> Result<Self, String> {
        let participant = participant(address.domain, address.interface)?;
        let topic = format!("rt/{}", address.topic.trim_matches('/'));
        let kind = "diagnostic_msgs::msg::dds_::DiagnosticArray_";
        Ok(Self {
            address: address.clone(),
            writer: publish(&participant, &topic, kind)?,
            _participant: participant,
        })
    }
}

impl DiagnosticTopic for Ros2Diagnostics {
    fn publish(
        &mut self,
        time: Duration,
        statuses: &[DiagnosticStatus],
    ) -> Result<(), DriverError> {
        let lost = |reason: String| {
            let Ros2Topic { topic, domain, .. } = &self.address;
            DriverError::Lost(format!("{topic} of ROS 2, domain {domain}: {reason}"))
        };
        let message = Encoded::of(&DiagnosticArray::new(time, statuses)).map_err(lost)?;
        let written = self.writer.write(message, None);
        written.map_err(|error| lost(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::diagnostics::DiagnosticLevel;
    use super::super::service::{Reader, reliable, subscribe};
    use super::*;
    use std::net::{IpAddr, Ipv4Addr};
    use std::time::Instant;

    #[test]
    fn a_reliable_subscriber_reads_the_statuses() {
        let process = std::process::id();
        let address = Ros2Topic {
            domain: (process % 100 + 1) as u16,
            interface: Some(IpAddr::V4(Ipv4Addr::LOCALHOST)),
            topic: format!("/diagnostics_{process}"),
        };
        let status = DiagnosticStatus {
            level: DiagnosticLevel::Warn,
            name: "rodlab: arm".into(),
            message: "held".into(),
            hardware: "arm".into(),
            values: vec![("lag in s", "0.1".into())],
        };
        let time = Duration::from_millis(1_700_000_000_250);
        let subscriber = participant(address.domain, address.interface).unwrap();
        let topic = format!("rt/{}", address.topic.trim_matches('/'));
        let kind = "diagnostic_msgs::msg::dds_::DiagnosticArray_";
        let mut reader: Reader<DiagnosticArray> =
            subscribe(&subscriber, &topic, kind, &reliable()).unwrap();
        let mut diagnostics = Ros2Diagnostics::open(&address).unwrap();
        let begin = Instant::now();
        let read = loop {
            // The subscriber may not be known yet.
            let _ = diagnostics.publish(time, std::slice::from_ref(&status));
            std::thread::sleep(Duration::from_millis(50));
            if let Some(read) = reader.next().unwrap() {
                break read;
            }
            assert!(begin.elapsed() < Duration::from_secs(30), "nothing arrives");
        };
        assert_eq!(read, DiagnosticArray::new(time, &[status]));
    }
}
