//! A gripper of ROS 2: the action `control_msgs/GripperCommand`.

use super::super::follow_joint_trajectory::ros_2_outcome;
use super::super::gripper_goal::{GripperGoal, LOOK, interrupted, wait_for_end};
use super::super::{DriverError, GripperDriver};
use super::Ros2GripperAddress;
use super::action::{Action, WITHOUT_REASON, absence, participant, unique};
use super::message::{CancelGoal, GetResult, GoalId, GripperCommand, GripperResult};
use std::fmt::Display;
use std::time::{Duration, Instant};

/// Longest wait for the answer to a goal, and to its cancellation.
const ANSWER_PATIENCE: Duration = Duration::from_secs(3);
const CANCEL_PATIENCE: Duration = Duration::from_millis(500);
/// Status of a goal that the controller aborted.
const ABORTED: i8 = 6;

/// A gripper by its action.
pub struct Ros2Gripper {
    address: Ros2GripperAddress,
}

impl Ros2Gripper {
    /// A driver for the gripper at an address.
    pub fn new(address: Ros2GripperAddress) -> Self {
        Self { address }
    }

    fn lost(&self, reason: impl Display) -> DriverError {
        DriverError::Lost(format!("ROS 2, domain {}: {reason}", self.address.domain))
    }
}

impl GripperDriver for Ros2Gripper {
    fn command(
        &self,
        opening: f64,
        patience: Duration,
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<(), DriverError> {
        let address = &self.address;
        let lost = |reason: String| self.lost(reason);
        let participant = participant(address.domain, address.interface).map_err(lost)?;
        let name = address.action.trim_matches('/');
        let action = Action::new(&participant, address.middleware, name, "GripperCommand");
        let mut action = action.map_err(lost)?;
        if !action.meet(&participant, is_interrupted)? {
            return Err(self.lost(absence(&address.action, "gripper")));
        }
        let id = unique();
        let goal = GripperCommand::new(id, opening, address.max_effort);
        action.send_goal.ask(goal).map_err(lost)?;
        let mut sent = SentGoal {
            gripper: self,
            action,
            id,
            sent: Instant::now(),
            is_taken: false,
        };
        wait_for_end(&mut sent, &address.action, patience, is_interrupted)
    }
}

/// A goal, and the services of its action.
struct SentGoal<'a> {
    gripper: &'a Ros2Gripper,
    action: Action<GripperCommand, GripperResult>,
    id: GoalId,
    sent: Instant,
    is_taken: bool,
}

impl SentGoal<'_> {
    /// Cancels the goal; `true` if the server confirms that in time.
    fn is_cancelled(&mut self) -> Result<bool, String> {
        let begin = Instant::now();
        let service = &mut self.action.cancel_goal;
        service.ask(CancelGoal::new(self.id))?;
        while begin.elapsed() < CANCEL_PATIENCE {
            if let Some(answer) = service.answer()? {
                return Ok(answer.return_code == 0);
            }
            std::thread::sleep(LOOK);
        }
        Ok(false)
    }
}

impl GripperGoal for SentGoal<'_> {
    fn has_ended(&mut self) -> Result<bool, DriverError> {
        let lost = |reason: String| self.gripper.lost(reason);
        if let Some(answer) = self.action.send_goal.answer().map_err(lost)? {
            if !answer.accepted {
                return ros_2_outcome(None, 0, WITHOUT_REASON).map(|()| true);
            }
            self.is_taken = true;
            let goal_id = self.id;
            let asked = self.action.get_result.ask(GetResult { goal_id });
            asked.map_err(lost)?;
        }
        if !self.is_taken && self.sent.elapsed() > ANSWER_PATIENCE {
            let address = &self.gripper.address;
            return Err(self.gripper.lost(format_args!(
                "the goal of {} was not answered within {} s; does `middleware = \"{}\"` in the cell file fit the robot's RMW_IMPLEMENTATION?",
                address.action,
                ANSWER_PATIENCE.as_secs(),
                address.middleware.name()
            )));
        }
        let Some(result) = self.action.get_result.answer().map_err(lost)? else {
            std::thread::sleep(LOOK);
            return Ok(false);
        };
        // Fingers stall when they hold an object; some controllers then abort the goal.
        if result.status == ABORTED && result.stalled {
            return Ok(true);
        }
        ros_2_outcome(Some(result.status.into()), 0, "").map(|()| true)
    }

    fn cancel(&mut self, error: DriverError) -> DriverError {
        match self.is_cancelled() {
            Ok(false) if error == interrupted() => self
                .gripper
                .lost("the cancellation was not confirmed: watch the gripper"),
            Err(reason) => self.gripper.lost(format_args!("{error}; {reason}")),
            Ok(_) => error,
        }
    }

    fn lost(&self, reason: &dyn Display) -> DriverError {
        self.gripper.lost(reason)
    }

    fn advice(&self) -> String {
        String::new()
    }
}
