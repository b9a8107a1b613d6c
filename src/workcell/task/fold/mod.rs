//! A sheet folded by an arm, open loop or with the camera (thesis sec. 4.5.1, Algorithm 5).

mod motion;
mod record;
mod score;
mod sight;
mod task;
mod way;

pub use motion::{FoldMotion, heading};
pub use record::FoldRecord;
pub use score::{FoldScore, Look};
pub use task::{FoldPlan, FoldTask};
pub use way::{FoldRequest, FoldWay};
