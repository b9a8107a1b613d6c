//! Signals by the names of their topics.

use super::rosbridge_signal::RosbridgeSignal;
use super::signal::{SignalMessage, SignalTopic};
use super::{DriverError, TopicName, ros1};

/// Subscribes to a signal.
///
/// # Errors
/// The master or the server does not answer, or this program was built without ROS 2.
pub fn open_signal(
    name: &TopicName,
    message: SignalMessage,
) -> Result<Box<dyn SignalTopic>, DriverError> {
    Ok(match name {
        TopicName::Ros1 { master, topic } => {
            Box::new(ros1::Ros1Signal::open(master, topic, message)?)
        }
        TopicName::Rosbridge { server, topic } => {
            Box::new(RosbridgeSignal::open(server, topic, message)?)
        }
        TopicName::Ros2(address) => address.open_signal(message)?,
    })
}
