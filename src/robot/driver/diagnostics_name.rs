//! Diagnostics by the names of their topics.

use super::diagnostics::DiagnosticTopic;
use super::{DriverError, TopicName, ros1};

/// Advertises diagnostics on a topic.
///
/// # Errors
/// The master does not answer, the topic is one of rosbridge, or this program was built without
/// ROS 2.
pub fn open_diagnostics(name: &TopicName) -> Result<Box<dyn DiagnosticTopic>, DriverError> {
    match name {
        TopicName::Ros1 { master, topic } => {
            Ok(Box::new(ros1::Ros1Diagnostics::open(master, topic)?))
        }
        TopicName::Ros2(address) => address.open_diagnostics(),
        TopicName::Rosbridge { .. } => Err(DriverError::Refused(
            "diagnostics are published at ros1:// or ros2:// topics only".into(),
        )),
    }
}
