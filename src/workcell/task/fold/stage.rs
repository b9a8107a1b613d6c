//! What is done one after the other when a sheet is folded, and why it ends early.

use crate::task::error::{TaskError, TaskStage};

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

impl TaskStage for FoldStage {
    fn in_words(self) -> &'static str {
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

    fn next_step(self) -> &'static str {
        match self {
            Self::Look | Self::Approach => {
                "the sheet was not touched: look at the arm and at the camera, then run the command again with --checked"
            }
            Self::Take | Self::Fold | Self::Score | Self::LetGo => {
                "the gripper may hold the sheet: look at the arm, open the gripper and lay the sheet flat, then run the command \
                 again with --checked"
            }
            Self::Retreat | Self::LookAgain => {
                "the sheet is folded and let go: look at the arm; `rodlab measure sheet` shows how the sheet lies; begin the next \
                 task with --checked"
            }
        }
    }
}

/// Why a fold ended early.
pub type FoldTaskError = TaskError<FoldStage>;
