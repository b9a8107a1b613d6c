//! Typed starts from the end of another run.

use schemars::JsonSchema;
use serde::Deserialize;

/// Positions, frames and velocities at the end of another run of the same rods. Natural shapes, lengths and
/// masses stay those of this scenario; clamps hold the nodes where that run left them, and loads and motions start again at time zero.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "start")]
pub struct Start {
    /// A results directory, relative to this file, or the end_state.csv in one.
    pub from: Option<String>,
    /// Whether rods keep the velocities of that state. If not, they start with those of [[rods]].
    /// Default: true.
    pub velocities: Option<bool>,
    /// BLAKE3 hash that the file must have, in hexadecimal; results record it, so that their start can be identified.
    pub hash: Option<String>,
}
