//! `rodlab expand`.

use super::candidates::keys;
use super::prelude::*;
use rodlab_lab::experiment::{case_set, expanded_toml};

/// Arguments of `rodlab expand`.
#[derive(Debug, Args)]
#[command(after_help = "\
Parameters, expressions and copies become numbers and tables; files that are extended or included
are merged. A run of the output gives the same bytes. Names of files in it are absolute. For a sweep,
the first case is printed.

Examples:
  rodlab expand pile
  rodlab expand scenarios/pile.toml --set rods.0.count=3 > three.toml")]
pub struct ExpandArguments {
    /// The scenario file, or the name of a preset
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    pub scenario: PathBuf,
    /// Set a key of the scenario; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    pub overrides: Vec<String>,
}

/// Prints a scenario after expansion.
pub fn expand(arguments: &ExpandArguments) -> Result<(), Failure> {
    print(&expanded(&arguments.scenario, &arguments.overrides)?)
}

/// A scenario after expansion; of a sweep its first case.
pub fn expanded(scenario: &Path, overrides: &[String]) -> Result<String, Failure> {
    let cases = case_set(scenario, overrides, &[])?;
    if cases.is_sweep() {
        tracing::warn!("this is a sweep; the first case is printed");
    }
    let loaded = match cases.search() {
        Some(search) => cases.searched_scenario(0, search.from)?,
        None => cases.scenario_of(0)?,
    };
    Ok(expanded_toml(&loaded))
}
