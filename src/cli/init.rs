//! `rodlab init`.

use super::candidates::preset_names;
use super::expand::expanded;
use super::prelude::*;
use super::preset_file::preset_file;
use super::presets::found;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use rodlab_lab::experiment::{KINDS, Kind, kind_named};

/// Arguments of `rodlab init`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab init scene > my_scene.toml && rodlab run my_scene.toml
  rodlab init scene --like net > my_net.toml
  rodlab init rod --like rope > my_rod.toml      `rodlab presets rod` lists the rods")]
pub struct InitArguments {
    /// Experiment for which to write a template, or other kind of file
    #[arg(value_name = "KIND", value_parser = beginnings())]
    beginning: Beginning,
    /// Write the preset of this name instead [default for cells, rods and papers: the preset used
    /// in the guide]
    #[arg(long, value_name = "NAME", add = preset_names(&LIKE))]
    like: Option<String>,
}

/// Contents of a new file.
#[derive(Clone, Copy, Debug)]
enum Beginning {
    Experiment(&'static dyn Kind),
    /// Another kind of file, with the name of its default preset.
    Preset(PresetKind, &'static str),
}

/// Kinds of files other than scenarios, with their contents.
const OTHERS: [(PresetKind, &str, &str); 3] = [
    (
        PresetKind::Cell,
        "gantry",
        "a robot cell: arms, axes, table, camera",
    ),
    (
        PresetKind::Rod,
        "green_vps",
        "a rod to lay: stiffness, radius, length",
    ),
    (PresetKind::Paper, "a4", "a paper to fold"),
];

/// Kinds of presets that can be written.
const LIKE: [PresetKind; 4] = [
    PresetKind::Scenario,
    PresetKind::Rod,
    PresetKind::Paper,
    PresetKind::Cell,
];

/// Reads the name of a kind of experiment, or of a kind of presets.
fn beginnings() -> impl TypedValueParser<Value = Beginning> {
    let experiments = KINDS
        .iter()
        .map(|kind| PossibleValue::new(kind.name()).help(kind.summary().trim_end_matches('.')));
    let others = OTHERS.map(|(kind, _, what)| PossibleValue::new(kind.name()).help(what));
    PossibleValuesParser::new(experiments.chain(others)).map(|name| {
        let other = OTHERS.iter().find(|(kind, ..)| kind.name() == name);
        match other {
            Some((kind, usual, _)) => Beginning::Preset(*kind, usual),
            None => {
                Beginning::Experiment(kind_named(&name).expect("only names of kinds are taken"))
            }
        }
    })
}

/// Writes a template or a preset.
pub fn init(arguments: &InitArguments) -> Result<(), Failure> {
    let like = arguments.like.as_deref();
    match (arguments.beginning, like) {
        (Beginning::Experiment(kind), None) => print(kind.template()),
        (Beginning::Experiment(kind), Some(name)) => {
            let preset = found(name, Some(PresetKind::Scenario))?;
            let text = if stated(preset.text, "extends").is_some() {
                let file = preset_file(PresetKind::Scenario, name)?;
                let whole = expanded(&file, &[], 1)?;
                format!("# The preset `{name}` with the keys of the file that it extends.\n{whole}")
            } else {
                preset.text.to_owned()
            };
            match stated(&text, "experiment") {
                Some(experiment) if experiment != kind.name() => Err(Failure::Input(format!(
                    "`{name}` belongs to the experiment `{experiment}`; use `rodlab init {experiment} --like {name}`"
                ))),
                _ => print(&text),
            }
        }
        (Beginning::Preset(kind, usual), _) => {
            print(found(like.unwrap_or(usual), Some(kind))?.text)
        }
    }
}

/// The value of a key at the top of a scenario, as text.
fn stated<'a>(scenario: &'a str, key: &str) -> Option<&'a str> {
    let value = |line: &'a str| line.strip_prefix(key)?.trim_start().strip_prefix('=');
    let value = scenario.lines().find_map(value)?;
    Some(value.trim().trim_matches('"'))
}
