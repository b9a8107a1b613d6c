//! What is done one after the other when a knot is tied, and why it ends early.

use crate::task::error::{TaskError, TaskStage};

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TieStage {
    /// One arm goes out of the way, the other one to the first point.
    Approach,
    /// Its gripper takes the rod.
    Take,
    /// The rod is laid.
    Lay,
    /// Its end is led, and strands are lifted.
    Tie,
    /// The gripper lets the end go.
    LetGo,
    /// The arm goes out of the picture.
    Retreat,
    /// The camera looks.
    Look,
    /// The knot that it saw is compared with the one that was drawn.
    Score,
}

impl TaskStage for TieStage {
    fn in_words(self) -> &'static str {
        match self {
            Self::Approach => "going to the first point",
            Self::Take => "taking the rod",
            Self::Lay => "laying it",
            Self::Tie => "tying it",
            Self::LetGo => "letting it go",
            Self::Retreat => "going out of the picture",
            Self::Look => "looking",
            Self::Score => "scoring",
        }
    }

    fn next_step(self) -> &'static str {
        match self {
            Self::Approach | Self::Take | Self::Lay | Self::Tie | Self::LetGo => {
                "a gripper may hold a rod: look at both arms, open their grippers and take the rods off the table, then run the \
                 command again with --checked; tying starts from the beginning"
            }
            Self::Retreat | Self::Look | Self::Score => {
                "the rods are let go: look at both arms and at the camera; `rodlab trace` with the camera shows what lies there; \
                 begin the next task with --checked"
            }
        }
    }
}

/// Why a knot was not tied to its end.
pub type TieError = TaskError<TieStage>;
