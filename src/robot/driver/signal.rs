//! Signals: topics whose messages end or forbid motions, such as an emergency stop, the mode of a
//! robot, a force sensor or a heartbeat.

use super::DriverError;
use nalgebra::Vector3;
use std::fmt;

/// Content of a message of a signal.
#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    /// `std_msgs/Bool`.
    Flag(bool),
    /// A number.
    Number(f64),
    /// `std_msgs/String`.
    Text(String),
    /// `geometry_msgs/WrenchStamped`: force, N, and torque, N m.
    Wrench {
        /// N.
        force: Vector3<f64>,
        /// N m.
        torque: Vector3<f64>,
    },
    /// `std_msgs/Empty`.
    Beat,
}

impl fmt::Display for Reading {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(to, "{flag}"),
            Self::Number(number) => write!(to, "{number}"),
            Self::Text(text) => write!(to, "{text:?}"),
            Self::Wrench { force, torque } => {
                let [force, torque] = [force, torque].map(Vector3::norm);
                write!(to, "{force:.2} N, {torque:.3} N m")
            }
            Self::Beat => to.write_str("a message"),
        }
    }
}

/// Layout of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One byte, zero or one.
    Flag,
    /// A signed integer of so many bytes.
    Signed(usize),
    /// An unsigned integer of so many bytes.
    Unsigned(usize),
    /// A number of four or eight bytes.
    Float(usize),
    /// A text.
    Text,
    /// A header, and six numbers of eight bytes.
    Wrench,
    /// Nothing.
    Empty,
}

/// Type of the messages of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignalMessage {
    /// Package and name, as in ROS 1.
    pub name: &'static str,
    /// Layout.
    pub shape: Shape,
}

/// All types that are read.
const MESSAGES: [SignalMessage; 16] = [
    of("std_msgs/Bool", Shape::Flag),
    of("std_msgs/Int8", Shape::Signed(1)),
    of("std_msgs/Int16", Shape::Signed(2)),
    of("std_msgs/Int32", Shape::Signed(4)),
    of("std_msgs/Int64", Shape::Signed(8)),
    of("std_msgs/UInt8", Shape::Unsigned(1)),
    of("std_msgs/UInt16", Shape::Unsigned(2)),
    of("std_msgs/UInt32", Shape::Unsigned(4)),
    of("std_msgs/UInt64", Shape::Unsigned(8)),
    of("std_msgs/Float32", Shape::Float(4)),
    of("std_msgs/Float64", Shape::Float(8)),
    of("std_msgs/String", Shape::Text),
    of("std_msgs/Empty", Shape::Empty),
    of("geometry_msgs/WrenchStamped", Shape::Wrench),
    // The modes of the robots of Universal Robots.
    of("ur_dashboard_msgs/RobotMode", Shape::Signed(1)),
    of("ur_dashboard_msgs/SafetyMode", Shape::Unsigned(1)),
];

const fn of(name: &'static str, shape: Shape) -> SignalMessage {
    SignalMessage { name, shape }
}

impl SignalMessage {
    /// The type with a name, in the form of ROS 1 or ROS 2 (`std_msgs/msg/Bool`).
    pub fn named(name: &str) -> Option<Self> {
        let name = name.replace("/msg/", "/");
        MESSAGES.into_iter().find(|message| message.name == name)
    }

    /// Names of all types.
    pub fn names() -> impl Iterator<Item = &'static str> {
        MESSAGES.iter().map(|message| message.name)
    }

    /// Name of the type in DDS.
    #[cfg(feature = "ros2")]
    pub(super) fn dds_name(self) -> String {
        let (package, name) = self.name.split_once('/').unwrap_or(("", self.name));
        format!("{package}::msg::dds_::{name}_")
    }
}

/// A subscription to a signal.
pub trait SignalTopic: Send {
    /// The messages that have arrived since the last call, oldest first. Returns at once.
    ///
    /// # Errors
    /// The connection is lost, or a message is damaged.
    fn readings(&mut self) -> Result<Vec<Reading>, DriverError>;
}
