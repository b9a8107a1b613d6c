//! Tasks of the robot cell: what joins plan, cell, camera and results.
//!
//! | file | what |
//! |---|---|
//! | `deploy` | a rod laid along a pattern by an arm: approach, take, lay, let go, look, score |
//! | `fold` | a sheet folded by an arm, with the camera |
//! | `motion` | the motions of a deployment, planned and checked before anything moves |
//! | `look` | the camera's picture as a curve in the frame of the pattern |
//! | `record` | what it leaves in a results directory |

mod deploy;
mod fold;
mod look;
mod motion;
mod record;

pub use deploy::{DeployEnd, DeployError, DeployTask, Stage};
pub use fold::{
    FoldEnd, FoldMotion, FoldMotionRequest, FoldRecord, FoldRequest, FoldScore, FoldStage,
    FoldTask, FoldTaskError, FoldWay, Look, WorkError, WorkingArm, heading,
};
pub use motion::{DeployMotion, MotionRequest, middle_of_table};
pub use record::{DeployRecord, Status, write_manifest, write_report};
