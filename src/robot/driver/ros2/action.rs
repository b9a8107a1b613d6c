//! An action of ROS 2: three services, and the discovery of its server.

use super::super::DriverError;
use super::super::gripper_goal::wait_for_server;
use super::Middleware;
use super::message::{CancelAnswer, CancelGoal, GetResult, GoalAnswer, GoalId};
use super::service::Service;
use rustdds::{DomainParticipant, DomainParticipantBuilder};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::hash::{BuildHasher, RandomState};
use std::net::IpAddr;
use std::time::{Duration, Instant};

/// Longest wait for the action server.
const DISCOVERY_PATIENCE: Duration = Duration::from_secs(5);
/// Time between the discovery of the server and the first request, since the server may discover
/// this client later.
const SETTLING: Duration = Duration::from_millis(500);

/// Message for a rejected goal, since the answer has no field for a reason.
pub const WITHOUT_REASON: &str =
    "no reason given: compare the names of the joints and the goal with the log of the controller";

/// A unique name for a goal.
pub fn unique() -> GoalId {
    let mut id = [0; 16];
    for half in id.chunks_exact_mut(8) {
        half.copy_from_slice(&RandomState::new().hash_one(Instant::now()).to_ne_bytes());
    }
    id
}

/// A participant of a domain. If the address of this machine on a network is given, only this
/// network is used.
///
/// # Errors
/// A message: there is no such network, or no free participant index.
pub fn participant(domain: u16, interface: Option<IpAddr>) -> Result<DomainParticipant, String> {
    let mut builder = DomainParticipantBuilder::new(domain);
    if let Some(interface) = interface {
        builder = builder.with_only_networks([interface]);
    }
    builder.build().map_err(|error| error.to_string())
}

/// The services of an action with goals `Goal`and results `End`.
pub struct Action<Goal, End> {
    /// Accepts goals.
    pub send_goal: Service<Goal, GoalAnswer>,
    /// Answers once a goal has ended.
    pub get_result: Service<GetResult, End>,
    /// Accepts cancellations.
    pub cancel_goal: Service<CancelGoal, CancelAnswer>,
}

impl<Goal: Serialize, End: DeserializeOwned> Action<Goal, End> {
    /// A client of the action `name`, without a leading slash, of a kind of `control_msgs`.
    ///
    /// # Errors
    /// A message about the failure.
    pub fn new(
        participant: &DomainParticipant,
        middleware: Middleware,
        name: &str,
        kind: &str,
    ) -> Result<Self, String> {
        let kind = |what: &str| format!("control_msgs::action::dds_::{kind}_{what}");
        let part = |what: &str| format!("{name}/_action/{what}");
        let cancelling = "action_msgs::srv::dds_::CancelGoal";
        Ok(Self {
            send_goal: Service::new(
                participant,
                middleware,
                &part("send_goal"),
                &kind("SendGoal"),
            )?,
            get_result: Service::new(
                participant,
                middleware,
                &part("get_result"),
                &kind("GetResult"),
            )?,
            cancel_goal: Service::new(participant, middleware, &part("cancel_goal"), cancelling)?,
        })
    }

    /// Waits until all services are available; `false` if they are not within
    /// [`DISCOVERY_PATIENCE`].
    ///
    /// # Errors
    /// The user interrupted the wait.
    pub fn meet(
        &self,
        participant: &DomainParticipant,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<bool, DriverError> {
        let is_served = || {
            self.send_goal.is_served(participant)
                && self.get_result.is_served(participant)
                && self.cancel_goal.is_served(participant)
        };
        let is_met = wait_for_server(DISCOVERY_PATIENCE, is_interrupted, &is_served)?;
        if is_met {
            std::thread::sleep(SETTLING);
        }
        Ok(is_met)
    }
}

/// The error that no server of an action was found; `what` names the program to start.
pub fn absence(action: &str, what: &str) -> String {
    format!(
        "no action server of {action} was found in {} s; is the {what} started, and is `domain` its ROS_DOMAIN_ID?",
        DISCOVERY_PATIENCE.as_secs()
    )
}
