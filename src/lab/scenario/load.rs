//! Reading scenarios: the file, those it extends, overrides from the command line.

use super::document::{self, Entry, Node, Value};
use super::error::{Located, ScenarioError};
use super::experiments::{Experiments, TypedFile};
use super::input_file::{self, LARGEST_TEXT};
use super::issue::{Issue, Issues, KeyPath};
use super::overrides;
use super::resolve::{Context, resolve};
use super::resolved::Scenario;
use super::source::{Sources, Span};
use std::path::{Path, PathBuf};

/// Most files that extend each other in a row.
const MOST_ANCESTORS: usize = 64;

/// A scenario, and what it takes to point at its keys.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The resolved scenario.
    pub scenario: Scenario,
    sources: Sources,
    document: Node,
}

/// Reads, merges, overrides and resolves a scenario file. Each override is `key=value` with a dotted key,
/// such as `rods.0.radius=5 mm`; rods may be called by name: `rods.beam.radius`. The experiment is one of `experiments`.
///
/// # Errors
/// Everything that is wrong with it, as far as it can be told in one go, with file, line and column.
pub fn load(
    experiments: Experiments,
    path: &Path,
    overrides: &[String],
) -> Result<Loaded, ScenarioError> {
    let (sources, document) = merged(path, overrides)?;
    finish(experiments, &name_of(path), sources, document)
}

/// By which name results of a scenario file are called: its stem.
pub(super) fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(
        || "scenario".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

/// A scenario file with those that it extends and with overrides.
pub(super) fn merged(path: &Path, overrides: &[String]) -> Result<(Sources, Node), ScenarioError> {
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

/// Resolves the text of a scenario, called `name`, that names other files relative to `directory`; overrides as [`load`]
/// takes them.
///
/// # Errors
/// As [`load`].
pub fn from_text(
    experiments: Experiments,
    name: &str,
    text: &str,
    directory: &Path,
    overrides: &[String],
) -> Result<Loaded, ScenarioError> {
    let (sources, document) = merged_text(name, text, directory, overrides)?;
    finish(experiments, name, sources, document)
}

/// [`merged`] for the text of a scenario.
pub(super) fn merged_text(
    name: &str,
    text: &str,
    directory: &Path,
    overrides: &[String],
) -> Result<(Sources, Node), ScenarioError> {
    let mut sources = Sources::default();
    let mut ancestors = Vec::new();
    let source = sources.add(format!("{name}.toml"), text.to_owned(), directory);
    let document = parse_and_extend(&mut sources, &mut ancestors, source)?;
    overridden(sources, document, overrides)
}

/// Resolves a document.
pub(super) fn finish(
    experiments: Experiments,
    name: &str,
    sources: Sources,
    document: Node,
) -> Result<Loaded, ScenarioError> {
    if document.entry("sweep").is_some() {
        let issue = Issue {
            labels_key: true,
            ..Issue::new(
                KeyPath::from("sweep"),
                "one case was asked for, and this is a sweep",
            )
        };
        return Err(located(&sources, &document, issue.into()));
    }
    let resolved = TypedFile::decode(&document, experiments).and_then(|file| {
        let directory_of = |path: &KeyPath| {
            let (_, value) = document.locate(path);
            sources.get(value.source).directory.clone()
        };
        let context = Context {
            name,
            experiments: experiments.in_words(),
            document: &document,
            directory_of: &directory_of,
        };
        resolve(&context, &file.common, file.kind, &file.own)
    });
    match resolved {
        Ok(scenario) => Ok(Loaded {
            scenario,
            sources,
            document,
        }),
        Err(issues) => Err(located(&sources, &document, issues)),
    }
}

impl Loaded {
    /// Finds the places of faults that showed later, when the scene was built.
    pub fn locate(&self, issues: Issues) -> ScenarioError {
        located(&self.sources, &self.document, issues)
    }
}

/// Faults with the places of their keys.
pub(super) fn located(sources: &Sources, document: &Node, issues: Issues) -> ScenarioError {
    let mut located: Vec<Located> = issues
        .0
        .into_iter()
        .map(|issue| {
            let (key, value) = document.locate(&issue.path);
            let span = if issue.labels_key { key } else { value };
            Located::new(sources, issue, Some(span))
        })
        .collect();
    located.sort_by_key(Located::order);
    ScenarioError(located)
}

/// Reads a file and what it extends. `ancestors` are the files that led here.
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
    let source = sources.add(path.display().to_string(), text, &directory);
    ancestors.push(canonical);
    let node = parse_and_extend(sources, ancestors, source)?;
    ancestors.pop();
    Ok(node)
}

fn parse_and_extend(
    sources: &mut Sources,
    ancestors: &mut Vec<PathBuf>,
    source: usize,
) -> Result<Node, ScenarioError> {
    let text = sources.get(source).text.clone();
    let node = document::parse(source, &text).map_err(|errors| {
        let located = errors.into_iter().map(|error| {
            let span = Span {
                source,
                bytes: error.bytes,
            };
            let message = format!("not TOML: {}", error.message);
            Located::new(sources, Issue::new(KeyPath::root(), message), Some(span))
        });
        ScenarioError(located.collect())
    })?;
    let mut node = node;
    let unset = node.remove("unset");
    let Some(entry) = node.entry("extends") else {
        return match unset {
            Some(unset) => {
                let message = "nothing is inherited here; this key stands beside `extends`";
                let issue = Issue::new(KeyPath::from("unset"), message);
                Err(Located::new(sources, issue, Some(unset.key_span)).into())
            }
            None => Ok(node),
        };
    };
    let refuse = |sources: &Sources, message: String| {
        let issue = Issue::new(KeyPath::from("extends"), message);
        ScenarioError::from(Located::new(sources, issue, Some(entry.node.span.clone())))
    };
    let Value::String(base) = &entry.node.value else {
        return Err(refuse(
            sources,
            format!(
                "expected the name of a file, found {}",
                entry.node.description()
            ),
        ));
    };
    let path = sources.get(source).directory.join(base);
    let canonical = path.canonicalize().map_err(|error| {
        refuse(
            sources,
            format!("{} cannot be read: {error}", path.display()),
        )
    })?;
    if ancestors.contains(&canonical) {
        return Err(refuse(
            sources,
            format!("{} extends this file in turn: a circle", path.display()),
        ));
    }
    if ancestors.len() >= MOST_ANCESTORS {
        return Err(refuse(
            sources,
            format!("{MOST_ANCESTORS} files extend each other in a row; allowed: no more"),
        ));
    }
    let mut merged = read(sources, ancestors, &path)?;
    if let Some(unset) = unset {
        forget(sources, &mut merged, &unset)?;
    }
    merged.merge(node);
    Ok(merged)
}

/// Takes the inherited keys out that `unset` lists.
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
