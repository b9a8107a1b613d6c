//! Code shared by all gripper drivers: a `control_msgs/GripperCommand` goal that does not end in
//! time is cancelled.

use super::DriverError;
use std::fmt::Display;
use std::time::{Duration, Instant};

/// Time between two polls.
pub(super) const LOOK: Duration = Duration::from_millis(5);

/// A goal that was sent to a gripper.
pub(super) trait GripperGoal {
    /// Whether the goal has succeeded; waits briefly if nothing arrives.
    ///
    /// # Errors
    /// The goal has failed, or the connection is lost.
    fn has_ended(&mut self) -> Result<bool, DriverError>;

    /// Cancels the goal, and returns the error to report.
    fn cancel(&mut self, error: DriverError) -> DriverError;

    /// An error of the connection, with the address of the other end.
    fn lost(&self, reason: &dyn Display) -> DriverError;

    /// Advice for the user if the gripper does not move.
    fn advice(&self) -> String {
        "; is it started, and is this its action?".into()
    }
}

/// Waits for the end of a goal of an action. On any error the fingers are stopped.
///
/// # Errors
/// The goal failed or timed out, or the user interrupted it.
pub(super) fn wait_for_end(
    goal: &mut dyn GripperGoal,
    action: &str,
    patience: Duration,
    is_interrupted: &dyn Fn() -> bool,
) -> Result<(), DriverError> {
    let begin = Instant::now();
    let error = loop {
        if begin.elapsed() >= patience {
            break goal.lost(&format_args!(
                "the gripper {action} has not moved within {} s{}",
                patience.as_secs_f64(),
                goal.advice()
            ));
        }
        if is_interrupted() {
            break interrupted();
        }
        match goal.has_ended() {
            Ok(true) => return Ok(()),
            Ok(false) => {}
            Err(error) => break error,
        }
    };
    Err(goal.cancel(error))
}

/// Waits for the server of an action; `false` if it does not appear in time.
///
/// # Errors
/// The user interrupted the wait.
pub(super) fn wait_for_server(
    patience: Duration,
    is_interrupted: &dyn Fn() -> bool,
    is_there: &dyn Fn() -> bool,
) -> Result<bool, DriverError> {
    let begin = Instant::now();
    while !is_there() {
        if is_interrupted() {
            return Err(interrupted());
        }
        if begin.elapsed() > patience {
            return Ok(false);
        }
        std::thread::sleep(LOOK);
    }
    Ok(true)
}

/// The error of a motion that the user interrupted.
pub(super) fn interrupted() -> DriverError {
    DriverError::Aborted("interrupted".into())
}
