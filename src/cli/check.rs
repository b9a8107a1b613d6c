//! `rodlab check`.

use super::arguments::Common;
use super::failure::Failure;
use super::output::print;
use super::run::prepare;
use crate::experiment::{DerivedNumbers, derived_numbers, try_scene};
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments of `rodlab check`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab check scenarios/*.toml
  rodlab check beam.toml --set rods.beam.radius=\"7 mm\" --json")]
pub struct CheckArguments {
    /// The scenario files
    #[arg(required = true)]
    pub scenarios: Vec<PathBuf>,
    /// Set a key of each scenario; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    /// Print the numbers as JSON, an object per file
    #[arg(long)]
    pub json: bool,
}

/// Checks scenarios. All are checked, whatever is wrong with the first.
pub fn check(arguments: &CheckArguments, common: &Common) -> Result<(), Failure> {
    let mut last = None;
    for path in &arguments.scenarios {
        match check_one(path, &arguments.overrides) {
            Ok(numbers) if arguments.json => print(&format!("{}\n", numbers.to_json()))?,
            Ok(numbers) => print(&format!("{}: good\n{numbers}", path.display()))?,
            Err(failure) => {
                if let Some(earlier) = last.replace(failure) {
                    earlier.report(common.colours_stderr());
                }
            }
        }
    }
    last.map_or(Ok(()), Err)
}

fn check_one(path: &Path, overrides: &[String]) -> Result<DerivedNumbers, Failure> {
    let prepared = prepare(path, overrides)?;
    try_scene(&prepared)?;
    Ok(derived_numbers(&prepared))
}
