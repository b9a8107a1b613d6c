//! Identification of the gravito-bending length of a rod that an arm holds before the camera in
//! three poses.
//!
//! | file | what |
//! |---|---|
//! | `pose` | the poses, chosen for small error bars |
//! | `candidate` | what the camera would see of a pose, and what it determines |
//! | `strand` | the rod, traced in a picture |
//! | `task` | the steps: take, hold, look, fit |
//! | `record` | the record |

mod candidate;
mod pose;
mod record;
mod strand;
mod task;
#[cfg(test)]
mod tests;

pub use pose::{HeldPose, HoldRequest};
pub use record::IdentificationRecord;
pub use task::{IdentificationPlan, IdentificationTask};
