//! A sheet folded by an arm, open loop or with the camera (thesis sec. 4.5.1, Algorithm 5).
//!
//! | file | what |
//! |---|---|
//! | `task` | look, approach, take, fold in parts, look after each, let go, look again |
//! | `stage` | names of these, and why a fold ends early |
//! | `way` | the way of the edge in parts, planned anew where the sheet has slid |
//! | `motion` | the motions of that, planned and checked before anything moves |
//! | `sight` | the sheet as the camera sees it |
//! | `score` | what was seen, and what it came to |
//! | `record` | what it leaves in a results directory |

mod motion;
mod record;
mod score;
mod sight;
mod stage;
mod task;
mod way;

pub use motion::{FoldMotion, FoldMotionRequest, heading};
pub use record::FoldRecord;
pub use score::{FoldScore, Look};
pub use stage::{FoldStage, FoldTaskError};
pub use task::{FoldEnd, FoldTask};
pub use way::{FoldRequest, FoldWay};
