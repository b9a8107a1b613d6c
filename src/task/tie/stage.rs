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
}

/// Why a knot was not tied to its end.
pub type TieError = TaskError<TieStage>;
