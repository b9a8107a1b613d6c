//! A scenario with the files that it extends and includes, and with overrides from the command line.

use super::document::{self, Entry, Node, Value};
use super::document_values;
use super::error::{Located, ScenarioError};
use super::include::{self, INCLUDE};
use super::input_file::{self, LARGEST_TEXT};
use super::issue::{Issue, KeyPath};
use super::overrides;
use super::source::{Sources, Span};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maximum length of a chain of files that extend or include each other.
const MOST_ANCESTORS: usize = 64;

/// A scenario file, merged with the files that it extends and includes and with overrides.
pub fn merged(path: &Path, overrides: &[String]) -> Result<(Sources, Node), ScenarioError> {
    let mut sources = Sources::default();
    let mut ancestors = Vec::new();
    let document = read(&mut sources, &mut ancestors, path)?;
    overridden(sources, document, overrides)
}

fn overridden(
    mut sources: Sources,
    mut document: Node,
    overrides: &[String],
) -> Result<(Sources, Node), ScenarioError> {
    for text in overrides {
        overrides::apply(&mut sources, &mut document, text)?;
    }
    Ok((sources, document))
}

/// [`merged`] for the text of a scenario.
pub fn merged_text(
    name: &str,
    text: &str,
    directory: &Path,
    overrides: &[String],
) -> Result<(Sources, Node), ScenarioError> {
    let mut sources = Sources::default();
    let parsed = parse(&mut sources, format!("{name}.toml"), text.into(), directory)?;
    let document = extend(&mut sources, &mut Vec::new(), parsed)?;
    overridden(sources, document, overrides)
}

/// [`merged`] for a table in memory.
pub fn merged_table(
    name: &str,
    table: toml::Table,
    directory: &Path,
    overrides: &[String],
) -> Result<(Sources, Node), ScenarioError> {
    let mut sources = Sources::default();
    let source = sources.add(name.to_owned(), None, directory);
    let document = document_values::from_table(source, table).map_err(|issue| {
        let span = Span {
            source,
            bytes: 0..0,
        };
        Located::new(&sources, issue, Some(span))
    })?;
    let document = extend(&mut sources, &mut Vec::new(), document)?;
    overridden(sources, document, overrides)
}

/// Reads a file and the files that it extends and includes. `ancestors` is the chain of files that
/// refer to this one.
fn read(
    sources: &mut Sources,
    ancestors: &mut Vec<PathBuf>,
    path: &Path,
) -> Result<Node, ScenarioError> {
    let unreadable = |error: &dyn std::fmt::Display| {
        let issue = Issue::new(
            KeyPath::root(),
            format!("{} cannot be read: {error}", path.display()),
        );
        ScenarioError::from(Located::new(&Sources::default(), issue, None))
    };
    let bytes = input_file::read(path, LARGEST_TEXT).map_err(|message| {
        let issue = Issue::new(KeyPath::root(), message);
        ScenarioError::from(Located::new(&Sources::default(), issue, None))
    })?;
    let text = String::from_utf8(bytes).map_err(|error| unreadable(&error))?;
    let canonical = path.canonicalize().map_err(|error| unreadable(&error))?;
    let directory = path.parent().unwrap_or(Path::new("")).to_owned();
    let name = path.display().to_string();
    let parsed = parse(sources, name, text.into(), &directory)?;
    ancestors.push(canonical);
    let node = extend(sources, ancestors, parsed)?;
    ancestors.pop();
    Ok(node)
}

/// Parses a text and adds it to the sources.
fn parse(
    sources: &mut Sources,
    name: String,
    text: Arc<str>,
    directory: &Path,
) -> Result<Node, ScenarioError> {
    let source = sources.add(name, Some(text.clone()), directory);
    document::parse(source, &text).map_err(|errors| {
        let located = errors.into_iter().map(|error| {
            let span = Span {
                source,
                bytes: error.bytes,
            };
            let message = format!("not TOML: {}", error.message);
            Located::new(sources, Issue::new(KeyPath::root(), message), Some(span))
        });
        ScenarioError(located.collect())
    })
}

