//! A scenario file with its sweep: the set of all its cases.

use super::axis::{self, Axis, sweep_path};
use super::case::{Case, Parameter};
use super::derivatives::SweptDerivatives;
use super::ends::Ends;
use super::search::Search;
use super::{points, sample, vary};
use crate::scenario::decode::decode;
use crate::scenario::document::{Entry, Node, Value};
use crate::scenario::error::{Located, ScenarioError};
use crate::scenario::experiments::Experiments;
use crate::scenario::issue::{Issue, Issues, KeyPath};
use crate::scenario::load::{self, Loaded};
use crate::scenario::merged;
use crate::scenario::named_files;
use crate::scenario::overrides;
use crate::scenario::source::{Sources, Span};
use crate::scenario::typed;
use std::path::Path;

/// A scenario and all its cases; a single case if nothing is varied.
#[derive(Clone, Debug)]
pub struct CaseSet {
    pub(super) experiments: Experiments,
    name: String,
    pub(super) sources: Sources,
    /// The scenario without its sweep.
    pub(super) document: Node,
    pub(super) axes: Vec<Axis>,
    search: Option<Search>,
    derivatives: Option<SweptDerivatives>,
    seed: Option<u64>,
}

impl CaseSet {
    /// Reads a scenario file with its sweep. `overrides` are arguments of `--set`. Each of
    /// `varied` is an argument of `--vary`, which replaces the values of its key in the file.
    ///
    /// # Errors
    /// All faults of the file and its sweep, but not of the values of the cases.
    /// [`CaseSet::scenario_of`] reports those.
    pub fn load(
        experiments: Experiments,
        path: &Path,
        overrides: &[String],
        varied: &[String],
    ) -> Result<Self, ScenarioError> {
        let (sources, document) = merged::merged(path, overrides)?;
        Self::new(experiments, &load::name_of(path), sources, document, varied)
    }

    /// The set of cases of a scenario given as text, called `name`. File names are relative to
    /// `directory`.
    ///
    /// # Errors
    /// As [`CaseSet::load`].
    pub fn from_text(
        experiments: Experiments,
        name: &str,
        text: &str,
        directory: &Path,
    ) -> Result<Self, ScenarioError> {
        let (sources, document) = merged::merged_text(name, text, directory, &[])?;
        Self::new(experiments, name, sources, document, &[])
    }

    /// The set of cases of a table in memory, called `name`. File names are relative to
    /// `directory`; `overrides` and `varied` as in [`CaseSet::load`].
    ///
    /// # Errors
    /// As [`CaseSet::load`].
    pub fn from_table(
        experiments: Experiments,
        name: &str,
        table: toml::Table,
        directory: &Path,
        overrides: &[String],
        varied: &[String],
    ) -> Result<Self, ScenarioError> {
        let (sources, document) = merged::merged_table(name, table, directory, overrides)?;
        Self::new(experiments, name, sources, document, varied)
    }

    fn new(
        experiments: Experiments,
        name: &str,
        mut sources: Sources,
        mut document: Node,
        varied: &[String],
    ) -> Result<Self, ScenarioError> {
        let whole = document.clone();
        let sweep = document.remove("sweep");
        let mut issues = Issues::default();
        let mut case_set = Self {
            experiments,
            name: name.to_owned(),
            sources: Sources::default(),
            document,
            axes: Vec::new(),
            search: None,
            derivatives: None,
            seed: None,
        };
        if let Some(mut sweep) = sweep {
            let ends = Ends {
                experiments,
                sources: &sources,
                document: &case_set.document,
            };
            ends.evaluate(&mut sweep.node)?;
            case_set.read_sweep(sweep, &sources, &mut issues);
        }
        if !issues.0.is_empty() {
            return Err(load::located(&sources, &whole, issues));
        }
        let mut typed = Vec::new();
        for argument in varied {
            typed.push(case_set.vary(&mut sources, argument)?);
        }
        case_set.axes.extend(typed);
        case_set.sources = sources;
        case_set.refuse_impossible_keys()?;
        if case_set.derivatives.is_some() && !case_set.is_sweep() {
            let message = "no key varies; `rodlab sensitivity` prints the derivatives of one case";
            return Err(case_set.refuse_derivatives(message, None));
        }
        Ok(case_set)
    }

