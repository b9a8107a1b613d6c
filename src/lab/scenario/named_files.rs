//! Input files of scenarios, and the names of their copies.
//!
//! A sweep's directory holds copies of all input files in a folder, so that its scenario runs
//! without changes. Ids and tables name a file without that folder and without a leading path
//! (`..`, `/`). The scenario and its copy therefore have the same case ids.

use crate::scenario::document::{Node, Value};
use std::path::{Component, Path};

/// Folder of the copies in the directory of a sweep.
pub const INPUTS: &str = "inputs";

/// Keys that name files in any table.
const FILE_KEYS: [&str; 4] = ["file", "follow", "points_file", "rods_file"];

/// The name of a file in ids and tables, and of its copy in [`INPUTS`].
pub fn label(name: &str) -> String {
    let parts: Vec<&str> = Path::new(name)
        .components()
        .filter_map(|part| match part {
            Component::Normal(part) => part.to_str(),
            _ => None,
        })
        .collect();
    match parts.as_slice() {
        [INPUTS, below @ ..] if !below.is_empty() => below.join("/"),
        _ => parts.join("/"),
    }
}

/// Calls `visit` for every value at or below `node` that names a file. `path` is the path of
/// `node`. `curve_of` returns the further key of a top-level table that names a file.
///
/// # Errors
/// The first error of `visit`.
pub fn for_each<E>(
    node: &mut Node,
    path: &mut Vec<String>,
    curve_of: &dyn Fn(&str) -> Option<&'static str>,
    visit: &mut dyn FnMut(&mut Node) -> Result<(), E>,
) -> Result<(), E> {
    match &mut node.value {
        Value::Table(entries) => {
            for entry in entries {
                path.push(entry.key.clone());
                for_each(&mut entry.node, path, curve_of, visit)?;
                path.pop();
            }
            Ok(())
        }
        Value::Array(elements) => {
            for (index, element) in elements.iter_mut().enumerate() {
                path.push(index.to_string());
                for_each(element, path, curve_of, visit)?;
                path.pop();
            }
            Ok(())
        }
        Value::String(_) if names_a_file(path, curve_of) => visit(node),
        _ => Ok(()),
    }
}

fn names_a_file(path: &[String], curve_of: &dyn Fn(&str) -> Option<&'static str>) -> bool {
    match path {
        [table, key] if curve_of(table) == Some(key) => true,
        [table, key] if table == "start" && key == "from" => true,
        [.., key] => FILE_KEYS.contains(&key.as_str()),
        [] => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn labels_lead_nowhere_else() {
        assert_eq!(label("c1.csv"), "c1.csv");
        assert_eq!(label("curves/./c1.csv"), "curves/c1.csv");
        assert_eq!(label("../../data/c1.csv"), "data/c1.csv");
        assert_eq!(label("/data/c1.csv"), "data/c1.csv");
        assert_eq!(label("inputs/c1.csv"), "c1.csv");
        assert_eq!(label("inputs"), "inputs");
    }

    #[test]
    fn every_key_of_the_schema_that_names_a_file_is_known() {
        let schema = crate::experiment::json_schema().to_string();
        for key in ["points_file", "rods_file", "file", "follow"] {
            assert!(schema.contains(&format!("\"{key}\":")), "{key}");
        }
        let mut keys: Vec<&str> = schema
            .split('"')
            .filter(|word| word.ends_with("_file"))
            .collect();
        keys.dedup();
        for key in keys {
            let path = ["networks", "0", key].map(str::to_owned);
            assert!(names_a_file(&path, &|_| None), "{key}");
        }
    }

    proptest! {
        #[test]
        fn a_copy_has_the_label_of_its_original(name in "[./a-z]{1,20}") {
            let label = label(&name);
            // Names without a final component name directories, which are not input.
            prop_assume!(!label.is_empty());
            prop_assert_eq!(super::label(&format!("{INPUTS}/{label}")), label.clone());
            prop_assert!(!label.starts_with('/') && !label.split('/').any(|part| part == ".."));
        }
    }
}
