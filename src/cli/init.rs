//! `rodlab init`.

use super::prelude::*;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use rodlab_lab::experiment::{KINDS, Kind, kind_named};

/// Arguments of `rodlab init`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  rodlab init scene > my_scene.toml && rodlab run my_scene.toml")]
pub struct InitArguments {
    /// The experiment for which to write a template
    #[arg(value_parser = kinds())]
    pub experiment: &'static dyn Kind,
}

/// Reads the name of a kind of experiment.
fn kinds() -> impl TypedValueParser<Value = &'static dyn Kind> {
    let values = KINDS
        .iter()
        .map(|kind| PossibleValue::new(kind.name()).help(kind.summary().trim_end_matches('.')));
    PossibleValuesParser::new(values)
        .map(|name| kind_named(&name).expect("only names of kinds are taken"))
}

/// Writes a template.
pub fn init(arguments: &InitArguments) -> Result<(), Failure> {
    print(arguments.experiment.template())
}