    fn read_sweep(&mut self, mut sweep: Entry, sources: &Sources, issues: &mut Issues) {
        let mut take = |key: &str| sweep.node.remove(key);
        let (zip, file, samples, search) =
            (take("zip"), take("points"), take("sample"), take("search"));
        let derivatives = take("derivatives");
        let Value::Table(entries) = &sweep.node.value else {
            issues.push(Issue::new(
                sweep_path(),
                "expected a table [sweep] of keys with lists of values",
            ));
            return;
        };
        let keys = axis::read_keys(entries, issues);
        self.axes = keys.axes;
        if let Some(zip) = zip {
            self.axes.extend(axis::read_zips(&zip, issues));
        }
        if let Some(file) = file {
            match read_points(&file, sources) {
                Ok(axis) => self.axes.push(axis),
                Err(message) => issues.push(Issue::new(sweep_path().key("points"), message)),
            }
        }
        match (samples, keys.sampled.as_slice()) {
            (None, []) => {}
            (None, ranges) => {
                for range in ranges {
                    let path = sweep_path().key(&range.key.key);
                    let help = "or [sweep.sample] with method and count".to_owned();
                    issues.push(Issue::new(path, "a range needs a `count`").with_help(help));
                }
            }
            (Some(_), []) => issues.push(Issue::new(
                sweep_path().key("sample"),
                "samples need a range without `count`, such as contact.friction = { from = 0, to = 1 }",
            )),
            (Some(samples), ranges) => self.read_samples(&samples, ranges, issues),
        }
        if let Some(derivatives) = derivatives {
            match SweptDerivatives::read(&derivatives) {
                Ok(derivatives) => self.derivatives = Some(derivatives),
                Err(faults) => faults.0.into_iter().for_each(|issue| issues.push(issue)),
            }
        }
        if let Some(search) = search {
            match Search::read(&search) {
                Ok(search) => self.search = Some(search),
                Err(faults) => faults.0.into_iter().for_each(|issue| issues.push(issue)),
            }
        }
    }

    fn read_samples(
        &mut self,
        samples: &Entry,
        ranges: &[axis::SampledRange],
        issues: &mut Issues,
    ) {
        let path = sweep_path().key("sample");
        let read = decode::<typed::Sample>(&samples.node)
            .map_err(|faults: Issues| faults.below(&path))
            .and_then(|request| {
                let seed = u64::try_from(request.seed).ok();
                let axis = sample::sample(ranges, &request)
                    .map_err(|(key, message)| Issues::from(Issue::new(path.key(key), message)))?;
                Ok((axis, seed))
            });
        match read {
            Ok((axis, seed)) => {
                self.axes.push(axis);
                self.seed = seed;
            }
            Err(faults) => faults.0.into_iter().for_each(|issue| issues.push(issue)),
        }
    }

    /// The axis of an argument, which replaces the axis of the same key in the file.
    fn vary(&mut self, sources: &mut Sources, argument: &str) -> Result<Axis, ScenarioError> {
        let source = sources.add("--vary".to_owned(), Some(argument.into()), Path::new(""));
        let axis = vary::read(source, argument).map_err(|message| {
            let span = Span {
                source,
                bytes: 0..argument.len(),
            };
            let issue = Issue::new(KeyPath::root(), message);
            ScenarioError::from(Located::new(sources, issue, Some(span)))
        })?;
        let steps = self.steps_of(&axis.keys[0].key);
        let others = std::mem::take(&mut self.axes).into_iter();
        let is_other =
            |axis: &Axis| axis.keys.len() > 1 || self.steps_of(&axis.keys[0].key) != steps;
        let others = others.filter(is_other).collect();
        self.axes = others;
        Ok(axis)
    }

    /// Rejects keys that cannot vary, and keys that would override each other, however their paths
    /// are typed.
    fn refuse_impossible_keys(&self) -> Result<(), ScenarioError> {
        let mut seen: Vec<(Vec<String>, &str)> = Vec::new();
        let searched = self.search.iter().map(|search| &search.key);
        for swept in self.axes.iter().flat_map(|axis| &axis.keys).chain(searched) {
            let steps = self.steps_of(&swept.key);
            let message = match steps[0].as_str() {
                "extends" | "unset" | "include" | "sweep" => {
                    Some("this key cannot be varied".to_owned())
                }
                _ => seen
                    .iter()
                    .find_map(|(other, typed)| overlap(&steps, other, typed)),
            };
            if let Some(message) = message {
                let issue = Issue::new(KeyPath::from(swept.key.as_str()), message);
                return Err(Located::new(&self.sources, issue, Some(swept.span.clone())).into());
            }
            seen.push((steps, &swept.key));
        }
        Ok(())
    }

    /// The path to a key, with elements of arrays as indices.
    fn steps_of(&self, key: &str) -> Vec<String> {
        overrides::numbered_steps(&self.document, key)
    }

    /// Short name: the stem of the scenario file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether anything is varied.
    pub fn is_sweep(&self) -> bool {
        !self.axes.is_empty() || self.search.is_some()
    }

