//! What is done one after the other when a sheet is folded, and why it ends early.

use super::arm::WorkError;
use crate::results::ResultsError;

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FoldStage {
    /// The camera looks where the sheet lies.
    Look,
    /// The arm goes in front of its edge.
    Approach,
    /// The hand goes to the edge, and the gripper takes it.
    Take,
    /// The sheet is folded.
    Fold,
    /// The camera looks how far it has slid.
    Score,
    /// The gripper lets go.
    LetGo,
    /// The arm goes out of the picture.
    Retreat,
    /// The camera looks what is left of the fold.
    LookAgain,
}

impl FoldStage {
    /// In words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Look => "looking where the sheet lies",
            Self::Approach => "going to its edge",
            Self::Take => "taking the edge",
            Self::Fold => "folding",
            Self::Score => "scoring",
            Self::LetGo => "letting the edge go",
            Self::Retreat => "going out of the picture",
            Self::LookAgain => "looking again",
        }
    }
}

/// Why a fold ended early.
#[derive(Debug, thiserror::Error)]
pub enum FoldTaskError {
    /// Something failed.
    #[error("{}: {reason}", stage.in_words())]
    Failed {
        /// While this was done.
        stage: FoldStage,
        /// In words.
        reason: String,
    },
    /// Somebody asked for the end; the arm holds.
    #[error("interrupted; the arm holds")]
    Interrupted,
    /// A file could not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl FoldTaskError {
    /// Something failed in a stage, for a reason in words.
    pub fn failed(stage: FoldStage, reason: impl ToString) -> Self {
        let reason = reason.to_string();
        Self::Failed { stage, reason }
    }

    /// An arm did not do what it was to do in a stage.
    pub fn of_work(stage: FoldStage, error: WorkError) -> Self {
        match error {
            WorkError::Failed(reason) => Self::Failed { stage, reason },
            WorkError::Interrupted => Self::Interrupted,
            WorkError::Results(error) => Self::Results(error),
        }
    }
}
