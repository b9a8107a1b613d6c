//! Arguments that are files or names of presets.

use super::failure::Failure;
use crate::presets::{Preset, PresetKind};
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Messages about presets that replaced missing files. They are logged after logging has started.
static SUBSTITUTES: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Reads a path, or the name of a preset of a kind. An existing file takes precedence over a
/// preset with the same name.
pub fn file_or_preset(kind: PresetKind) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| resolve(kind, path))
}

/// [`file_or_preset`] for a scenario or a cell. The path of a missing file is kept: it is reported
/// with the faults of the other files.
pub fn scenario_or_cell() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path: PathBuf| {
        let kind = match Preset::in_place_of(PresetKind::Cell, &path) {
            Some(_) => PresetKind::Cell,
            None => PresetKind::Scenario,
        };
        match path.extension().is_some() && Preset::in_place_of(kind, &path).is_none() {
            true => Ok(path),
            false => resolve(kind, path),
        }
    })
}

/// The file of a preset that the program itself names.
pub fn preset_file(kind: PresetKind, name: &str) -> Result<PathBuf, Failure> {
    let preset = Preset::named(kind, name).expect("a preset of the program");
    preset.file().map_err(Failure::system)
}

/// A pattern: a formula, a file, or the name of a preset.
#[derive(Clone, Debug)]
pub struct GivenPattern {
    /// The argument as given.
    pub name: String,
    /// The formula, or the path of the file.
    pub source: String,
}

/// [`file_or_preset`] for a pattern, which may be a formula, too.
pub fn pattern_or_preset(text: &str) -> Result<GivenPattern, Box<dyn Error + Send + Sync>> {
    let file = resolve(PresetKind::Pattern, PathBuf::from(text))?;
    Ok(GivenPattern {
        name: text.to_owned(),
        source: file.to_string_lossy().into_owned(),
    })
}

/// Logs which presets replaced missing files.
pub fn log_substitutes() {
    let mut lines = SUBSTITUTES
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    for line in lines.drain(..) {
        tracing::warn!("{line}");
    }
}

/// The file at a path, or that of the preset with this name.
pub fn resolve(kind: PresetKind, path: PathBuf) -> Result<PathBuf, Box<dyn Error + Send + Sync>> {
    let preset = Preset::in_place_of(kind, &path);
    // A folder with the name of a preset, such as a results directory, is ignored.
    if path.is_file() || path.exists() && preset.is_none() {
        return Ok(path);
    }
    let Some(preset) = preset else {
        return match advice(kind, &path) {
            Some(advice) => Err(advice.into()),
            None => Ok(path),
        };
    };
    let file = preset.file()?;
    if path.as_os_str() != preset.name {
        let line = format!(
            "{} does not exist: using the preset `{}`",
            path.display(),
            preset.name
        );
        SUBSTITUTES
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
            .push(line);
    }
    Ok(file)
}

/// Message about a path without a file that is not the name of a preset; `None` for a formula, and
/// for standard input.
fn advice(kind: PresetKind, path: &Path) -> Option<String> {
    let typed = path.to_str()?;
    if typed.is_empty() || typed == "-" || typed.contains(':') {
        return None;
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let is_bare = path.components().count() == 1;
    let other = PresetKind::ALL
        .into_iter()
        .find(|other| *other != kind && is_bare && Preset::named(*other, &stem).is_some());
    let found = match (other, nearest_preset(kind, &stem)) {
        (Some(other), _) => format!("there is no such file, and `{stem}` is a {other} preset"),
        (None, Some(name)) => {
            format!("there is no such file; the most similar {kind} preset is `{name}`")
        }
        (None, None) => {
            let files = match kind {
                PresetKind::Pattern => ".svg or .csv",
                _ => kind.ending(),
            };
            format!("there is no such {files} file, and no {kind} preset of this name")
        }
    };
    Some(format!("{found}; `rodlab presets {kind}` lists them"))
}

/// The preset of a kind whose name is similar to a given one.
pub fn nearest_preset(kind: PresetKind, typed: &str) -> Option<&'static str> {
    Preset::of_kind(kind)
        .map(|preset| (strsim::jaro_winkler(typed, preset.name), preset.name))
        .filter(|(similarity, _)| *similarity > 0.85)
        .max_by(|one, other| one.0.total_cmp(&other.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_goes_before_a_preset() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rope.toml");
        std::fs::write(&file, "").unwrap();
        assert_eq!(resolve(PresetKind::Rod, file.clone()).unwrap(), file);
    }

    #[test]
    fn a_path_without_a_file_is_rejected_with_the_similar_preset_or_the_list() {
        for (kind, path, expected) in [
            (PresetKind::Rod, "gren_vps", "`green_vps`"),
            (PresetKind::Rod, "elsewhere/gren_vps", "`green_vps`"),
            (PresetKind::Rod, "a4", "`a4` is a paper preset"),
            (PresetKind::Rod, "no_such_thing", "no rod preset"),
            (
                PresetKind::Scenario,
                "sub/flagella_quick",
                "`flagella_quick`",
            ),
            (PresetKind::Scenario, "nope.toml", "no scenario preset"),
            (PresetKind::Pattern, "B", "no pattern preset"),
            (PresetKind::Pattern, "own/b.svg", "no pattern preset"),
        ] {
            let error = resolve(kind, path.into()).unwrap_err().to_string();
            let list = format!("`rodlab presets {kind}` lists them");
            assert!(
                error.contains(expected) && error.contains(&list),
                "{path}: {error}"
            );
        }
        for path in ["line:0.3", "-", ""] {
            assert_eq!(
                resolve(PresetKind::Pattern, path.into()).unwrap(),
                Path::new(path)
            );
        }
    }
}
