//! What the tasks of a robot cell have in common on the command line: whether they may begin, and how they end.

use super::failure::Failure;
use super::output::print_json;
use crate::cell::Cell;
use crate::task::{TaskError, TaskRecord, TaskStage, Unfinished};
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

/// Ends a task: takes over what it came to, writes its record, clears its marks where it came to its end, and prints the record.
///
/// # Errors
/// It ended early, or something cannot be written.
pub fn finish<R: TaskRecord, T, S: TaskStage>(
    mut record: R,
    came_to: Result<T, TaskError<S>>,
    take: impl FnOnce(&mut R, T),
    unfinished: &[Unfinished],
    directory: &Path,
) -> Result<(), Failure> {
    record.head().ended(came_to.as_ref().err());
    let failure = match came_to {
        Ok(came_to) => {
            take(&mut record, came_to);
            let cleared = unfinished.iter().try_for_each(Unfinished::clear);
            let unclear =
                |error| Failure::System(format!("the end of the task cannot be noted: {error}"));
            cleared.err().map(unclear)
        }
        Err(error) => Some(ended_early(&error, directory)),
    };
    record.write(directory)?;
    match failure {
        Some(failure) => Err(failure),
        None => print_json(&record),
    }
}

/// A task that ended early, with its log in a directory.
fn ended_early<S: TaskStage>(error: &TaskError<S>, directory: &Path) -> Failure {
    let message = format!("{error}; the log is in {}", directory.display());
    match error {
        TaskError::Interrupted => Failure::Cases {
            exit_code: 130,
            message,
        },
        _ => Failure::System(message),
    }
}
