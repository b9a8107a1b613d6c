//! The list of errors that `scripts/planted-faults` plants fits the sources.

use std::fs;
use std::path::Path;

#[derive(serde::Deserialize)]
struct List {
    faults: Vec<Fault>,
}

#[derive(serde::Deserialize)]
struct Fault {
    what: String,
    file: String,
    old: String,
    new: String,
}

#[test]
fn each_expression_to_replace_occurs_once() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let list = fs::read_to_string(root.join("scripts/planted-faults.toml")).unwrap();
    let list: List = toml::from_str(&list).unwrap();
    assert!(list.faults.len() > 100);
    let stale = list.faults.iter().filter_map(|fault| {
        let source = fs::read_to_string(root.join(&fault.file)).unwrap_or_default();
        let count = source.matches(&fault.old).count();
        (count != 1 || fault.old == fault.new).then(|| {
            format!(
                "{}: `{}` occurs {count} times in {}",
                fault.what, fault.old, fault.file
            )
        })
    });
    let stale: Vec<String> = stale.collect();
    assert!(stale.is_empty(), "{}", stale.join("\n"));
}
