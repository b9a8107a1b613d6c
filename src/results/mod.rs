//! Results directories: manifests, series, node files, checkpoints, VTK.

mod error;
mod outcome;

pub use error::ResultsError;
pub use outcome::CaseOutcome;
