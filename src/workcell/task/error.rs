//! Why a step of a task is not done, and why the task ends early then.

use super::stage::Stage;
use crate::cell::PlanError;
use rodlab_files::results::ResultsError;
use rodlab_planning::plan::fold::FoldError;
use rodlab_vision::VisionError;

/// Why a step was not done.
#[derive(Debug, thiserror::Error)]
pub enum WorkError {
    /// Something failed; all was commanded to hold.
    #[error("{0}")]
    Failed(String),
    /// The user asked for the end; all holds.
    #[error("interrupted; the arm holds")]
    Interrupted,
    /// The picture does not show the rod from end to end: nothing is scored.
    #[error("not seen whole: {0}")]
    NotSeenWhole(String),
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl WorkError {
    /// Something failed, for a reason in words.
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

/// Why a task ended early, and in which step.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.in_words())]
pub struct TaskError {
    /// The step that was not done.
    pub stage: Box<Stage>,
    /// Why.
    pub error: WorkError,
}

impl TaskError {
    /// The step in which arms stopped; `None` where no arm is to blame.
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
