//! Experiments as scenario files see them: their names, and the tables of keys that only some of
//! them have.
//!
//! Higher modules build the experiments. This module receives a list of them ([`Experiments`]) and
//! does not name any. How a kind defines its keys is shown in [`keys`](super::keys).

use super::decode::decode_beside;
use super::document::{Node, Value};
use super::issue::{Issue, Issues, KeyPath, did_you_mean};
use super::own_tables::{OwnTable, OwnTables};
use super::resolve::ExperimentKeys;
use super::typed::ScenarioFile;
use schemars::SchemaGenerator;
use serde_json::{Map, Value as Json, json};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// The key that names the experiment.
const EXPERIMENT: &str = "experiment";

/// All kinds of experiments that scenario files may name.
#[derive(Clone, Copy)]
pub struct Experiments(&'static [&'static dyn ExperimentKeys], &'static [OwnTable]);

impl Experiments {
    /// These kinds, and the tables of parts that every scene may have.
    pub const fn new(
        kinds: &'static [&'static dyn ExperimentKeys],
        parts: &'static [OwnTable],
    ) -> Self {
        Self(kinds, parts)
    }

    fn named(self, name: &str) -> Option<&'static dyn ExperimentKeys> {
        self.0.iter().copied().find(|kind| kind.name() == name)
    }

    fn names(self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|kind| kind.name())
    }

    /// The tables of all kinds, each once, and the tables of parts.
    fn tables(self) -> impl Iterator<Item = &'static OwnTable> {
        let before = move |index: usize, key: &str| {
            let tables = self.0[..index].iter().flat_map(|kind| kind.tables());
            tables.into_iter().any(|table| table.key() == key)
        };
        let of_kinds = self.0.iter().enumerate().flat_map(move |(index, kind)| {
            let tables = kind.tables().iter();
            tables.filter(move |table| !before(index, table.key()))
        });
        of_kinds.chain(self.1)
    }

    /// The key of the table `table` that names a CSV file of corners, if it has one.
    pub(super) fn curve_of(self, table: &str) -> Option<&'static str> {
        self.tables().find(|own| own.key() == table)?.curve()
    }

    /// The names as text: `"scene", "flagella" or "toy"`.
    pub(super) fn in_words(self) -> String {
        let names: Vec<String> = self.names().map(|name| format!("{name:?}")).collect();
        match names.split_last() {
            Some((last, others)) if !others.is_empty() => {
                format!("{} or {last}", others.join(", "))
            }
            _ => names.join(""),
        }
    }

    /// The kind named by the value of the key `experiment`.
    fn chosen(self, value: &Node) -> Result<&'static dyn ExperimentKeys, Issue> {
        let allowed = || self.names().collect::<Vec<_>>().join(", ");
        let fault = |message: String| Issue::new(KeyPath::from(EXPERIMENT), message);
        let Value::String(name) = &value.value else {
            let found = value.description();
            return Err(fault(format!(
                "expected one of {}, found {found}",
                allowed()
            )));
        };
        self.named(name).ok_or_else(|| {
            fault(format!(
                "{name:?} is not a valid value; allowed: {}",
                allowed()
            ))
            .with_help(did_you_mean(name, self.names()))
        })
    }

    /// Returns [`Experiments::schema`], computed once for each list of experiments.
    pub(super) fn shared_schema(self) -> Arc<Json> {
        static MADE: Mutex<Vec<(Experiments, Arc<Json>)>> = Mutex::new(Vec::new());
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, schema)) = made.iter().find(|(of, _)| std::ptr::eq(of.0, self.0)) {
            return Arc::clone(schema);
        }
        let schema = Arc::new(self.schema());
        made.push((self, Arc::clone(&schema)));
        schema
    }

    /// Adds the key `experiment` and the tables of all kinds to the schema of the common tables.
    pub(super) fn schema(self) -> Json {
        let mut generator = SchemaGenerator::default();
        let mut own = Map::new();
        for table in self.tables() {
            let schema = table.schema(&mut generator);
            own.insert(table.key().to_owned(), schema.to_value());
        }
        let names: Vec<Json> = self
            .0
            .iter()
            .map(|kind| json!({ "type": "string", "const": kind.name(), "description": kind.summary() }))
            .collect();
        let experiment = json!({ "description": "The kind of simulation.", "oneOf": names });
        own.insert(EXPERIMENT.to_owned(), experiment);
        let mut root = generator.into_root_schema_for::<ScenarioFile>().to_value();
        if let Some(Json::Object(properties)) = root.get_mut("properties") {
            properties.extend(own);
        }
        root
    }
}

impl fmt::Debug for Experiments {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.names()).finish()
    }
}

/// A scenario file as typed.
pub struct TypedFile {
    /// The common tables.
    pub common: ScenarioFile,
    /// The kind, if the document names one.
    pub kind: Option<&'static dyn ExperimentKeys>,
    /// The tables of kinds.
    pub own: OwnTables,
}

impl TypedFile {
    /// Decodes a document.
    ///
    /// # Errors
    /// All structural faults.
    pub fn decode(document: &Node, experiments: Experiments) -> Result<Self, Issues> {
        let mut issues = Issues::default();
        let mut beside: Vec<&str> = vec![EXPERIMENT];
        beside.extend(experiments.tables().map(OwnTable::key));
        let common = issues.keep(decode_beside::<ScenarioFile>(document, &beside));
        let kind = document.entry(EXPERIMENT).and_then(|entry| {
            let chosen = experiments.chosen(&entry.node);
            issues.keep(chosen.map_err(Issues::from))
        });
        let own = issues.keep(OwnTables::decode(document, experiments.tables()));
        issues.or_ok(Self {
            common: common.unwrap_or_default(),
            kind,
            own: own.unwrap_or_default(),
        })
    }
}
