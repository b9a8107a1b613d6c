//! Diagnostics of ROS 1.

use super::super::DriverError;
use super::super::diagnostics::{DiagnosticStatus, DiagnosticTopic};
use super::message::{self, DIAGNOSTICS};
use super::node::{Node, Publication, master_uri, publisher};
use std::sync::Arc;
use std::time::Duration;

/// A topic of diagnostics.
pub struct Ros1Diagnostics {
    topic: Arc<Publication>,
    _node: Node,
}

impl Ros1Diagnostics {
    /// Advertises a topic at a master such as `http://10.0.0.1:11311`.
    ///
    /// # Errors
    /// The master does not answer.
    pub fn open(master: &str, topic: &str) -> Result<Self, DriverError> {
        let (node, topic) = publisher(&master_uri(master), topic, DIAGNOSTICS)?;
        Ok(Self { topic, _node: node })
    }
}

impl DiagnosticTopic for Ros1Diagnostics {
    /// Without a subscriber nothing is sent.
    fn publish(
        &mut self,
        time: Duration,
        statuses: &[DiagnosticStatus],
    ) -> Result<(), DriverError> {
        self.topic.publish(&message::diagnostics(time, statuses));
        Ok(())
    }
}
