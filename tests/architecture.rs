//! Imports run in one direction: every room imports only the rooms that the plan of the house allows.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms of the crate and what each may import beside itself.
const ROOMS: [(&str, &[&str]); 10] = [
    (
        "cli",
        &[
            "experiment",
            "knot",
            "mechanics",
            "scenario",
            "results",
            "figure",
            "cluster",
            "vision",
        ],
    ),
    (
        "experiment",
        &["knot", "mechanics", "scenario", "results", "figure"],
    ),
    ("knot", &["mechanics"]),
    ("mechanics", &["linalg"]),
    ("linalg", &[]),
    ("scenario", &[]),
    ("results", &[]),
    ("figure", &[]),
    ("cluster", &[]),
    ("vision", &["figure"]),
];

/// Rooms inside `mechanics` and what each may import beside itself.
const MECHANICS: [(&str, &[&str]); 8] = [
    ("rod", &[]),
    ("contact", &[]),
    ("fluid", &[]),
    ("kirchhoff", &[]),
    ("scene", &["contact", "fluid"]),
    ("system", &["rod", "contact", "scene"]),
    ("statics", &["rod", "system"]),
    (
        "dynamics",
        &["rod", "contact", "fluid", "scene", "system", "statics"],
    ),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a source folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// First component of a path below `folder`, without its extension.
fn room_of(path: &Path, folder: &Path) -> String {
    let below = path.strip_prefix(folder).expect("a path below the folder");
    let first = below.components().next().expect("a component");
    first
        .as_os_str()
        .to_string_lossy()
        .trim_end_matches(".rs")
        .into()
}

/// Code without comments and without tests, which may look anywhere.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("readable source");
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

/// Names that follow `prefix` in `code`, those of a group in braces too.
fn imported(code: &str, prefix: &str) -> Vec<String> {
    let name = |text: &str| -> String {
        text.chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    let mut names = Vec::new();
    for (start, _) in code.match_indices(prefix) {
        let rest = &code[start + prefix.len()..];
        if let Some(group) = rest.strip_prefix('{') {
            let mut depth = 0;
            let mut item = String::new();
            for character in group.chars() {
                match character {
                    '}' if depth == 0 => break,
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    ',' if depth == 0 => {
                        names.push(name(item.trim()));
                        item.clear();
                        continue;
                    }
                    _ => {}
                }
                item.push(character);
            }
            names.push(name(item.trim()));
        } else {
            names.push(name(rest));
        }
    }
    names
}

fn check(folder: &Path, prefixes: &[&str], table: &[(&str, &[&str])]) -> Vec<String> {
    let allowed: BTreeMap<&str, &[&str]> = table.iter().copied().collect();
    let mut faults = Vec::new();
    for path in sources(folder) {
        let room = room_of(&path, folder);
        let Some(may_import) = allowed.get(room.as_str()) else {
            continue;
        };
        let code = code(&path);
        for name in prefixes.iter().flat_map(|prefix| imported(&code, prefix)) {
            let is_room = allowed.contains_key(name.as_str());
            if is_room && name != room && !may_import.contains(&name.as_str()) {
                faults.push(format!("{} imports {name}", path.display()));
            }
        }
    }
    faults
}

#[test]
fn rooms_import_only_what_the_plan_allows() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let faults = check(&source, &["crate::"], &ROOMS);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn rooms_of_mechanics_import_only_what_the_plan_allows() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/mechanics");
    let faults = check(&source, &["crate::mechanics::", "use super::"], &MECHANICS);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn a_forbidden_import_is_noticed() {
    let code = "use crate::mechanics::{Vector3, contact::{A, B}, fluid};\nuse crate::linalg::X;";
    assert_eq!(
        imported(code, "crate::mechanics::"),
        ["Vector3", "contact", "fluid"]
    );
    assert_eq!(imported(code, "crate::"), ["mechanics", "linalg"]);
}