/// The top of a source, with the files that it extends and includes.
fn extend(
    sources: &mut Sources,
    ancestors: &mut Vec<PathBuf>,
    mut node: Node,
) -> Result<Node, ScenarioError> {
    let directory = sources.get(node.span.source).directory.clone();
    let unset = node.remove("unset");
    let includes = node.remove(INCLUDE);
    let mut merged = match node.entry("extends") {
        Some(entry) => {
            let base = text_of(sources, entry)?;
            let path = directory.join(base);
            let mut merged = read_beside(sources, ancestors, entry, &entry.node, &path)?;
            if let Some(unset) = unset {
                forget(sources, &mut merged, &unset)?;
            }
            merged.merge(node);
            merged
        }
        None => match unset {
            Some(unset) => {
                let message =
                    "nothing is inherited here; this key is allowed only beside `extends`";
                let issue = Issue::new(KeyPath::from("unset"), message);
                return Err(Located::new(sources, issue, Some(unset.key_span)).into());
            }
            None => node,
        },
    };
    if let Some(includes) = includes {
        for (name, node) in include::names(sources, &includes)? {
            let path = directory.join(name);
            merged.add(read_beside(sources, ancestors, &includes, node, &path)?);
        }
    }
    Ok(merged)
}

fn text_of<'a>(sources: &Sources, entry: &'a Entry) -> Result<&'a str, ScenarioError> {
    match &entry.node.value {
        Value::String(text) => Ok(text),
        _ => {
            let found = entry.node.description();
            let message = format!("expected the name of a file, found {found}");
            let issue = Issue::new(KeyPath::from(entry.key.as_str()), message);
            Err(Located::new(sources, issue, Some(entry.node.span.clone())).into())
        }
    }
}

/// Reads a file named by the value `node` of a key.
fn read_beside(
    sources: &mut Sources,
    ancestors: &mut Vec<PathBuf>,
    key: &Entry,
    node: &Node,
    path: &Path,
) -> Result<Node, ScenarioError> {
    let refuse = |sources: &Sources, message: String| {
        let issue = Issue::new(KeyPath::from(key.key.as_str()), message);
        ScenarioError::from(Located::new(sources, issue, Some(node.span.clone())))
    };
    let verb = if key.key == INCLUDE {
        "include"
    } else {
        "extend"
    };
    let canonical = path.canonicalize().map_err(|error| {
        refuse(
            sources,
            format!("{} cannot be read: {error}", path.display()),
        )
    })?;
    if ancestors.contains(&canonical) {
        return Err(refuse(
            sources,
            format!(
                "{} {verb}s this file again: a circular reference",
                path.display()
            ),
        ));
    }
    if ancestors.len() >= MOST_ANCESTORS {
        return Err(refuse(
            sources,
            format!("too many files {verb} each other in a row; allowed: at most {MOST_ANCESTORS}"),
        ));
    }
    read(sources, ancestors, path)
}

/// Removes the inherited keys listed in `unset`.
fn forget(sources: &Sources, inherited: &mut Node, unset: &Entry) -> Result<(), ScenarioError> {
    let fault = |span: &Span, message: String, help: Option<String>| {
        let issue = Issue::new(KeyPath::from("unset"), message).with_help(help);
        ScenarioError::from(Located::new(sources, issue, Some(span.clone())))
    };
    let expected = |found: &Node| {
        let found_words = found.description();
        let message = format!("expected a list of dotted keys in quotes, found {found_words}");
        fault(
            &found.span,
            message,
            Some("unset = [\"time.end\"]".to_owned()),
        )
    };
    let Value::Array(keys) = &unset.node.value else {
        return Err(expected(&unset.node));
    };
    for key in keys {
        let Value::String(dotted) = &key.value else {
            return Err(expected(key));
        };
        overrides::remove(inherited, dotted)
            .map_err(|(message, help)| fault(&key.span, message, help))?;
    }
    Ok(())
}
