//! The client of an action server of ROS 2.

use super::super::action_client::{ActionClient, Goal};
use super::super::follow_joint_trajectory::ros_2_outcome;
use super::super::{Driver, DriverError, Interpolant, JointState, Progress, read_within_bounds};
use super::Ros2Address;
use super::message::{
    CancelAnswer, CancelGoal, Feedback, GetResult, GoalAnswer, GoalId, JointStates, ResultAnswer,
    SendGoal,
};
use super::service::{Service, best_effort, reliable, subscribe};
use rustdds::no_key::DataReader;
use rustdds::{CDRDeserializerAdapter, DomainParticipant, DomainParticipantBuilder};
use serde::de::DeserializeOwned;
use std::hash::{BuildHasher, RandomState};
use std::time::{Duration, Instant};

/// Longest wait for the action server.
const DISCOVERY_PATIENCE: Duration = Duration::from_secs(5);
/// Time between the discovery of the server and the first request: what has found the server may not be found by it.
const SETTLING: Duration = Duration::from_millis(500);

/// A driver for an action server of ROS 2.
pub struct Ros2Driver {
    address: Ros2Address,
    joints: Vec<String>,
    connection: Option<Connection>,
    state: Option<JointState>,
    setpoint: Option<JointState>,
    goal: Option<(GoalId, Goal)>,
    /// The goal that the last one replaced.
    former: Option<GoalId>,
    /// The goal whose result was asked for last.
    asked: Option<GoalId>,
}

struct Connection {
    send_goal: Service<SendGoal, GoalAnswer>,
    get_result: Service<GetResult, ResultAnswer>,
    cancel_goal: Service<CancelGoal, CancelAnswer>,
    feedback: Reader<Feedback>,
    joint_states: Reader<JointStates>,
    participant: DomainParticipant,
}

impl Connection {
    fn is_served(&self) -> bool {
        self.send_goal.is_served(&self.participant)
            && self.get_result.is_served(&self.participant)
            && self.cancel_goal.is_served(&self.participant)
    }
}

type Reader<T> = DataReader<T, CDRDeserializerAdapter<T>>;

impl Ros2Driver {
    /// A driver for the robot at an address.
    pub fn new(address: Ros2Address) -> Self {
        Self {
            address,
            joints: Vec::new(),
            connection: None,
            state: None,
            setpoint: None,
            goal: None,
            former: None,
            asked: None,
        }
    }

    fn open(&self) -> Result<Connection, String> {
        let Ros2Address {
            domain,
            middleware,
            interface,
            action,
            joint_states,
        } = &self.address;
        let mut builder = DomainParticipantBuilder::new(*domain);
        if let Some(interface) = interface {
            builder = builder.with_only_networks([*interface]);
        }
        let participant = builder.build().map_err(|error| error.to_string())?;
        let action = action.trim_matches('/');
        let kind = |what: &str| format!("control_msgs::action::dds_::FollowJointTrajectory_{what}");
        let part = |what: &str| format!("{action}/_action/{what}");
        Ok(Connection {
            send_goal: Service::new(
                &participant,
                *middleware,
                &part("send_goal"),
                &kind("SendGoal"),
            )?,
            get_result: Service::new(
                &participant,
                *middleware,
                &part("get_result"),
                &kind("GetResult"),
            )?,
            cancel_goal: Service::new(
                &participant,
                *middleware,
                &part("cancel_goal"),
                "action_msgs::srv::dds_::CancelGoal",
            )?,
            feedback: subscribe(
                &participant,
                &format!("rt/{}", part("feedback")),
                &kind("FeedbackMessage_"),
                &reliable(),
            )?,
            joint_states: subscribe(
                &participant,
                &format!("rt/{}", joint_states.trim_matches('/')),
                "sensor_msgs::msg::dds_::JointState_",
                &best_effort(),
            )?,
            participant,
        })
    }

    /// Reads one report of the joints, or one feedback of the goal; `false` where none has arrived.
    fn read_sample(&mut self, connection: &mut Connection) -> Result<bool, String> {
        if let Some(states) = next(&mut connection.joint_states)? {
            let position = |index: usize| states.position.get(index).copied();
            let heard = JointState::heard(&self.joints, &states.name, position);
            self.state = heard.or(self.state.take());
            return Ok(true);
        }
        let Some(feedback) = next(&mut connection.feedback)? else {
            return Ok(false);
        };
        if let Some((goal_id, goal)) = &mut self.goal
            && feedback.goal_id == *goal_id
        {
            goal.acknowledge();
            let position = |index: usize| feedback.setpoint.get(index).copied();
            let heard = JointState::heard(&self.joints, &feedback.joints, position);
            self.setpoint = heard.or(self.setpoint.take());
        }
        Ok(true)
    }

