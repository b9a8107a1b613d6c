//! A gripper of ROS 2: the action `control_msgs/GripperCommand`.

use super::super::follow_joint_trajectory::ros_2_outcome;
use super::super::{DriverError, GripperDriver};
use super::Ros2GripperAddress;
use super::client::{WITHOUT_REASON, unique};
use super::message::{
    CancelAnswer, CancelGoal, GetResult, GoalAnswer, GoalId, GripperGoal, GripperResult,
};
use super::service::Service;
use rustdds::{DomainParticipant, DomainParticipantBuilder};
use std::time::{Duration, Instant};

/// Longest wait for the action server.
const DISCOVERY_PATIENCE: Duration = Duration::from_secs(5);
/// Time between the discovery of the server and the first request: what has found the server may not be found by it.
const SETTLING: Duration = Duration::from_millis(500);
/// Longest wait for the answer to a goal, and to its cancellation.
const ANSWER_PATIENCE: Duration = Duration::from_secs(3);
const CANCEL_PATIENCE: Duration = Duration::from_millis(500);
/// Time between looks.
const LOOK: Duration = Duration::from_millis(5);
/// Status of a goal that the controller broke off.
const ABORTED: i8 = 6;

/// A gripper by its action.
pub struct Ros2Gripper {
    address: Ros2GripperAddress,
}

/// The services of its action.
struct Connection {
    send_goal: Service<GripperGoal, GoalAnswer>,
    get_result: Service<GetResult, GripperResult>,
    cancel_goal: Service<CancelGoal, CancelAnswer>,
    participant: DomainParticipant,
}

impl Connection {
    fn open(address: &Ros2GripperAddress) -> Result<Self, String> {
        let mut builder = DomainParticipantBuilder::new(address.domain);
        if let Some(interface) = address.interface {
            builder = builder.with_only_networks([interface]);
        }
        let participant = builder.build().map_err(|error| error.to_string())?;
        let middleware = address.middleware;
        let action = address.action.trim_matches('/');
        let kind = |what: &str| format!("control_msgs::action::dds_::GripperCommand_{what}");
        let part = |what: &str| format!("{action}/_action/{what}");
        let cancelling = "action_msgs::srv::dds_::CancelGoal";
        Ok(Self {
            send_goal: Service::new(
                &participant,
                middleware,
                &part("send_goal"),
                &kind("SendGoal"),
            )?,
            get_result: Service::new(
                &participant,
                middleware,
                &part("get_result"),
                &kind("GetResult"),
            )?,
            cancel_goal: Service::new(&participant, middleware, &part("cancel_goal"), cancelling)?,
            participant,
        })
    }

    fn is_served(&self) -> bool {
        self.send_goal.is_served(&self.participant)
            && self.get_result.is_served(&self.participant)
            && self.cancel_goal.is_served(&self.participant)
    }
}

impl Ros2Gripper {
    /// A driver for the gripper at an address.
    pub fn new(address: Ros2GripperAddress) -> Self {
        Self { address }
    }

    /// Opens the services and waits for the server.
    fn connect(&self, is_interrupted: &dyn Fn() -> bool) -> Result<Connection, DriverError> {
        let connection = Connection::open(&self.address).map_err(|reason| self.lost(reason))?;
        let begin = Instant::now();
        while !connection.is_served() {
            if is_interrupted() {
                return Err(interrupted());
            }
            if begin.elapsed() > DISCOVERY_PATIENCE {
                return Err(self.lost(format_args!(
                    "no action server of {} was found in {} s; is the gripper started, and is `domain` its ROS_DOMAIN_ID?",
                    self.address.action,
                    DISCOVERY_PATIENCE.as_secs()
                )));
            }
            std::thread::sleep(LOOK);
        }
        std::thread::sleep(SETTLING);
        Ok(connection)
    }

    /// Waits for the end of a goal.
    fn wait(
        &self,
        connection: &mut Connection,
        goal_id: GoalId,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let lost = |reason: String| self.lost(reason);
        let begin = Instant::now();
        let mut is_taken = false;
        while begin.elapsed() < patience {
            if is_interrupted() {
                return Err(interrupted());
            }
            if let Some(answer) = connection.send_goal.answer().map_err(lost)? {
                if !answer.accepted {
                    return ros_2_outcome(None, 0, WITHOUT_REASON);
                }
                is_taken = true;
                let asked = connection.get_result.ask(GetResult { goal_id });
                asked.map_err(lost)?;
            }
            if !is_taken && begin.elapsed() > ANSWER_PATIENCE {
                return Err(self.lost(format_args!(
                    "the goal of {} was not answered within {} s; does `middleware = \"{}\"` in the cell file fit the robot's RMW_IMPLEMENTATION?",
                    self.address.action,
                    ANSWER_PATIENCE.as_secs(),
                    self.address.middleware.name()
                )));
            }
            if let Some(result) = connection.get_result.answer().map_err(lost)? {
                // Fingers that hold something on the way have stalled; some controllers abort then.
                if result.status == ABORTED && result.stalled {
                    return Ok(());
                }
                return ros_2_outcome(Some(i64::from(result.status)), 0, "");
            }
            std::thread::sleep(LOOK);
        }
        Err(self.lost(format_args!(
            "the gripper {} has not moved within {} s",
            self.address.action,
            patience.as_secs_f64()
        )))
    }

    /// Cancels a goal; whether the server has confirmed it before the patience ends.
    fn cancel(connection: &mut Connection, goal_id: GoalId) -> Result<bool, String> {
        let begin = Instant::now();
        connection.cancel_goal.ask(CancelGoal::new(goal_id))?;
        while begin.elapsed() < CANCEL_PATIENCE {
            if let Some(answer) = connection.cancel_goal.answer()? {
                return Ok(answer.return_code == 0);
            }
            std::thread::sleep(LOOK);
        }
        Ok(false)
    }

    fn lost(&self, reason: impl std::fmt::Display) -> DriverError {
        DriverError::Lost(format!("ROS 2, domain {}: {reason}", self.address.domain))
    }
}

fn interrupted() -> DriverError {
    DriverError::Aborted("interrupted".into())
}

impl GripperDriver for Ros2Gripper {
    fn command(
        &self,
        opening: f64,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let mut connection = self.connect(is_interrupted)?;
        let goal_id = unique();
        let goal = GripperGoal::new(goal_id, opening, self.address.max_effort);
        let sent = connection.send_goal.ask(goal);
        sent.map_err(|reason| self.lost(reason))?;
        let ended = self.wait(&mut connection, goal_id, patience, is_interrupted);
        let Err(error) = ended else {
            return Ok(());
        };
        // Whatever ended it, the fingers must not move on.
        match Self::cancel(&mut connection, goal_id) {
            Ok(false) if error == interrupted() => {
                Err(self.lost("the cancellation was not confirmed: watch the gripper"))
            }
            Err(reason) => Err(self.lost(format_args!("{error}; {reason}"))),
            Ok(_) => Err(error),
        }
    }
}
