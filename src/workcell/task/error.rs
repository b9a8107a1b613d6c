//! Failures of steps, which end a task early.

use super::stage::Stage;
use crate::cell::PlanError;
use rodlab_files::results::ResultsError;
use rodlab_planning::plan::fold::FoldError;
use rodlab_vision::VisionError;

/// Failure of a step.
#[derive(Debug, thiserror::Error)]
pub enum WorkError {
    /// Failure of a device or a motion; all arms were commanded to hold.
    #[error("{0}")]
    Failed(String),
    /// Interruption by the user; all arms hold.
    #[error("interrupted; the arm holds")]
    Interrupted,
    /// The picture does not show the rod from end to end, so that it is not scored.
    #[error("not seen whole: {0}")]
    NotSeenWhole(String),
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl WorkError {
    /// A failure with a message.
    pub fn failed(reason: impl ToString) -> Self {
        Self::Failed(reason.to_string())
    }
}

impl From<String> for WorkError {
    fn from(reason: String) -> Self {
        Self::Failed(reason)
    }
}

impl From<VisionError> for WorkError {
    fn from(error: VisionError) -> Self {
        Self::failed(error)
    }
}

impl From<PlanError> for WorkError {
    fn from(error: PlanError) -> Self {
        Self::failed(error)
    }
}

impl From<FoldError> for WorkError {
    fn from(error: FoldError) -> Self {
        Self::failed(error)
    }
}

/// Early end of a task, with the step in which it happened.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.in_words())]
pub struct TaskError {
    /// The step that failed.
    pub stage: Box<Stage>,
    /// Failure of the step.
    pub error: WorkError,
}

impl TaskError {
    /// The step in which arms stopped; `None` for failures without an arm.
    pub fn stopped_in(&self) -> Option<&Stage> {
        match self.error {
            WorkError::Failed(_) | WorkError::Interrupted => Some(&self.stage),
            WorkError::NotSeenWhole(_) | WorkError::Results(_) => None,
        }
    }

    fn in_words(&self) -> String {
        match self.stopped_in() {
            Some(stage) => format!("{}: {}", stage.words, self.error),
            None => self.error.to_string(),
        }
    }
}
