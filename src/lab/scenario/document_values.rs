//! Converts TOML values in memory, without text, to the tree of a document and back.

use super::document::{Entry, Node, Value};
use super::issue::{Issue, KeyPath};
use super::source::Span;

/// Maximum nesting depth of arrays and tables, as in TOML text.
const MOST_LEVELS: usize = 80;

/// The tree of a table. Keys and values are numbered in its order, so that each has its own
/// position.
///
/// # Errors
/// A value that is nested more deeply than TOML text allows.
pub fn from_table(source: usize, table: toml::Table) -> Result<Node, Issue> {
    let mut numbering = Numbering { source, next: 0 };
    numbering.node(toml::Value::Table(table), &KeyPath::root())
}

struct Numbering {
    source: usize,
    next: usize,
}

impl Numbering {
    fn place(&mut self) -> Span {
        let number = self.next;
        self.next += 1;
        Span {
            source: self.source,
            bytes: number..number,
        }
    }

    fn node(&mut self, value: toml::Value, path: &KeyPath) -> Result<Node, Issue> {
        if path.steps().len() > MOST_LEVELS {
            let message = format!(
                "arrays and tables are nested more than {MOST_LEVELS} deep; allowed: at most that"
            );
            return Err(Issue::new(path.clone(), message));
        }
        let span = self.place();
        let value = match value {
            toml::Value::Boolean(boolean) => Value::Boolean(boolean),
            toml::Value::Integer(integer) => Value::Integer(integer),
            toml::Value::Float(float) => Value::Float(float),
            toml::Value::String(text) => Value::String(text),
            toml::Value::Datetime(_) => Value::Datetime,
            toml::Value::Array(elements) => {
                let elements = elements.into_iter().enumerate();
                let node = |(index, element)| self.node(element, &path.index(index));
                Value::Array(elements.map(node).collect::<Result<_, _>>()?)
            }
            toml::Value::Table(table) => {
                let entry = |(key, value)| self.entry(key, value, path);
                Value::Table(table.into_iter().map(entry).collect::<Result<_, _>>()?)
            }
        };
        Ok(Node { value, span })
    }

    fn entry(&mut self, key: String, value: toml::Value, path: &KeyPath) -> Result<Entry, Issue> {
        let key_span = self.place();
        let node = self.node(value, &path.key(&key))?;
        Ok(Entry {
            key,
            key_span,
            node,
        })
    }
}

/// A whole document as TOML.
pub fn document(root: &Node) -> String {
    toml::to_string(&converted(&root.value)).expect("a tree of TOML values is TOML")
}

/// A value in one line.
pub fn inline(value: &Value) -> String {
    converted(value).to_string()
}

/// Converts a value of the tree. Only dates are lost; scenarios have none.
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
