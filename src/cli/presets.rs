//! `rodlab presets`.

use super::candidates::preset_names;
use super::prelude::*;
use super::preset_file::nearest_preset;
use crate::presets::{Preset, PresetKind};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Arguments of `rodlab presets`.
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  rodlab presets                          all presets, a line each
  rodlab presets rod                      the rods
  rodlab presets show green_vps > my_rod.toml
  rodlab run flagella_quick               a preset by its name

The name of a preset can be given wherever a file of its kind is expected. An existing file of that
name takes precedence."
)]
pub struct PresetsArguments {
    #[command(subcommand)]
    action: Option<PresetsAction>,
    /// List only presets of this kind
    #[arg(value_parser = kinds())]
    kind: Option<PresetKind>,
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum PresetsAction {
    /// Print a preset
    Show {
        /// Name of the preset
        #[arg(add = preset_names(&PresetKind::ALL))]
        name: String,
        /// Kind of the preset, if presets of several kinds have that name
        #[arg(long, value_parser = kinds())]
        kind: Option<PresetKind>,
    },
}

/// Reads a kind of presets.
pub fn kinds() -> impl TypedValueParser<Value = PresetKind> {
    let names = PresetKind::ALL.map(|kind| PossibleValue::new(kind.name()));
    PossibleValuesParser::new(names).map(|name| {
        let kind = PresetKind::ALL.into_iter().find(|kind| kind.name() == name);
        kind.expect("only names of kinds are taken")
    })
}

#[derive(Serialize)]
struct Row {
    kind: &'static str,
    name: &'static str,
    title: &'static str,
}

/// Lists presets, or prints one.
pub fn presets(arguments: &PresetsArguments) -> Result<(), Failure> {
    if let Some(PresetsAction::Show { name, kind }) = &arguments.action {
        return print(found(name, *kind)?.text);
    }
    let wanted = |preset: &Preset| arguments.kind.is_none_or(|kind| preset.kind == kind);
    let presets: Vec<_> = Preset::all().filter(wanted).collect();
    if arguments.json {
        let rows = presets.iter().map(|preset| Row {
            kind: preset.kind.name(),
            name: preset.name,
            title: preset.title(),
        });
        return print_json(&rows.collect::<Vec<_>>());
    }
    let width = presets
        .iter()
        .map(|preset| preset.name.len())
        .max()
        .unwrap_or(0);
    let lines = presets.iter().map(|preset| {
        let kind = preset.kind.name();
        format!("{kind:<8}  {:<width$}  {}\n", preset.name, preset.title())
    });
    print(&lines.collect::<String>())
}

/// Message about a name that no preset has.
fn unknown(name: &str, kind: Option<PresetKind>) -> String {
    let of = kind.map_or(String::new(), |kind| format!("{kind} "));
    let mut kinds = match kind {
        Some(ref kind) => std::slice::from_ref(kind).iter(),
        None => PresetKind::ALL.iter(),
    };
    let meant = kinds
        .find_map(|kind| nearest_preset(*kind, name))
        .map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    let list = of.trim_end();
    let space = if list.is_empty() { "" } else { " " };
    format!("no {of}preset is called `{name}`{meant}; `rodlab presets{space}{list}` lists them")
}

/// The preset with a name, and with a kind if it is given.
pub fn found(name: &str, kind: Option<PresetKind>) -> Result<Preset, Failure> {
    let is_meant =
        |preset: &Preset| preset.name == name && kind.is_none_or(|kind| kind == preset.kind);
    let all: Vec<_> = Preset::all().filter(is_meant).collect();
    match all[..] {
        [preset] => Ok(preset),
        [] => Err(Failure::Input(unknown(name, kind))),
        _ => {
            let kinds: Vec<_> = all.iter().map(|preset| preset.kind.name()).collect();
            Err(Failure::Input(format!(
                "several presets are called `{name}`; choose one by --kind: {}",
                kinds.join(", ")
            )))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_name_is_rejected_with_the_similar_one_or_the_list() {
        let error = |name, kind| found(name, kind).unwrap_err().in_words(false);
        let misspelt = error("flagela_quick", None);
        assert!(misspelt.contains("`flagella_quick`"), "{misspelt}");
        let of_kind = error("pendulum", Some(PresetKind::Scenario));
        assert!(of_kind.contains("no scenario preset is called `pendulum`"));
        assert!(of_kind.contains("`rodlab presets scenario` lists them"));
        assert!(error("nope", None).ends_with("`rodlab presets` lists them\n"));
    }
}
