//! Diagnostics for the monitors of ROS: `diagnostic_msgs/DiagnosticArray`.

use super::DriverError;
use std::time::Duration;

/// Level of a status, with the numbers of `diagnostic_msgs/DiagnosticStatus`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DiagnosticLevel {
    /// All is well.
    #[default]
    Ok = 0,
    /// A person should look.
    Warn = 1,
    /// It has failed.
    Error = 2,
}

/// Status of one component.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DiagnosticStatus {
    /// Level.
    pub level: DiagnosticLevel,
    /// Name of the component, such as `rodlab: left`.
    pub name: String,
    /// The status in a few words.
    pub message: String,
    /// Name of the device.
    pub hardware: String,
    /// Further values by their names.
    pub values: Vec<(&'static str, String)>,
}

/// A topic of diagnostics.
pub trait DiagnosticTopic: Send {
    /// Publishes all statuses with a time since 1970. A slow subscriber may delay it by two seconds.
    ///
    /// # Errors
    /// The message could not be sent.
    fn publish(&mut self, time: Duration, statuses: &[DiagnosticStatus])
    -> Result<(), DriverError>;
}
