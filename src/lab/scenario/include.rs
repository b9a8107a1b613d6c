//! `include`: files whose tables are added to a scenario.
//!
//! `extends` is for variants: the keys of a file replace those of the file that it extends,
//! including whole arrays. `include` is for parts: an included file only adds. Tables are merged,
//! existing keys are kept, and arrays of tables grow: first the tables of the file, then those of
//! the included files in order.

use super::document::{Entry, Node, Value};
use super::error::{Located, ScenarioError};
use super::issue::{Issue, KeyPath};
use super::source::Sources;

/// The key.
pub const INCLUDE: &str = "include";

/// The names of the included files, and their positions.
///
/// # Errors
/// The value is neither text nor a list of texts.
pub fn names<'a>(
    sources: &Sources,
    include: &'a Entry,
) -> Result<Vec<(&'a str, &'a Node)>, ScenarioError> {
    let nodes: Vec<&Node> = match &include.node.value {
        Value::Array(nodes) => nodes.iter().collect(),
        _ => vec![&include.node],
    };
    let name = |node: &'a Node| match &node.value {
        Value::String(name) => Ok((name.as_str(), node)),
        _ => {
            let found = node.description();
            let message = format!("expected the name of a file, or a list of them, found {found}");
            let issue = Issue::new(KeyPath::from(INCLUDE), message);
            let span = node.span.clone();
            Err(Located::new(sources, issue, Some(span)).into())
        }
    };
    nodes.into_iter().map(name).collect()
}

impl Node {
    /// Adds the contents of another tree: missing keys, and elements of arrays of tables.
    pub fn add(&mut self, other: Node) {
        let is_list_of_tables = |elements: &[Node]| {
            let mut elements = elements.iter();
            elements.all(|element| matches!(element.value, Value::Table(_)))
        };
        match (&mut self.value, other.value) {
            (Value::Table(entries), Value::Table(others)) => {
                for other in others {
                    match entries.iter_mut().find(|entry| entry.key == other.key) {
                        Some(entry) => entry.node.add(other.node),
                        None => entries.push(other),
                    }
                }
            }
            (Value::Array(elements), Value::Array(others))
                if is_list_of_tables(elements) && is_list_of_tables(&others) =>
            {
                elements.extend(others);
            }
            _ => {}
        }
    }
}
