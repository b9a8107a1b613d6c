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
    /// Stage of the step.
    pub stage: Stage,
    act: Act<T>,
}

impl<T> Step<T> {
    /// Creates a step from its stage and its function.
    pub fn new(
        stage: &Stage,
        act: impl Fn(&mut T, &Workplace<'_>) -> Result<(), WorkError> + 'static,
    ) -> Self {
        Self {
            stage: stage.clone(),
            act: Box::new(act),
        }
    }

    /// Carries out the step.
    ///
    /// # Errors
    /// The step failed.
    pub fn act(&self, task: &mut T, at: &Workplace<'_>) -> Result<(), WorkError> {
        (self.act)(task, at)
    }
}

/// A planned task. Steps store data for later steps and for the record in it.
pub trait Task: Sized {
    /// Record of the task in the manifest and the report.
    type Record: TaskRecord;

    /// Largest number of frames of the page of its motion.
    const FRAMES: usize = 400;

    /// The record so far.
    fn record(&self) -> &Self::Record;

    /// Indices of the arms.
    fn arms(&self) -> Vec<usize>;

    /// The motion that is shown before anything moves; `None` if there is no motion.
    ///
    /// # Errors
    /// The motion cannot be planned.
    fn motion(&self, cell: &Cell) -> Result<Option<JointTrajectory>, PlanError>;

    /// Steps in sequence. A resumed task omits completed steps.
    fn steps(&self) -> Vec<Step<Self>>;

    /// Paths of the rods in the order in which they are laid; the first arm lays the first rod.
    fn paths(&self) -> Vec<LaidAlong<'_>> {
        Vec::new()
    }

    /// Advice after the task ended in a given stage.
    fn next_step(&self, stage: &Stage) -> String {
        stage.next.into()
    }

    /// Writes the files of a plan that is not carried out.
    ///
    /// # Errors
    /// A file cannot be written.
    fn write_plan(&self, _: &Cell, _: &Path) -> Result<(), ResultsError> {
        Ok(())
    }

    /// Writes the figures of the results.
    ///
    /// # Errors
    /// A figure cannot be written.
    fn write_figures(&self, _: &Path) -> Result<(), ResultsError> {
        Ok(())
    }
}