    fn hear(&mut self, connection: &mut Connection) -> Result<(), String> {
        read_within_bounds(|| self.read_sample(connection))?;
        let answered = connection.send_goal.answer()?;
        let cancelled = connection.cancel_goal.answer()?;
        let ended = connection.get_result.answer()?;
        // A goal that was replaced ends, too.
        let ended = ended.filter(|_| self.asked == self.goal.as_ref().map(|(id, _)| *id));
        let Some((goal_id, goal)) = &mut self.goal else {
            return Ok(());
        };
        let goal_id = *goal_id;
        if let Some(answer) = answered {
            if answer.accepted {
                goal.acknowledge();
                connection.get_result.ask(GetResult { goal_id })?;
                self.asked = Some(goal_id);
            } else {
                goal.end(ros_2_outcome(None, 0, WITHOUT_REASON));
            }
        }
        if let Some(result) = ended {
            let (status, code) = (i64::from(result.status), i64::from(result.error_code));
            goal.end(ros_2_outcome(Some(status), code, &result.error_string));
        } else if cancelled.is_some_and(|answer| answer.return_code != 0) {
            // The server has not heard of the goal yet, or will not let it go: asked again until the patience ends.
            connection.cancel_goal.ask(CancelGoal::new(goal_id))?;
        }
        Ok(())
    }
}

/// What is said of a goal that is not taken: the answer has no place for a reason.
pub(super) const WITHOUT_REASON: &str =
    "it gives no reason: compare the joints' names and the goal with what its log says";

fn next<T: DeserializeOwned + 'static>(reader: &mut Reader<T>) -> Result<Option<T>, String> {
    let sample = reader
        .take_next_sample()
        .map_err(|error| error.to_string())?;
    Ok(sample.map(rustdds::no_key::DataSample::into_value))
}

/// A name that no other goal has.
pub(super) fn unique() -> GoalId {
    let mut id = [0; 16];
    for half in id.chunks_exact_mut(8) {
        half.copy_from_slice(&RandomState::new().hash_one(Instant::now()).to_ne_bytes());
    }
    id
}

impl ActionClient for Ros2Driver {
    fn goal(&self) -> Option<&Goal> {
        self.goal.as_ref().map(|(_, goal)| goal)
    }

    fn action(&self) -> &str {
        &self.address.action
    }

    fn listen(&mut self) -> Result<(), DriverError> {
        let Some(mut connection) = self.connection.take() else {
            return Err(self.lost(format_args!("not connected")));
        };
        let heard = self.hear(&mut connection);
        self.connection = Some(connection);
        heard.map_err(|error| self.lost(format_args!("{error}")))
    }

    fn cancel(&mut self, _: &str) -> Result<(), DriverError> {
        let asked = match (&self.goal, &mut self.connection) {
            // The answer to the last request counts.
            (Some((goal_id, _)), Some(connection)) => (self.former.iter().chain([goal_id]))
                .try_for_each(|id| connection.cancel_goal.ask(CancelGoal::new(*id))),
            _ => Ok(()),
        };
        asked.map_err(|error| self.lost(format_args!("{error}")))
    }

    fn lost(&self, reason: std::fmt::Arguments<'_>) -> DriverError {
        DriverError::Lost(format!("ROS 2, domain {}: {reason}", self.address.domain))
    }

    fn advice(&self) -> String {
        format!(
            "is its controller started, and does `middleware = \"{}\"` in the cell file fit the robot's RMW_IMPLEMENTATION?",
            self.address.middleware.name()
        )
    }
}

impl Driver for Ros2Driver {
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError> {
        self.joints = joints.to_vec();
        let connection = self
            .open()
            .map_err(|error| self.lost(format_args!("{error}")))?;
        let begin = Instant::now();
        while !connection.is_served() {
            if begin.elapsed() > DISCOVERY_PATIENCE {
                return Err(self.lost(format_args!(
                    "no action server of {} was found in {} s; is the controller started, and is `domain` its ROS_DOMAIN_ID?",
                    self.address.action,
                    DISCOVERY_PATIENCE.as_secs()
                )));
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(SETTLING);
        self.connection = Some(connection);
        Ok(())
    }

    fn reports_state(&self) -> bool {
        true
    }

    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        self.listen()?;
        Ok(self.state.clone())
    }

    fn sends_goals(&self) -> bool {
        true
    }

    fn start(&mut self, motion: &Interpolant) -> Result<(), DriverError> {
        let goal_id = unique();
        self.setpoint = None;
        let Some(connection) = &mut self.connection else {
            return Err(self.lost(format_args!("not connected")));
        };
        let goal = SendGoal::new(goal_id, &self.joints, motion);
        let sent = connection.send_goal.ask(goal);
        sent.map_err(|error| self.lost(format_args!("{error}")))?;
        self.former = self.goal.as_ref().map(|(id, _)| *id);
        self.goal = Some((goal_id, Goal::new()));
        Ok(())
    }

    fn advance(&mut self, _: f64) -> Result<Progress, DriverError> {
        self.progress()
    }

    fn setpoint(&self) -> Option<&JointState> {
        self.setpoint.as_ref()
    }

    fn is_accepted(&self) -> bool {
        self.goal
            .as_ref()
            .is_some_and(|(_, goal)| goal.is_accepted())
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        self.cancel_goal()
    }
}
