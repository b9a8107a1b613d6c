//! Why a task ends early.

use rodlab_files::results::ResultsError;
use std::fmt::Debug;

/// What is done one after the other in a task.
pub trait TaskStage: Copy + Debug {
    /// In words: "going to the first point".
    fn in_words(self) -> &'static str;

    /// What to do after a task that ended in it.
    fn next_step(self) -> &'static str;
}

/// Why a task ended early.
#[derive(Debug, thiserror::Error)]
pub enum TaskError<S: TaskStage> {
    /// Something failed.
    #[error("{}: {reason}", stage.in_words())]
    Failed {
        /// While this was done.
        stage: S,
        /// In words.
        reason: String,
    },
    /// Somebody asked for the end; the arm holds.
    #[error("{}: interrupted; the arm holds", stage.in_words())]
    Interrupted {
        /// While this was done, or after it.
        stage: S,
    },
    /// The picture does not show the rod from end to end: nothing is scored.
    #[error("not seen whole: {0}")]
    NotSeenWhole(String),
    /// A file could not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl<S: TaskStage> TaskError<S> {
    /// Something failed in a stage, for a reason in words.
    pub fn failed(stage: S, reason: impl ToString) -> Self {
        let reason = reason.to_string();
        Self::Failed { stage, reason }
    }

    /// What was being done; `None` where no arm is to blame.
    pub fn stage(&self) -> Option<S> {
        match self {
            Self::Failed { stage, .. } | Self::Interrupted { stage } => Some(*stage),
            Self::NotSeenWhole(_) | Self::Results(_) => None,
        }
    }

    /// What an arm did not do in a stage.
    pub fn of_work(stage: S) -> impl Fn(WorkError) -> Self {
        move |error| match error {
            WorkError::Failed(reason) => Self::Failed { stage, reason },
            WorkError::Interrupted => Self::Interrupted { stage },
        }
    }
}

/// Why an arm did not do what it was to do.
#[derive(Debug, thiserror::Error)]
pub enum WorkError {
    /// Something failed; all was commanded to hold.
    #[error("{0}")]
    Failed(String),
    /// Somebody asked for the end; all holds.
    #[error("interrupted; the arm holds")]
    Interrupted,
}

impl WorkError {
    /// Something failed, for a reason in words.
    pub fn failed(reason: impl ToString) -> Self {
        Self::Failed(reason.to_string())
    }
}
