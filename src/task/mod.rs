//! Tasks of the robot cell: what joins plan, cell, camera and results.
//!
//! | file | what |
//! |---|---|
//! | `deploy` | a rod laid along a pattern by an arm: approach, take, lay, let go, look, score |
//! | `motion` | the motions of that, planned and checked before anything moves |
//! | `look` | the camera's picture as a curve in the frame of the pattern |
//! | `record` | what it leaves in a results directory |

mod deploy;
mod look;
mod motion;
mod record;

pub use deploy::{DeployEnd, DeployError, DeployTask, Stage};
pub use motion::{DeployMotion, MotionRequest, middle_of_table};
pub use record::{DeployRecord, Status, write_manifest, write_report};
