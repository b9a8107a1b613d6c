//! What the tasks of a robot cell have in common on the command line: whether they may begin, and how they end.

use super::exit_code::NOT_SEEN_WHOLE;
use super::failure::Failure;
use super::output::print_json;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{TaskError, TaskRecord, TaskStage, Unfinished};
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

/// What a task with an arm needs and the cell file lacks, in words; `camera` says what the camera is for.
pub fn missing_part(cell: &Cell, arm: usize, camera: &str) -> Option<String> {
    let known = &cell.arms[arm];
    let name = &known.name;
    let seen = cell.camera.as_ref();
    if seen.is_none_or(|seen| seen.source.is_none()) {
        return Some(format!("a [camera] with a `source` is needed: {camera}"));
    }
    if known.driver.is_none() {
        return Some(format!("arm {name} needs a `driver`"));
    }
    if cell.gripper(arm).is_none() {
        let needed =
            "needs a `gripper`, and a driver of kind \"rosbridge\", \"ros1\" or \"ros2\" for it";
        return Some(format!("arm {name} {needed}"));
    }
    None
}

/// Ends a task: takes over what it came to, writes its record, clears its marks where the arms came to the end of their work, and
/// prints the record.
///
/// # Errors
/// It ended early, the rod is not seen whole, or something cannot be written.
pub fn finish<R: TaskRecord, T, S: TaskStage>(
    mut record: R,
    came_to: Result<T, TaskError<S>>,
    take: impl FnOnce(&mut R, T),
    unfinished: &[Unfinished],
    directory: &Path,
) -> Result<(), Failure> {
    record.head().ended(came_to.as_ref().err());
    let clear = || {
        let cleared = unfinished.iter().try_for_each(Unfinished::clear);
        let unclear =
            |error| Failure::System(format!("the end of the task cannot be noted: {error}"));
        cleared.err().map(unclear)
    };
    let failure = match came_to {
        Ok(came_to) => {
            take(&mut record, came_to);
            clear()
        }
        // The arms have done their work and hold nothing.
        Err(error @ TaskError::NotSeenWhole(_)) => {
            clear().or_else(|| Some(ended_early(&error, None, directory)))
        }
        Err(error) => {
            let next = record.head().stopped.as_ref();
            let next = next.map(|stopped| stopped.next.clone());
            Some(ended_early(&error, next.as_deref(), directory))
        }
    };
    record.write(directory)?;
    match failure {
        Some(failure) => Err(failure),
        None => print_json(&record),
    }
}

/// A task that ended early, with its log in a directory.
fn ended_early<S: TaskStage>(
    error: &TaskError<S>,
    next: Option<&str>,
    directory: &Path,
) -> Failure {
    let mut message = format!("{error}; the log is in {}", directory.display());
    if let Some(next) = next {
        message += &format!("\nnext: {next}");
    }
    match error {
        TaskError::Interrupted { .. } => Failure::Cases {
            exit_code: 130,
            message,
        },
        TaskError::NotSeenWhole(_) => Failure::Cases {
            exit_code: NOT_SEEN_WHOLE,
            message: format!(
                "{error}; nothing is scored: look at overlay.png and rod.csv in {}",
                directory.display()
            ),
        },
        _ => Failure::System(message),
    }
}
