//! `rodlab explain`.

use super::failure::Failure;
use super::output::print;
use crate::experiment;
use clap::Args;

/// Arguments of `rodlab explain`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab explain time.step
  rodlab explain rods.shape
  rodlab explain contact")]
pub struct ExplainArguments {
    /// A dotted key; without one, the keys at the top
    pub key: Option<String>,
}

/// Explains a key.
pub fn explain(arguments: &ExplainArguments) -> Result<(), Failure> {
    let key = arguments.key.as_deref().unwrap_or("");
    print(&experiment::explain(key).map_err(Failure::Input)?)
}
