//! The scenario of a whole sweep as a self-contained scenario.

use super::axis::Axis;
use super::case_set::CaseSet;
use crate::scenario::document::{Node, Value};
use crate::scenario::document_values;
use crate::scenario::error::{Located, ScenarioError};
use crate::scenario::input_file::{self, LARGEST_TABLE};
use crate::scenario::issue::{Issue, KeyPath};
use crate::scenario::named_files::{self, INPUTS};
use crate::scenario::resolve::start_file_of;
use crate::scenario::source::Span;
use std::collections::BTreeMap;

/// A scenario with its sweep, and all files that it reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Portable {
    /// The scenario file. With the copies beside it, it has the same cases.
    pub toml: String,
    /// The copies, by name.
    pub inputs: Vec<InputFile>,
}

/// A copy of a file that a sweep reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// Name of the file in the folder [`INPUTS`], with components separated by `/`.
    pub name: String,
    /// Contents of the file.
    pub contents: Vec<u8>,
}

impl CaseSet {
    /// The scenario of the whole sweep, with copies of the files that any of its cases may read.
    ///
    /// # Errors
    /// A file cannot be read, or two files would have the same name.
    pub fn portable(&self) -> Result<Portable, ScenarioError> {
        let mut root = self.document.clone();
        root.remove("extends");
        if root.entry("title").is_none() {
            root.insert("title", Value::String(self.name().to_owned()));
        }
        let mut copies = Copies {
            case_set: self,
            contents: BTreeMap::new(),
        };
        copies.take(&mut root, "")?;
        let mut sweep = empty_table(&root.span);
        let mut zips = Vec::new();
        for axis in &self.axes {
            let mut axis = axis.clone();
            for point in &mut axis.points {
                for (swept, value) in axis.keys.iter().zip(point) {
                    copies.take(value, &swept.key)?;
                }
            }
            zips.push(axis_table(&axis));
        }
        if !zips.is_empty() {
            sweep.insert("zip", Value::Array(zips));
        }
        if let Some(search) = self.search() {
            sweep.insert("search", search.typed.value.clone());
        }
        if let Some(derivatives) = self.derivatives() {
            sweep.insert("derivatives", derivatives.typed.value.clone());
        }
        if self.is_sweep() {
            root.insert("sweep", sweep.value);
        }
        let inputs = copies.contents.into_iter();
        Ok(Portable {
            toml: document_values::document(&root),
            inputs: inputs
                .map(|(name, contents)| InputFile { name, contents })
                .collect(),
        })
    }
}

/// Copies made so far.
struct Copies<'a> {
    case_set: &'a CaseSet,
    contents: BTreeMap<String, Vec<u8>>,
}

impl Copies<'_> {
    /// Reads the files named at or below the node of a dotted key, and replaces their names by
    /// those of the copies.
    fn take(&mut self, node: &mut Node, key: &str) -> Result<(), ScenarioError> {
        let case_set = self.case_set;
        let steps = key.split('.').filter(|step| !step.is_empty());
        let mut path = steps.map(str::to_owned).collect();
        let curve_of = |table: &str| case_set.experiments.curve_of(table);
        named_files::for_each(node, &mut path, &curve_of, &mut |node| self.take_one(node))
    }

    fn take_one(&mut self, node: &mut Node) -> Result<(), ScenarioError> {
        let Value::String(name) = &mut node.value else {
            return Ok(());
        };
        // In a table with copies each copy may have its own file: "curve{i}.csv".
        if name.contains('{') {
            for index in self.case_set.probes() {
                let loaded = self.case_set.scenario_of(index)?;
                for name in loaded.files_named_at(&self.case_set.experiments, &node.span) {
                    self.copy(&name, &node.span)?;
                }
            }
        } else {
            self.copy(name, &node.span)?;
        }
        *name = format!("{INPUTS}/{}", named_files::label(name));
        Ok(())
    }

    /// Reads the file whose name was typed at `span`.
    fn copy(&mut self, name: &str, span: &Span) -> Result<(), ScenarioError> {
        let sources = &self.case_set.sources;
        let fault = |message: String| {
            let issue = Issue::new(KeyPath::root(), message);
            ScenarioError::from(Located::new(sources, issue, Some(span.clone())))
        };
        let path = sources.get(span.source).directory.join(name);
        let contents = input_file::read(&start_file_of(&path), LARGEST_TABLE).map_err(fault)?;
        let label = named_files::label(name);
        let known = self.contents.get(&label);
        if known.is_some_and(|known| *known != contents) {
            let message = format!("another file has the name `{label}`, too; rename one of them");
            return Err(fault(message));
        }
        self.contents.insert(label, contents);
        Ok(())
    }
}

/// An axis as a table of `[[sweep.zip]]`.
fn axis_table(axis: &Axis) -> Node {
    let span = &axis.keys[0].span;
    let mut table = empty_table(span);
    for (number, swept) in axis.keys.iter().enumerate() {
        let values = axis.points.iter().map(|point| point[number].clone());
        table.insert(&swept.key, Value::Array(values.collect()));
    }
    table
}

fn empty_table(span: &Span) -> Node {
    Node {
        value: Value::Table(Vec::new()),
        span: span.clone(),
    }
}
