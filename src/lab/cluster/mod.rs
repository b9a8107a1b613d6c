//! Slurm: job arrays that run the cases of a sweep.
//!
//! The module is independent of mechanics and scenarios: a task is a number, and it runs a command.

mod error;
mod jobs;
mod queue;
mod request;
mod script;
mod submission;

pub use error::ClusterError;
pub use jobs::{JOBS, Jobs, LOGS};
pub use queue::{Task, TaskState, tasks};
pub use request::Request;
pub use script::{Program, script};
pub use submission::submit;
