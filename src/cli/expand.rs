//! `rodlab expand`.

use super::candidates::keys;
use super::prelude::*;
use rodlab_lab::experiment::{case_set, expanded_toml};

/// Arguments of `rodlab expand`.
#[derive(Debug, Args)]
#[command(after_help = "\
Parameters, expressions and copies become numbers and tables; files that are extended or included
are merged. A run of the output gives the same bytes. Names of files in it are absolute. For a sweep
one case is printed, with a comment that names it.

Examples:
  rodlab expand pile
  rodlab expand cantilever_sweep --case 12
  rodlab expand scenarios/pile.toml --set rods.0.count=3 > three.toml")]
pub struct ExpandArguments {
    /// The scenario file, or the name of a preset
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    pub scenario: PathBuf,
    /// Set a key of the scenario; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    pub overrides: Vec<String>,
    /// Number of the case of a sweep, from 1
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u64).range(1..))]
    pub case: u64,
}

/// Prints a scenario after expansion.
pub fn expand(arguments: &ExpandArguments) -> Result<(), Failure> {
    let (scenario, overrides) = (&arguments.scenario, &arguments.overrides);
    print(&expanded(scenario, overrides, arguments.case)?)
}

/// A scenario after expansion. For a sweep, it is the case with the given number, counted from 1,
/// after a comment that names the case.
///
/// # Errors
/// The scenario is invalid, or the number exceeds that of the last case.
pub fn expanded(scenario: &Path, overrides: &[String], case: u64) -> Result<String, Failure> {
    let cases = case_set(scenario, overrides, &[])?;
    let count = cases.count();
    if u128::from(case) > count {
        let message = match cases.is_sweep() {
            true => format!("--case {case}: the sweep has {count} cases"),
            false => format!("--case {case}: this is not a sweep, and has one case"),
        };
        return Err(Failure::Input(message));
    }
    let index = usize::try_from(case - 1).map_err(|error| Failure::Input(error.to_string()))?;
    let (loaded, values) = match cases.search() {
        Some(search) => (
            cases.searched_scenario(index, search.from)?,
            cases.searched_case(index, search.from),
        ),
        None => (cases.scenario_of(index)?, cases.case(index)),
    };
    let expanded = expanded_toml(&loaded);
    if !cases.is_sweep() {
        return Ok(expanded);
    }
    let values = values.parameters.iter();
    let values: Vec<String> = values
        .map(|value| format!("{} = {}", value.key, value.typed))
        .collect();
    let values = values.join(", ");
    Ok(format!(
        "# Case {case} of {count} of the sweep: {values}\n{expanded}"
    ))
}
