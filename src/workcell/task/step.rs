//! Tasks as lists of steps.

use super::error::WorkError;
use super::record::TaskRecord;
use super::stage::Stage;
use super::stopped::LaidAlong;
use super::workplace::Workplace;
use crate::cell::{Cell, PlanError};
use rodlab_files::results::ResultsError;
use rodlab_robot::JointTrajectory;
use std::path::Path;

/// Function of a step.
type Act<T> = Box<dyn Fn(&mut T, &Workplace<'_>) -> Result<(), WorkError>>;

/// A step of a task.
pub struct Step<T: ?Sized> {
    /// Its stage.
    pub stage: Stage,
    act: Act<T>,
}

impl<T> Step<T> {
    /// A step that does something.
    pub fn new(
        stage: &Stage,
        act: impl Fn(&mut T, &Workplace<'_>) -> Result<(), WorkError> + 'static,
    ) -> Self {
        Self {
            stage: stage.clone(),
            act: Box::new(act),
        }
    }

    /// Carries it out.
    ///
    /// # Errors
    /// The step failed.
    pub fn act(&self, task: &mut T, at: &Workplace<'_>) -> Result<(), WorkError> {
        (self.act)(task, at)
    }
}

/// A task that was planned. A step keeps what later steps and the record need in it.
pub trait Task: Sized {
    /// Its record in the manifest and in the report.
    type Record: TaskRecord;

    /// Most frames of the page of its motion.
    const FRAMES: usize = 400;

    /// Its record so far.
    fn record(&self) -> &Self::Record;

    /// Indices of its arms.
    fn arms(&self) -> Vec<usize>;

    /// The motion that is shown before anything moves; `None` where nothing moves.
    ///
    /// # Errors
    /// The motion cannot be planned.
    fn motion(&self, cell: &Cell) -> Result<Option<JointTrajectory>, PlanError>;

    /// Its steps, one after the other. A task that is resumed leaves out those that are done.
    fn steps(&self) -> Vec<Step<Self>>;

    /// Paths along which rods are laid, in the order in which they are, the first by the first arm.
    fn paths(&self) -> Vec<LaidAlong<'_>> {
        Vec::new()
    }

    /// Advice after the task ended in a stage.
    fn next_step(&self, stage: &Stage) -> String {
        stage.next.into()
    }

    /// Writes the files of a plan that is not carried out.
    ///
    /// # Errors
    /// It cannot be written.
    fn write_plan(&self, _: &Cell, _: &Path) -> Result<(), ResultsError> {
        Ok(())
    }

    /// Writes the figures of the results.
    ///
    /// # Errors
    /// They cannot be written.
    fn write_figures(&self, _: &Path) -> Result<(), ResultsError> {
        Ok(())
    }
}