    /// The search, if there is one, which is repeated for each case of the other keys.
    pub fn search(&self) -> Option<&Search> {
        self.search.as_ref()
    }

    /// The derivatives that the sweep adds to the table, if any.
    pub fn derivatives(&self) -> Option<&SweptDerivatives> {
        self.derivatives.as_ref()
    }

    /// A fault of `[sweep.derivatives]`, with its position.
    pub fn refuse_derivatives(&self, message: &str, help: Option<String>) -> ScenarioError {
        let issue = Issue::new(sweep_path().key("derivatives"), message).with_help(help);
        let typed = self.derivatives.as_ref().map(|table| &table.typed);
        let keys = typed.map(|node| node.entry("to").map_or(node, |to| &to.node));
        Located::new(&self.sources, issue, keys.map(|node| node.span.clone())).into()
    }

    /// Seed of the samples, if there are any.
    pub fn seed(&self) -> Option<u64> {
        self.seed
    }

    /// Number of cases: the product of the lengths of all axes, or the largest integer if that
    /// overflows.
    pub fn count(&self) -> u128 {
        let lengths = self.axes.iter().map(|axis| axis.points.len() as u128);
        lengths.fold(1, u128::saturating_mul)
    }

    /// The varied keys, in the order of [`Case::parameters`]; the searched key is the last.
    pub fn keys(&self) -> Vec<&str> {
        let searched = self.search.iter().map(|search| &search.key);
        let keys = self.axes.iter().flat_map(|axis| &axis.keys);
        keys.chain(searched)
            .map(|swept| swept.key.as_str())
            .collect()
    }

    /// A case; the last axis varies fastest.
    ///
    /// # Panics
    /// If `index` is not less than [`CaseSet::count`].
    pub fn case(&self, index: usize) -> Case {
        Case::new(self.parameters(&self.position(index)))
    }

    /// The case of a search: a case of the other keys, with this number, in front of its unit, for
    /// the searched key.
    pub fn searched_case(&self, index: usize, number: f64) -> Case {
        let mut parameters = self.parameters(&self.position(index));
        if let Some(search) = &self.search {
            parameters.push(Parameter::new(&search.key.key, &search.value(number)));
        }
        Case::new(parameters)
    }

