//! Overrides from the command line: `--set key=value`.

use super::document::{self, Entry, Node, Value};
use super::error::{Located, ScenarioError};
use super::expansion::{PARAMETERS, SEED};
use super::include::INCLUDE;
use super::issue::{Issue, KeyPath, did_you_mean};
use super::source::{Sources, Span};
use std::path::Path;

/// Maximum number of steps of a dotted key; scenario files use up to six.
const MOST_STEPS: usize = 32;

/// Sets a dotted key of the document. The value is TOML, or else plain text: `rods.0.radius=5 mm`.
///
/// Missing tables on the path are created; elements of arrays must exist.
pub fn apply(sources: &mut Sources, document: &mut Node, text: &str) -> Result<(), ScenarioError> {
    let source = sources.add("--set".to_owned(), Some(text.into()), Path::new(""));
    let fault = |sources: &Sources, path: KeyPath, message: String, help: Option<String>| {
        let key_length = text.find('=').unwrap_or(text.len());
        let span = Span {
            source,
            bytes: 0..key_length,
        };
        let issue = Issue::new(path, message).with_help(help);
        ScenarioError::from(Located::new(sources, issue, Some(span)))
    };
    let Some((key, value)) = text.split_once('=') else {
        return Err(fault(
            sources,
            KeyPath::root(),
            "expected key=value".to_owned(),
            Some("for example --set rods.0.radius=\"5 mm\"".to_owned()),
        ));
    };
    let steps: Vec<&str> = key.trim().split('.').map(str::trim).collect();
    let path = KeyPath::from(key.trim());
    if steps.iter().any(|step| step.is_empty()) {
        let message = "expected keys joined by dots, such as time.end".to_owned();
        return Err(fault(sources, KeyPath::root(), message, None));
    }
    if ["extends", "unset", INCLUDE].contains(&steps[0]) {
        let message = "this key cannot be set from the command line".to_owned();
        return Err(fault(sources, path, message, None));
    }
    let key_span = Span {
        source,
        bytes: 0..key.len(),
    };
    let value = parse_value(source, key.len() + 1, value);
    assign(document, key.trim(), &key_span, value)
        .map_err(|(message, help)| fault(sources, path, message, help))
}

/// Sets a dotted key at `key_span`; on failure returns the fault and advice.
pub fn assign(
    document: &mut Node,
    key: &str,
    key_span: &Span,
    value: Node,
) -> Result<(), (String, Option<String>)> {
    let steps: Vec<&str> = key.split('.').map(str::trim).collect();
    if steps.len() > MOST_STEPS {
        let message = format!(
            "the key has {} steps; allowed: at most {MOST_STEPS}",
            steps.len()
        );
        return Err((message, None));
    }
    if let [PARAMETERS, name] = steps[..] {
        known_parameter(document, name)?;
    }
    set(document, &steps, key_span, value)
}

/// Rejects a parameter that the file does not have, since nothing would use it.
fn known_parameter(document: &Node, name: &str) -> Result<(), (String, Option<String>)> {
    let entries = match document.entry(PARAMETERS).map(|entry| &entry.node.value) {
        Some(Value::Table(entries)) => entries.as_slice(),
        _ => &[],
    };
    let names: Vec<&str> = entries.iter().map(|entry| entry.key.as_str()).collect();
    if name == SEED || names.contains(&name) {
        return Ok(());
    }
    let list = match names.as_slice() {
        [] => "the file has no [parameters]".to_owned(),
        names => format!("the parameters are: {}", names.join(", ")),
    };
    let help = did_you_mean(name, names).unwrap_or(list);
    Err((format!("there is no parameter `{name}`"), Some(help)))
}

/// Removes a dotted key; on failure returns the fault and advice.
pub fn remove(document: &mut Node, key: &str) -> Result<(), (String, Option<String>)> {
    let steps = numbered_steps(document, key);
    let absent = || (format!("there is no inherited key `{key}`"), None);
    let (last, way) = steps.split_last().ok_or_else(absent)?;
    let mut node = document;
    for step in way {
        node = match &mut node.value {
            Value::Table(entries) => {
                let entry = entries.iter_mut().find(|entry| entry.key == *step);
                &mut entry.ok_or_else(absent)?.node
            }
            Value::Array(elements) => {
                let index = find_element(elements, step)?;
                &mut elements[index]
            }
            _ => return Err(absent()),
        };
    }
    let names: Vec<String> = match &node.value {
        Value::Table(entries) => entries.iter().map(|entry| entry.key.clone()).collect(),
        _ => Vec::new(),
    };
    match node.remove(last) {
        Some(_) => Ok(()),
        None => Err((
            absent().0,
            did_you_mean(last, names.iter().map(String::as_str)),
        )),
    }
}

