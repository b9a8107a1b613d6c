//! Reads scenarios: from files, texts and tables to the resolved scenario.

use super::document::{self, Node, Value};
use super::document_values;
use super::error::{Located, ScenarioError};
use super::expansion::{self, Copied, Expanded, Origins, PARAMETERS};
use super::experiments::{Experiments, TypedFile};
use super::issue::{Issue, Issues, KeyPath};
use super::merged::{merged, merged_table, merged_text};
use super::named_files;
use super::overrides::numbered_steps;
use super::resolve::{Context, resolve};
use super::resolved::Scenario;
use super::source::{Sources, Span};
use super::units;
use std::collections::HashSet;
use std::convert::Infallible;
use std::path::Path;

/// A scenario, and the data to locate its keys.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The resolved scenario.
    pub scenario: Scenario,
    sources: Sources,
    /// After expansion.
    document: Node,
    origins: Origins,
    /// The table `[parameters]` as typed.
    parameters: Option<Node>,
}

/// Reads, merges, overrides and resolves a scenario file. Each override is `key=value` with a dotted key,
/// such as `rods.0.radius=5 mm`; rods may be addressed by name: `rods.beam.radius`. The experiment is one of `experiments`.
///
/// # Errors
/// All faults that can be found in one pass, with file, line and column.
pub fn load(
    experiments: Experiments,
    path: &Path,
    overrides: &[String],
) -> Result<Loaded, ScenarioError> {
    let (sources, document) = merged(path, overrides)?;
    finish(experiments, &name_of(path), sources, document)
}

/// Name of the results of a scenario file: its file stem.
pub(super) fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(
        || "scenario".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

/// Resolves the text of a scenario called `name`. File names are relative to `directory`;
/// overrides as in [`load`].
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

/// Resolves a scenario called `name`, given as a table in memory. File names are relative to
/// `directory`; overrides as in [`load`]. `toml::Table::try_from` makes a table of any `Serialize`
/// type; the macro `toml::toml!` also makes tables.
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
                "expected a single case, found a sweep",
            )
        };
        return Err(located(&sources, &document, issue.into()));
    }
    let parameters = document.entry(PARAMETERS).map(|entry| entry.node.clone());
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
        };
        resolve(&context, &directory_of, &file.common, file.kind, &file.own)
    });
    match resolved {
        Ok(scenario) => Ok(Loaded {
            scenario,
            sources,
            document,
            origins,
            parameters,
        }),
        Err(issues) => Err(located_as_written(&sources, &document, &origins, issues)),
    }
}

impl Loaded {
    /// The scenario after expansion as a file that needs no other scenario file: parameters,
    /// expressions and copies are replaced by numbers and tables. File names are absolute.
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

    /// File names in the expanded document whose text was typed at `span`.
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

    /// The number at a dotted key in SI units: as typed, the value of a parameter, or the default;
    /// `None` if there is no number.
    pub fn number(&self, key: &str) -> Option<f64> {
        let resolved = document::parse(0, &self.scenario.to_toml()).ok();
        let of_parameter = || {
            let name = key.strip_prefix(PARAMETERS)?.strip_prefix('.')?;
            number_at(self.parameters.as_ref()?, name)
        };
        number_at(&self.document, key)
            .or_else(of_parameter)
            .or_else(|| number_at(&resolved?, key))
    }

    /// The document after expansion.
    pub(super) fn document(&self) -> &Node {
        &self.document
    }

    /// Number of tables of each array with copies, before and after expansion.
    pub fn copied(&self) -> Vec<Copied> {
        self.origins.copied()
    }

    /// Finds the positions of faults that were detected later, when the scene was built.
    pub fn locate(&self, issues: Issues) -> ScenarioError {
        located_as_written(&self.sources, &self.document, &self.origins, issues)
    }
}

/// The number at a dotted key of a document, in SI units.
fn number_at(document: &Node, key: &str) -> Option<f64> {
    let mut node = document;
    for step in numbered_steps(document, key) {
        node = match &node.value {
            Value::Table(_) => &node.entry(&step)?.node,
            Value::Array(elements) => elements.get(step.parse::<usize>().ok()?)?,
            _ => return None,
        };
    }
    match &node.value {
        Value::Integer(integer) => Some(*integer as f64),
        Value::Float(number) => Some(*number),
        Value::String(text) => units::parse_any(text),
        _ => None,
    }
}

/// [`located`] for an expanded document. A fault in a copy is assigned to the table as written; a
/// fault in several copies is reported for the first one only.
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

/// Faults with the positions of their keys.
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
