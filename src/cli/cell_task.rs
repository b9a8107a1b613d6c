//! What the tasks of a robot cell have in common on the command line: whether they may begin, and how they end.

use super::failure::Failure;
use crate::cell::Cell;
use crate::task::{Status, TaskError, TaskStage, Unfinished};
use std::path::Path;

/// Refuses to move an arm whose last task did not come to its end, until somebody has looked at it and says so.
pub fn refuse_unfinished(cell: &Cell, arm: usize) -> Result<(), Failure> {
    let Some(left) = Unfinished::of(cell, arm, Path::new("")).left() else {
        return Ok(());
    };
    Err(Failure::Input(format!(
        "the last task with arm {} did not come to its end ({left}): look at the arm and at what it holds, and then say --checked",
        cell.arms[arm].name
    )))
}

/// Notes that a task came to its end.
pub fn note_end(unfinished: &Unfinished) -> Result<(), Failure> {
    let cleared = unfinished.clear();
    cleared
        .map_err(|error| Failure::System(format!("the end of the task cannot be noted: {error}")))
}

/// How far a task came that ended early.
pub fn status_of<S: TaskStage>(error: &TaskError<S>) -> Status {
    match error {
        TaskError::Interrupted => Status::Interrupted,
        _ => Status::Failed,
    }
}

/// A task that ended early, with its log in a directory.
pub fn ended_early<S: TaskStage>(error: &TaskError<S>, directory: &Path) -> Failure {
    let message = format!("{error}; the log is in {}", directory.display());
    match error {
        TaskError::Interrupted => Failure::Cases {
            exit_code: 130,
            message,
        },
        _ => Failure::System(message),
    }
}
