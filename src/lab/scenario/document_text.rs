//! From the tree of a document back to TOML; only dates are lost, which no scenario has.

use super::document::{Node, Value};

/// A whole document as TOML.
pub fn document(root: &Node) -> String {
    toml::to_string(&converted(&root.value)).expect("a tree of TOML values is TOML")
}

/// A value in one line.
pub fn inline(value: &Value) -> String {
    converted(value).to_string()
}

fn converted(value: &Value) -> toml::Value {
    match value {
        Value::Boolean(boolean) => toml::Value::Boolean(*boolean),
        Value::Integer(integer) => toml::Value::Integer(*integer),
        Value::Float(float) => toml::Value::Float(*float),
        Value::String(text) => toml::Value::String(text.clone()),
        Value::Datetime => toml::Value::String(String::new()),
        Value::Array(elements) => {
            toml::Value::Array(elements.iter().map(|node| converted(&node.value)).collect())
        }
        Value::Table(entries) => toml::Value::Table(
            entries
                .iter()
                .map(|entry| (entry.key.clone(), converted(&entry.node.value)))
                .collect(),
        ),
    }
}
