//! Completions that shells offer for the values of arguments: presets, topics, pages and keys.

use crate::guide::PAGES;
use crate::presets::{Preset, PresetKind};
use crate::reproduce::ARTIFACTS;
use clap_complete::engine::{
    ArgValueCandidates, ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter,
};
use rodlab_lab::experiment;
use serde_json::Value;
use std::ffi::OsStr;

/// Largest number of nested tables of scenario files.
const DEEPEST: usize = 5;

/// Presets of a kind, and paths of files.
pub fn presets(kind: PresetKind) -> ArgValueCompleter {
    ArgValueCompleter::new(move |typed: &OsStr| {
        let presets = Preset::of_kind(kind);
        let named = presets.map(|preset| candidate(preset.name, preset.title()));
        let mut all = starting_with(typed, named);
        all.extend(PathCompleter::file().complete(typed));
        all
    })
}

/// Names of presets of some kinds.
pub fn preset_names(kinds: &'static [PresetKind]) -> ArgValueCandidates {
    ArgValueCandidates::new(move || {
        let presets = kinds.iter().flat_map(|kind| Preset::of_kind(*kind));
        presets
            .map(|preset| candidate(preset.name, preset.title()))
            .collect()
    })
}

/// What `rodlab explain` explains: keys of scenario files, and files of results directories with
/// their columns.
pub fn explained() -> ArgValueCandidates {
    ArgValueCandidates::new(|| {
        let keys = scenario_keys().into_iter();
        let mut all: Vec<_> = keys.map(|(key, words)| candidate(&key, &words)).collect();
        for file in experiment::described_files() {
            let name = file.names[0];
            all.push(candidate(name, file.meaning));
            let stem = name.split('.').next().unwrap_or(name);
            for column in file.columns() {
                all.push(candidate(
                    &format!("{stem}.{}", column.name),
                    column.meaning,
                ));
            }
        }
        all
    })
}

/// Topics of the guide.
pub fn guide_topics() -> ArgValueCandidates {
    let pages = || PAGES.iter();
    ArgValueCandidates::new(move || {
        let topics = pages().map(|page| candidate(&page.topic(), page.title()));
        topics.collect()
    })
}

/// Pages that can be reproduced.
pub fn artifacts() -> ArgValueCandidates {
    ArgValueCandidates::new(|| {
        let names = ARTIFACTS.iter().map(|artifact| artifact.name());
        names.map(CompletionCandidate::new).collect()
    })
}

/// Keys of scenario files, each followed by an ending.
pub fn keys(ending: &'static str) -> ArgValueCandidates {
    ArgValueCandidates::new(move || {
        let keys = scenario_keys().into_iter();
        keys.map(|(key, words)| candidate(&(key + ending), &words))
            .collect()
    })
}

/// Keys of scenario files with their descriptions, tables before their keys.
pub fn scenario_keys() -> Vec<(String, String)> {
    let schema = experiment::json_schema();
    let mut keys = Vec::new();
    list_keys(&schema, &schema, "", &mut keys);
    keys
}

fn candidate(name: &str, words: &str) -> CompletionCandidate {
    CompletionCandidate::new(name).help(Some(words.to_owned().into()))
}

fn starting_with(
    typed: &OsStr,
    candidates: impl Iterator<Item = CompletionCandidate>,
) -> Vec<CompletionCandidate> {
    let typed = typed.to_string_lossy();
    let fits = |one: &CompletionCandidate| one.get_value().to_string_lossy().starts_with(&*typed);
    candidates.filter(fits).collect()
}

/// Adds the keys of a table of the schema with their descriptions, each key once.
fn list_keys(schema: &Value, table: &Value, prefix: &str, keys: &mut Vec<(String, String)>) {
    if prefix.split('.').count() > DEEPEST {
        return;
    }
    for (name, key) in table["properties"].as_object().into_iter().flatten() {
        let path = match prefix {
            "" => name.clone(),
            _ => format!("{prefix}.{name}"),
        };
        let words = key["description"].as_str().unwrap_or_default();
        if keys.iter().all(|(known, _)| *known != path) {
            keys.push((path.clone(), words.to_owned()));
        }
        list_keys(schema, key, &path, keys);
    }
    let reference = table["$ref"].as_str();
    let referred = reference.and_then(|path| schema.pointer(path.trim_start_matches('#')));
    let choices = ["anyOf", "oneOf", "allOf"].into_iter();
    let choices = choices.flat_map(|choice| table[choice].as_array().into_iter().flatten());
    for inner in choices.chain(referred).chain(table.get("items")) {
        list_keys(schema, inner, prefix, keys);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_that_is_offered_can_be_explained() {
        let keys = scenario_keys();
        assert!(keys.iter().any(|(key, _)| key == "time.step"));
        for (key, _) in keys {
            assert!(experiment::explain(&key).is_ok(), "{key}");
        }
    }
}
