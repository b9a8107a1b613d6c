//! The client of an action server of ROS 2.

use super::super::action_driver::{ActionDriver, ActionLink, News};
use super::super::follow_joint_trajectory::ros_2_outcome;
use super::super::{DriverError, Interpolant, read_within_bounds};
use super::Ros2Address;
use super::action::{Action, WITHOUT_REASON, absence, participant, unique};
use super::message::{
    CancelGoal, Feedback, GetResult, GoalId, JointStates, ResultAnswer, SendGoal,
};
use super::service::{Reader, best_effort, reliable, subscribe};
use rustdds::DomainParticipant;

/// A driver for an action server of ROS 2.
pub type Ros2Driver = ActionDriver<Ros2Link>;

impl Ros2Driver {
    /// A driver for the robot at an address.
    pub fn new(address: Ros2Address) -> Self {
        Self::over(Ros2Link {
            address,
            connection: None,
        })
    }
}

/// A connection to an action server of ROS 2.
pub struct Ros2Link {
    address: Ros2Address,
    connection: Option<Connection>,
}

struct Connection {
    action: Action<SendGoal, ResultAnswer>,
    feedback: Reader<Feedback>,
    joint_states: Reader<JointStates>,
    participant: DomainParticipant,
    /// The goal whose result was requested last.
    asked: Option<GoalId>,
}

impl Connection {
    fn open(address: &Ros2Address) -> Result<Self, String> {
        let participant = participant(address.domain, address.interface)?;
        let (name, kind) = (address.action.trim_matches('/'), "FollowJointTrajectory");
        Ok(Self {
            action: Action::new(&participant, address.middleware, name, kind)?,
            feedback: subscribe(
                &participant,
                &format!("rt/{name}/_action/feedback"),
                &format!("control_msgs::action::dds_::{kind}_FeedbackMessage_"),
                &reliable(),
            )?,
            joint_states: subscribe(
                &participant,
                &format!("rt/{}", address.joint_states.trim_matches('/')),
                "sensor_msgs::msg::dds_::JointState_",
                &best_effort(),
            )?,
            participant,
            asked: None,
        })
    }

    /// Reads one report of the joints, or one feedback of the goal; `false` if none has arrived.
    fn read_sample(&mut self, news: &mut News<GoalId>) -> Result<bool, String> {
        if let Some(states) = self.joint_states.next()? {
            let position = |index: usize| states.position.get(index).copied();
            let effort = |index: usize| states.effort.get(index).copied();
            news.add_state(&states.name, position, effort, None);
            return Ok(true);
        }
        let Some(feedback) = self.feedback.next()? else {
            return Ok(false);
        };
        if let Some(goal) = &mut news.goal
            && feedback.goal_id == *goal.id()
        {
            goal.acknowledge();
            let position = |index: usize| feedback.setpoint.get(index).copied();
            news.add_setpoint(&feedback.joints, position);
        }
        Ok(true)
    }

    fn hear(&mut self, news: &mut News<GoalId>) -> Result<(), String> {
        read_within_bounds(|| self.read_sample(news))?;
        let action = &mut self.action;
        let answered = action.send_goal.answer()?;
        let cancelled = action.cancel_goal.answer()?;
        let ended = action.get_result.answer()?;
        let Some(goal) = &mut news.goal else {
            return Ok(());
        };
        let goal_id = *goal.id();
        // The end of a replaced goal is ignored.
        let ended = ended.filter(|_| self.asked == Some(goal_id));
        if let Some(answer) = answered {
            if answer.accepted {
                goal.acknowledge();
                action.get_result.ask(GetResult { goal_id })?;
                self.asked = Some(goal_id);
            } else {
                goal.end(ros_2_outcome(None, 0, WITHOUT_REASON));
            }
        }
        if let Some(result) = ended {
            let (status, code) = (result.status.into(), result.error_code.into());
            goal.end(ros_2_outcome(Some(status), code, &result.error_string));
        } else if cancelled.is_some_and(|answer| answer.return_code != 0) {
            // The server has not received the goal yet, or does not cancel it. The request is
            // repeated until the wait ends.
            action.cancel_goal.ask(CancelGoal::new(goal_id))?;
        }
        Ok(())
    }
}

impl Ros2Link {
    /// Runs a function on the connection.
    fn with<T>(
        &mut self,
        work: impl FnOnce(&mut Connection) -> Result<T, String>,
    ) -> Result<T, DriverError> {
        let result = match &mut self.connection {
            Some(connection) => work(connection),
            None => Err("not connected".to_owned()),
        };
        result.map_err(|reason| self.lost(&reason))
    }
}

impl ActionLink for Ros2Link {
    type Id = GoalId;

    fn unique() -> GoalId {
        unique()
    }

    fn action(&self) -> &str {
        &self.address.action
    }

    fn lost(&self, reason: &dyn std::fmt::Display) -> DriverError {
        DriverError::Lost(format!("ROS 2, domain {}: {reason}", self.address.domain))
    }

    fn advice(&self) -> String {
        format!(
            "is its controller started, and does `middleware = \"{}\"` in the cell file fit the robot's RMW_IMPLEMENTATION?",
            self.address.middleware.name()
        )
    }

    fn open(&mut self) -> Result<(), DriverError> {
        let connection = Connection::open(&self.address).map_err(|reason| self.lost(&reason))?;
        if !connection.action.meet(&connection.participant, &|| false)? {
            return Err(self.lost(&absence(&self.address.action, "controller")));
        }
        self.connection = Some(connection);
        Ok(())
    }

    fn listen(&mut self, news: &mut News<GoalId>) -> Result<(), DriverError> {
        self.with(|connection| connection.hear(news))
    }

    fn send_goal(
        &mut self,
        joints: &[String],
        motion: &Interpolant,
        id: &GoalId,
    ) -> Result<(), DriverError> {
        let goal = SendGoal::new(*id, joints, motion);
        self.with(|connection| connection.action.send_goal.ask(goal))
    }

    /// Only the answer to the last request is used.
    fn cancel(&mut self, id: &GoalId) -> Result<(), DriverError> {
        self.with(|connection| connection.action.cancel_goal.ask(CancelGoal::new(*id)))
    }
}