    /// Indices of cases in which each value of each axis occurs at least once, while the other
    /// axes have their first value.
    pub fn probes(&self) -> impl Iterator<Item = usize> + '_ {
        let strides = self.axes.iter().enumerate().map(|(number, axis)| {
            let after = &self.axes[number + 1..];
            let stride: usize = after.iter().map(|axis| axis.points.len()).product();
            (axis.points.len(), stride)
        });
        let others = strides.flat_map(|(length, stride)| (1..length).map(move |k| k * stride));
        std::iter::once(0).chain(others)
    }

    /// The point on each axis.
    fn position(&self, index: usize) -> Vec<usize> {
        let mut rest = index;
        let mut position: Vec<usize> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let point = rest % axis.points.len();
                rest /= axis.points.len();
                point
            })
            .collect();
        assert_eq!(rest, 0, "case {index} is beyond the last");
        position.reverse();
        position
    }

    fn parameters(&self, position: &[usize]) -> Vec<Parameter> {
        let axes = self.axes.iter().zip(position);
        axes.flat_map(|(axis, point)| {
            let values = &axis.points[*point];
            let pair = |(swept, node): (&axis::SweptKey, &Node)| {
                Parameter::new(&swept.key, &self.labelled(&swept.key, node).value)
            };
            axis.keys.iter().zip(values).map(pair)
        })
        .collect()
    }

    /// A value with file names as in ids and tables.
    fn labelled(&self, key: &str, node: &Node) -> Node {
        let mut node = node.clone();
        let mut path = key.split('.').map(str::to_owned).collect();
        let curve_of = |table: &str| self.experiments.curve_of(table);
        let Ok(()) = named_files::for_each(&mut node, &mut path, &curve_of, &mut |node| {
            if let Value::String(name) = &mut node.value {
                *name = named_files::label(name);
            }
            Ok::<(), std::convert::Infallible>(())
        });
        node
    }

    /// The scenario of a case.
    ///
    /// # Errors
    /// All its faults; faults of varied values refer to their positions in the sweep.
    pub fn scenario_of(&self, index: usize) -> Result<Loaded, ScenarioError> {
        self.changed_scenario(index, None, &[])
    }

    /// The scenario of [`CaseSet::searched_case`].
    ///
    /// # Errors
    /// As [`CaseSet::scenario_of`].
    pub fn searched_scenario(&self, index: usize, number: f64) -> Result<Loaded, ScenarioError> {
        self.changed_scenario(index, Some(number), &[])
    }

    /// The number at a dotted key, in SI units, as the scenario states it or its expression
    /// evaluates; `None` if it states none.
    ///
    /// # Errors
    /// Faults of the first case.
    pub fn number(&self, key: &str) -> Result<Option<f64>, ScenarioError> {
        let steps = self.steps_of(key).join(".");
        let stated = number_at(&self.document, &steps);
        if stated.is_some() || steps.starts_with("parameters.") {
            return Ok(stated);
        }
        let loaded = self.scenario_of(0)?;
        Ok(number_at(loaded.document(), &steps))
    }

    /// The set with further changes in the form of `--set` arguments.
    ///
    /// # Errors
    /// The first invalid change.
    pub fn changed(&self, changes: &[String]) -> Result<Self, ScenarioError> {
        let mut changed = self.clone();
        for text in changes {
            overrides::apply(&mut changed.sources, &mut changed.document, text)?;
        }
        Ok(changed)
    }

    /// The scenario of the first case with other numbers, in SI units, at dotted keys.
    ///
    /// # Errors
    /// All its faults.
    pub fn scenario_with(&self, numbers: &[(&str, f64)]) -> Result<Loaded, ScenarioError> {
        self.changed_with(numbers, &[])
    }

    /// Like [`Self::scenario_with`], with further changes in the form of `--set` arguments.
    ///
    /// # Errors
    /// All its faults.
    pub fn changed_with(
        &self,
        numbers: &[(&str, f64)],
        changes: &[String],
    ) -> Result<Loaded, ScenarioError> {
        let mut document = self.document.clone();
        let mut sources = self.sources.clone();
        let numbers = numbers.iter();
        let numbers = numbers.map(|(key, number)| format!("{key}={number:?}"));
        for text in numbers.chain(changes.iter().cloned()) {
            overrides::apply(&mut sources, &mut document, &text)?;
        }
        load::finish(self.experiments, &self.name, sources, document)
    }

    /// The scenario of a case with further changes in the form of `--set` arguments. A search also
    /// needs the number of its key.
    ///
    /// # Errors
    /// As [`CaseSet::scenario_of`].
    pub fn changed_scenario(
        &self,
        index: usize,
        searched: Option<f64>,
        changes: &[String],
    ) -> Result<Loaded, ScenarioError> {
        let mut document = self.document.clone();
        let mut sources = self.sources.clone();
        for (axis, point) in self.axes.iter().zip(self.position(index)) {
            for (swept, value) in axis.keys.iter().zip(&axis.points[point]) {
                self.assign(&mut document, swept, value.clone())?;
            }
        }
        if let (Some(search), Some(number)) = (&self.search, searched) {
            let value = Node {
                value: search.value(number),
                span: search.typed.span.clone(),
            };
            self.assign(&mut document, &search.key, value)?;
        }
        for text in changes {
            overrides::apply(&mut sources, &mut document, text)?;
        }
        load::finish(self.experiments, &self.name, sources, document)
    }

    fn assign(
        &self,
        document: &mut Node,
        swept: &axis::SweptKey,
        value: Node,
    ) -> Result<(), ScenarioError> {
        overrides::assign(document, &swept.key, &swept.span, value).map_err(|(message, help)| {
            let issue = Issue::new(KeyPath::from(swept.key.as_str()), message).with_help(help);
            Located::new(&self.sources, issue, Some(swept.span.clone())).into()
        })
    }
}

/// The number at a dotted key of a document, in SI units.
fn number_at(document: &Node, key: &str) -> Option<f64> {
    let mut node = document;
    for step in key.split('.') {
        node = match &node.value {
            Value::Array(elements) => elements.get(step.parse::<usize>().ok()?)?,
            _ => &node.entry(step)?.node,
        };
    }
    Parameter::new(key, &node.value).number
}

/// The fault of varying the key at `steps` together with another key, if any.
fn overlap(steps: &[String], other: &[String], typed: &str) -> Option<String> {
    if steps == other {
        return Some(format!("this key is varied twice, as `{typed}`, too"));
    }
    (steps.starts_with(other) || other.starts_with(steps)).then(|| {
        format!("`{typed}` is varied, too; one is a part of the other and would override it")
    })
}

fn read_points(file: &Entry, sources: &Sources) -> Result<Axis, String> {
    let Value::String(name) = &file.node.value else {
        return Err("expected the name of a CSV file".to_owned());
    };
    let span = &file.node.span;
    points::read(&sources.get(span.source).directory.join(name), span)
}
