//! What the tasks of a robot cell have in common on the command line: where their results go, and how they end.

use super::chosen_cell::{CellChoice, TaskCell};
use super::exit_code::NOT_SEEN_WHOLE;
use super::interruption::watch_for_interruption;
use super::log_directory::log_directory;
use super::prelude::*;
use rodlab_files::results::write_whole;
use rodlab_robot::JointTrajectory;
use rodlab_workcell::task::{Status, TaskError, TaskRecord, TaskStage, Unfinished};

/// A task with arms of a cell, by its directory.
pub struct CellTask<'a> {
    cell: &'a TaskCell,
    choice: &'a CellChoice,
    arms: Vec<usize>,
    /// Where everything is written.
    pub directory: PathBuf,
    /// The marks of its arms.
    pub unfinished: Vec<Unfinished>,
}

impl<'a> CellTask<'a> {
    /// A task in an empty directory, see [`log_directory`].
    pub fn new(
        name: &str,
        out: Option<&Path>,
        cell: &'a TaskCell,
        arms: &[usize],
        choice: &'a CellChoice,
    ) -> Result<Self, Failure> {
        let directory = log_directory(name, out)?;
        let marks = cell.marked(arms).iter();
        let marks = marks.map(|arm| Unfinished::of(&cell.cell, *arm, &directory));
        Ok(Self {
            unfinished: marks.collect(),
            cell,
            choice,
            arms: arms.to_vec(),
            directory,
        })
    }

    /// Writes the motion, and a page that shows it in no more than so many frames.
    pub fn write_motion(&self, joints: &JointTrajectory, frames: usize) -> Result<(), Failure> {
        let page = self.cell.cell.page(Some(joints), frames);
        let files = [("joints.csv", joints.to_csv()?), ("cell.html", page)];
        for (name, text) in files {
            write_whole(&self.directory.join(name), text.as_bytes())?;
        }
        Ok(())
    }

    /// Carries a task out that was planned, or nothing of it where it is a `dry_run`; writes its record, clears the marks where the arms
    /// came to the end of their work, and prints the record. `run` does the task, and adds what it came to to the record.
    pub fn carry_out<R: TaskRecord, S: TaskStage>(
        &self,
        mut record: R,
        dry_run: bool,
        run: impl FnOnce(&mut R, &dyn Fn() -> bool) -> Result<(), TaskError<S>>,
    ) -> Result<(), Failure> {
        let directory = &self.directory;
        let report = record.write(directory)?;
        if dry_run {
            return self.choice.print(&report, &record, directory);
        }
        self.cell.confirm(&self.arms, directory, self.choice)?;
        record.head().status = Status::Running;
        record.write(directory)?;
        let interrupted = watch_for_interruption()?;
        let came_to = run(&mut record, &|| interrupted.is_raised());
        record.head().ended(came_to.as_ref().err());
        let failure = match came_to {
            Ok(()) => self.clear(),
            // The arms have done their work and hold nothing.
            Err(error @ TaskError::NotSeenWhole(_)) => {
                let unclear = self.clear();
                unclear.or_else(|| Some(ended_early(&error, None, directory)))
            }
            Err(error) => {
                let next = record.head().stopped.as_ref();
                let next = next.map(|stopped| stopped.next.clone());
                Some(ended_early(&error, next.as_deref(), directory))
            }
        };
        let report = record.write(directory)?;
        match failure {
            Some(failure) => Err(failure),
            None => self.choice.print(&report, &record, directory),
        }
    }

    /// Clears the marks of the arms; why they cannot be cleared.
    fn clear(&self) -> Option<Failure> {
        let cleared = self.unfinished.iter().try_for_each(Unfinished::clear);
        let unclear =
            |error| Failure::System(format!("the end of the task cannot be noted: {error}"));
        cleared.err().map(unclear)
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
        TaskError::Interrupted { .. } => Failure::interrupted(message),
        TaskError::NotSeenWhole(_) => Failure::Other {
            exit_code: NOT_SEEN_WHOLE,
            message: format!(
                "{error}; nothing is scored: look at overlay.png and rod.csv in {}",
                directory.display()
            ),
        },
        _ => Failure::System(message),
    }
}
