//! Resolved start from the end of another run.

use serde::Serialize;
use std::sync::Arc;

/// The state from which the run starts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Start {
    /// The copy of the state beside the resolved scenario.
    pub from: &'static str,
    /// Whether the rods keep the velocities of that state.
    pub velocities: bool,
    /// BLAKE3 hash of its file, in hexadecimal.
    pub hash: String,
    /// The file.
    #[serde(skip)]
    pub contents: Arc<[u8]>,
}