/// The steps of a dotted key, with names of elements of arrays replaced by indices. Steps that the
/// document does not have are unchanged.
pub fn numbered_steps(document: &Node, key: &str) -> Vec<String> {
    let mut node = Some(document);
    let step = |step: &str| {
        let (name, next) = match node.map(|node| &node.value) {
            Some(Value::Table(_)) => {
                let entry = node.and_then(|node| node.entry(step));
                (step.to_owned(), entry.map(|entry| &entry.node))
            }
            Some(Value::Array(elements)) => match find_element(elements, step) {
                Ok(index) => (index.to_string(), elements.get(index)),
                Err(_) => (step.to_owned(), None),
            },
            _ => (step.to_owned(), None),
        };
        node = next;
        name
    };
    key.split('.').map(str::trim).map(step).collect()
}

/// Reads the value as TOML, or else as plain text. `offset` is the start of the value in its
/// source.
pub fn parse_value(source: usize, offset: usize, text: &str) -> Node {
    const KEY: &str = "value = ";
    let parsed = document::parse(source, &format!("{KEY}{text}"))
        .ok()
        .and_then(|mut node| match &node.value {
            // More than one entry: the text contains further keys, so it is not a value.
            Value::Table(entries) if entries.len() == 1 => node.remove("value"),
            _ => None,
        });
    let mut node = parsed.map_or_else(
        || Node {
            value: Value::String(text.trim().to_owned()),
            span: Span {
                source,
                bytes: 0..0,
            },
        },
        |entry| entry.node,
    );
    // The marked range is the whole value, not only the faulty part.
    relabel(&mut node, &(offset..offset + text.len()));
    node
}

fn relabel(node: &mut Node, bytes: &std::ops::Range<usize>) {
    node.span.bytes = bytes.clone();
    match &mut node.value {
        Value::Array(elements) => {
            for element in elements {
                relabel(element, bytes);
            }
        }
        Value::Table(entries) => {
            for entry in entries {
                entry.key_span.bytes = bytes.clone();
                relabel(&mut entry.node, bytes);
            }
        }
        _ => {}
    }
}

/// Descends to the key and sets it; on failure returns the fault and advice.
fn set(
    node: &mut Node,
    steps: &[&str],
    key_span: &Span,
    value: Node,
) -> Result<(), (String, Option<String>)> {
    let Some((&step, rest)) = steps.split_first() else {
        *node = value;
        return Ok(());
    };
    match &mut node.value {
        Value::Table(entries) => {
            let index = entries.iter().position(|entry| entry.key == step);
            let index = index.unwrap_or_else(|| {
                entries.push(Entry {
                    key: step.to_owned(),
                    key_span: key_span.clone(),
                    node: Node {
                        value: Value::Table(Vec::new()),
                        span: key_span.clone(),
                    },
                });
                entries.len() - 1
            });
            if rest.is_empty() {
                entries[index].key_span = key_span.clone();
            }
            set(&mut entries[index].node, rest, key_span, value)
        }
        Value::Array(elements) => {
            let index = find_element(elements, step)?;
            set(&mut elements[index], rest, key_span, value)
        }
        _ => Err((
            format!(
                "there is no `{step}` here: {} has no keys",
                node.description()
            ),
            None,
        )),
    }
}

/// Finds an element of an array by its number or, among tables, by its name.
fn find_element(elements: &[Node], step: &str) -> Result<usize, (String, Option<String>)> {
    if let Ok(index) = step.parse::<usize>() {
        if index < elements.len() {
            return Ok(index);
        }
        let message = format!(
            "there is no element {index}; the array has {}",
            elements.len()
        );
        return Err((message, None));
    }
    let names: Vec<&str> = elements
        .iter()
        .filter_map(
            |element| match element.entry("name").map(|entry| &entry.node.value) {
                Some(Value::String(name)) => Some(name.as_str()),
                _ => None,
            },
        )
        .collect();
    let named = |element: &Node| {
        matches!(element.entry("name").map(|entry| &entry.node.value),
            Some(Value::String(name)) if name == step)
    };
    elements.iter().position(named).ok_or_else(|| {
        (
            format!("no element is called `{step}`"),
            did_you_mean(step, names),
        )
    })
}
