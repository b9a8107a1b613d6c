//! Messages about the end of a `control_msgs/FollowJointTrajectory` goal.

use super::DriverError;

/// The end of a ROS 1 goal: `actionlib_msgs/GoalStatus`, the code of the result and the message of
/// the controller.
///
/// # Errors
/// The goal did not succeed.
pub(super) fn ros_1_outcome(status: i64, code: i64, said: &str) -> Result<(), DriverError> {
    match status {
        3 if code == 0 => Ok(()),
        5 => Err(rejected(code, said)),
        2 | 8 => Err(cancelled(code, said)),
        _ => Err(aborted(code, said)),
    }
}

/// The end of a ROS 2 goal: `action_msgs/GoalStatus`, or `None` if it was not accepted, the code
/// of the result and the message of the controller.
///
/// # Errors
/// The goal did not succeed.
pub(super) fn ros_2_outcome(status: Option<i64>, code: i64, said: &str) -> Result<(), DriverError> {
    match status {
        None => Err(rejected(code, said)),
        Some(4) if code == 0 => Ok(()),
        Some(5) => Err(cancelled(code, said)),
        Some(_) => Err(aborted(code, said)),
    }
}

fn rejected(code: i64, said: &str) -> DriverError {
    DriverError::Refused(in_words("the controller rejected the goal", code, said))
}

fn cancelled(code: i64, said: &str) -> DriverError {
    DriverError::Aborted(in_words("the motion was cancelled", code, said))
}

fn aborted(code: i64, said: &str) -> DriverError {
    DriverError::Aborted(in_words("the controller aborted the motion", code, said))
}

/// The message, with the error codes of `control_msgs/FollowJointTrajectory`.
fn in_words(what: &str, code: i64, said: &str) -> String {
    let meaning = match code {
        -1 => ": invalid goal",
        -2 => ": unknown joints; compare their names in the cell file with the robot's",
        -3 => ": the time stamp is too old; compare the clocks",
        -4 => ": the arm left the path",
        -5 => ": the arm did not reach the goal",
        _ => "",
    };
    let said = said.trim();
    let quoted = if said.is_empty() {
        String::new()
    } else {
        format!(" ({said})")
    };
    format!("{what}{meaning}{quoted}")
}
