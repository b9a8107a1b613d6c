//! Reading scenarios: the file, those it extends and includes, overrides from the command line.

use super::document::{self, Entry, Node, Value};
use super::document_values;
use super::error::{Located, ScenarioError};
use super::expansion::{self, Copied, Expanded, Origins};
use super::experiments::{Experiments, TypedFile};
use super::include::{self, INCLUDE};
use super::input_file::{self, LARGEST_TEXT};
use super::issue::{Issue, Issues, KeyPath};
use super::named_files;
use super::overrides;
use super::resolve::{Context, resolve};
use super::resolved::Scenario;
use super::source::{Sources, Span};
use std::collections::HashSet;
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most files that extend or include each other in a row.
const MOST_ANCESTORS: usize = 64;

/// A scenario, and the data to locate its keys.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The resolved scenario.
    pub scenario: Scenario,
    sources: Sources,
    /// After expansion.
    document: Node,
    origins: Origins,
}

/// Reads, merges, overrides and resolves a scenario file. Each override is `key=value` with a dotted key,
/// such as `rods.0.radius=5 mm`; rods may be addressed by name: `rods.beam.radius`. The experiment is one of `experiments`.
///
/// # Errors
/// All its faults, as far as they can be found in one pass, with file, line and column.
pub fn load(
    experiments: Experiments,
    path: &Path,
    overrides: &[String],
) -> Result<Loaded, ScenarioError> {
    let (sources, document) = merged(path, overrides)?;
    finish(experiments, &name_of(path), sources, document)
}

/// Name of the results of a scenario file: its stem.
pub(super) fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(
        || "scenario".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

/// A scenario file with those that it extends and includes, and with overrides.
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
    let parsed = parse(&mut sources, format!("{name}.toml"), text.into(), directory)?;
    let document = extend(&mut sources, &mut Vec::new(), parsed)?;
    overridden(sources, document, overrides)
}

/// Resolves a scenario that is a table in memory, called `name`, that names other files relative to `directory`; overrides
/// as [`load`] takes them. Every `Serialize` type makes a table, by `toml::Table::try_from`, and so does the macro `toml::toml!`.
///
/// # Errors
/// As [`load`], with `name` in place of file, line and column.
pub fn from_table(
    experiments: Experiments,
    name: &str,
    table: toml::Table,
    directory: &Path,
    overrides: &[String],
) -> Result<Loaded, ScenarioError> {
    let (sources, document) = merged_table(name, table, directory, overrides)?;
    finish(experiments, name, sources, document)
}

/// [`merged`] for a table in memory.
pub(super) fn merged_table(
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
    let Expanded { document, origins } = expansion::expand(experiments, &sources, document)?;
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
            origins,
        }),
        Err(issues) => Err(located_as_written(&sources, &document, &origins, issues)),
    }
}

impl Loaded {
    /// The scenario after expansion as a file that needs no other scenario file: parameters, expressions and copies are
    /// numbers and tables. Names of files are absolute.
    pub fn expanded_toml(&self, experiments: Experiments) -> String {
        let mut document = self.document.clone();
        document.remove("extends");
        if document.entry("title").is_none() {
            document.insert("title", Value::String(self.scenario.title.clone()));
        }
        let curve_of = |table: &str| experiments.curve_of(table);
        let Ok(()) =
            named_files::for_each(&mut document, &mut Vec::new(), &curve_of, &mut |node| {
                if let Value::String(name) = &mut node.value {
                    let path = self.sources.get(node.span.source).directory.join(&name);
                    let absolute = std::path::absolute(&path).unwrap_or(path);
                    *name = absolute.display().to_string();
                }
                Ok::<(), Infallible>(())
            });
        document_values::document(&document)
    }

    /// The names of files in the document after expansion that were typed at `span`.
    pub(super) fn files_named_at(&self, experiments: &Experiments, span: &Span) -> Vec<String> {
        let mut names = Vec::new();
        let curve_of = |table: &str| experiments.curve_of(table);
        let mut document = self.document.clone();
        let Ok(()) =
            named_files::for_each(&mut document, &mut Vec::new(), &curve_of, &mut |node| {
                if let Value::String(name) = &node.value
                    && node.span == *span
                {
                    names.push(name.clone());
                }
                Ok::<(), Infallible>(())
            });
        names
    }

    /// Number of tables of each array with copies, before expansion and after.
    pub fn copied(&self) -> Vec<Copied> {
        self.origins.copied()
    }

    /// Finds the places of faults that were found later, when the scene was built.
    pub fn locate(&self, issues: Issues) -> ScenarioError {
        located_as_written(&self.sources, &self.document, &self.origins, issues)
    }
}

/// [`located`] for a document after expansion: copies are those of tables as written. A fault of several copies is
/// reported for the first.
fn located_as_written(
    sources: &Sources,
    document: &Node,
    origins: &Origins,
    issues: Issues,
) -> ScenarioError {
    let mut error = located(sources, document, issues);
    let mut seen = HashSet::new();
    error.0.retain_mut(|located| {
        located.issue = origins.restore(located.issue.clone());
        let issue = &located.issue;
        issue.copy.is_none() || seen.insert((issue.path.clone(), issue.message.clone()))
    });
    error
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

/// Reads a file and the files that it extends and includes. `ancestors` are the files that led here.
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

/// The top of a source with the files that it extends and includes.
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

/// Reads a file that another names by the value `node` of a key.
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
            format!("{} {verb}s this file in turn: a circle", path.display()),
        ));
    }
    if ancestors.len() >= MOST_ANCESTORS {
        return Err(refuse(
            sources,
            format!("{MOST_ANCESTORS} files {verb} each other in a row; allowed: no more"),
        ));
    }
    read(sources, ancestors, path)
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
