//! `control_msgs/FollowJointTrajectory` and `GripperCommand` of ROS 2, natively, without a ROS
//! installation or a bridge. DDS is that of rustdds.
//!
//! An action of ROS 2 (`action`) consists of three services, send_goal, get_result and cancel_goal
//! (`service`), and of topics for feedback and status. Their messages (`message`) are encoded in
//! CDR. Arms use `client` and grippers `gripper`; pictures come from a `camera`, and
//! what ends motions from a `signal`; `diagnostics` go to monitors. All of this needs the cargo feature `ros2`.

#[cfg(feature = "ros2")]
mod action;
#[cfg(feature = "ros2")]
mod camera;
#[cfg(feature = "ros2")]
mod client;
#[cfg(feature = "ros2")]
mod diagnostics;
#[cfg(feature = "ros2")]
mod gripper;
#[cfg(feature = "ros2")]
mod message;
#[cfg(feature = "ros2")]
mod service;
#[cfg(feature = "ros2")]
mod signal;

use super::diagnostics::DiagnosticTopic;
use super::picture::PictureTopic;
use super::signal::{SignalMessage, SignalTopic};
use super::{Driver, DriverError, GripperDriver};
use std::net::IpAddr;

/// Middleware of a robot that runs ROS 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Middleware {
    /// Fast DDS, the default of ROS 2.
    FastDds,
    /// Cyclone DDS.
    CycloneDds,
}

impl Middleware {
    /// Name in cell files.
    pub fn name(self) -> &'static str {
        match self {
            Self::FastDds => "fast-dds",
            Self::CycloneDds => "cyclone-dds",
        }
    }
}

/// Address of a robot of ROS 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ros2Address {
    /// `ROS_DOMAIN_ID` of the robot.
    pub domain: u16,
    /// Middleware of the robot.
    pub middleware: Middleware,
    /// Address of this machine on the robot's network; `None` means all networks.
    pub interface: Option<IpAddr>,
    /// Name of the action.
    pub action: String,
    /// Topic of the joint states.
    pub joint_states: String,
}

impl Ros2Address {
    /// Whether this program was built with the feature `ros2`.
    pub const IS_BUILT: bool = cfg!(feature = "ros2");

    /// A driver for the robot at this address; `None` unless [`Self::IS_BUILT`].
    pub fn driver(&self) -> Option<Box<dyn Driver>> {
        #[cfg(feature = "ros2")]
        {
            Some(Box::new(client::Ros2Driver::new(self.clone())))
        }
        #[cfg(not(feature = "ros2"))]
        {
            None
        }
    }
}

/// Address of a gripper of ROS 2, and its grip force.
#[derive(Clone, Debug, PartialEq)]
pub struct Ros2GripperAddress {
    /// `ROS_DOMAIN_ID` of the gripper.
    pub domain: u16,
    /// Middleware of the gripper.
    pub middleware: Middleware,
    /// Address of this machine on the gripper's network; `None` means all networks.
    pub interface: Option<IpAddr>,
    /// Name of the action `control_msgs/GripperCommand`.
    pub action: String,
    /// Greatest effort, N.
    pub max_effort: f64,
}

impl Ros2GripperAddress {
    /// A driver for the gripper at this address; `None` unless [`Ros2Address::IS_BUILT`].
    pub fn driver(self) -> Option<Box<dyn GripperDriver>> {
        #[cfg(feature = "ros2")]
        {
            Some(Box::new(gripper::Ros2Gripper::new(self)))
        }
        #[cfg(not(feature = "ros2"))]
        {
            None
        }
    }
}

/// A topic of ROS 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ros2Topic {
    /// `ROS_DOMAIN_ID` of its publisher.
    pub domain: u16,
    /// Address of this machine on its network; `None` means all networks.
    pub interface: Option<IpAddr>,
    /// Name of the topic.
    pub topic: String,
}

impl Ros2Topic {
    #[cfg(feature = "ros2")]
    fn lost(&self, reason: &str) -> DriverError {
        DriverError::Lost(format!("ROS 2, domain {}: {reason}", self.domain))
    }

    #[cfg(not(feature = "ros2"))]
    fn unsupported(&self) -> DriverError {
        let reason = "this program was built without the feature ros2";
        DriverError::Refused(format!("{}: {reason}", self.topic))
    }

    /// Subscribes to the pictures of the topic; the camera may start later.
    ///
    /// # Errors
    /// There is no such network, or the program was built without the feature `ros2`
    /// ([`Ros2Address::IS_BUILT`]).
    pub fn open_camera(&self) -> Result<Box<dyn PictureTopic>, DriverError> {
        #[cfg(feature = "ros2")]
        {
            let opened = camera::Ros2Camera::open(self);
            Ok(Box::new(opened.map_err(|reason| self.lost(&reason))?))
        }
        #[cfg(not(feature = "ros2"))]
        {
            Err(self.unsupported())
        }
    }

    /// Advertises diagnostics on the topic.
    ///
    /// # Errors
    /// As for [`Self::open_camera`].
    pub fn open_diagnostics(&self) -> Result<Box<dyn DiagnosticTopic>, DriverError> {
        #[cfg(feature = "ros2")]
        {
            let opened = diagnostics::Ros2Diagnostics::open(self);
            Ok(Box::new(opened.map_err(|reason| self.lost(&reason))?))
        }
        #[cfg(not(feature = "ros2"))]
        {
            Err(self.unsupported())
        }
    }

    /// Subscribes to the messages of the topic as a signal; the publisher may start later.
    ///
    /// # Errors
    /// As for [`Self::open_camera`].
    pub fn open_signal(&self, message: SignalMessage) -> Result<Box<dyn SignalTopic>, DriverError> {
        #[cfg(feature = "ros2")]
        {
            let opened = signal::Ros2Signal::open(self, message);
            Ok(Box::new(opened.map_err(|reason| self.lost(&reason))?))
        }
        #[cfg(not(feature = "ros2"))]
        {
            let reason = "this program was built without the feature ros2";
            Err(DriverError::Refused(format!(
                "{} ({}): {reason}",
                self.topic, message.name
            )))
        }
    }
}
