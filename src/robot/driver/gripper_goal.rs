//! What the drivers of grippers share, whichever way they reach them: a goal of `control_msgs/GripperCommand` ends in time, or it
//! is cancelled.

use super::DriverError;
use std::fmt::Display;
use std::time::{Duration, Instant};

/// Time between looks.
pub(super) const LOOK: Duration = Duration::from_millis(5);

/// A goal that was sent to a gripper.
pub(super) trait GripperGoal {
    /// Whether it has ended as it should; waits a moment where nothing is heard.
    ///
    /// # Errors
    /// It has ended otherwise, or the connection is lost.
    fn has_ended(&mut self) -> Result<bool, DriverError>;

    /// Cancels it, and returns what is to be reported of the error that ended it.
    fn cancel(&mut self, error: DriverError) -> DriverError;

    /// An error of the connection, with the address of the other end.
    fn lost(&self, reason: &dyn Display) -> DriverError;

    /// What to look at where the gripper does not move.
    fn advice(&self) -> String {
        "; is it started, and is this its action?".into()
    }
}

/// Waits for the end of a goal of the action `action`. Whatever else ends it, the fingers must not move on.
///
/// # Errors
/// It did not end as it should, or not in time, or the user asked for the end.
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

/// Waits for the server of an action; `false` where it does not come in time.
///
/// # Errors
/// The user asked for the end.
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

/// The error of a motion that the user ended.
pub(super) fn interrupted() -> DriverError {
    DriverError::Aborted("interrupted".into())
}
