//! Experiments as scenario files see them: names, and tables of keys that belong to some of them only.
//!
//! The experiments themselves are built in rooms above; this room is given a list of them ([`Experiments`]) and knows
//! none by name. How a kind defines its keys is shown in [`keys`](super::keys).

use super::decode::{decode, decode_beside};
use super::document::{Node, Value};
use super::issue::{Issue, Issues, KeyPath, did_you_mean};
use super::resolve::{CommonTables, Request, Section};
use super::resolved::{Experiment, Time};
use super::typed::ScenarioFile;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json, json};
use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;

/// The key that names the experiment.
const EXPERIMENT: &str = "experiment";

/// A kind of experiment as scenario files see it.
pub trait ExperimentKeys: Sync {
    /// The name by which scenario files call it.
    fn name(&self) -> &'static str;

    /// What it simulates, in one sentence.
    fn summary(&self) -> &'static str;

    /// The tables that belong to it; kinds may share a table.
    fn tables(&self) -> &'static [OwnTable] {
        &[]
    }

    /// What holds where the file has no table `[time]`; `None` where it must have one.
    fn usual_time(&self) -> Option<Time> {
        None
    }

    /// What to say of a table that belongs to other kinds only.
    fn refusal(&self) -> &'static str {
        "this table is for another experiment"
    }

    /// Resolves its own tables and refuses common ones that mean nothing to it; `None` if a fault was reported that
    /// leaves nothing to go on with.
    fn resolve(&self, request: &Request<'_>) -> Option<Experiment>;

    /// Reports what it needs of the common tables, or cannot have there.
    fn judge(&self, _top: &Section<'_>, _common: &CommonTables<'_>) {}
}

/// A table of scenario files that belongs to some kinds of experiments.
#[derive(Clone, Copy)]
pub struct OwnTable {
    key: &'static str,
    description: &'static str,
    curve: Option<&'static str>,
    schema: fn(&mut SchemaGenerator) -> Schema,
    decode: fn(&Node) -> Result<Box<dyn Any>, Issues>,
}

impl OwnTable {
    /// The table `[key]`, typed as the struct `T`, whose doc comments explain its keys. The description says what the
    /// table is for.
    pub const fn new<T: DeserializeOwned + JsonSchema + Any>(
        key: &'static str,
        description: &'static str,
    ) -> Self {
        Self {
            key,
            description,
            curve: None,
            schema: |generator| generator.subschema_for::<Option<T>>(),
            decode: |node| Ok(Box::new(decode::<T>(node)?)),
        }
    }

    /// The same table, whose `key` names a CSV file of corners that may stand in the table itself as `points`.
    #[must_use]
    pub const fn with_curve(self, key: &'static str) -> Self {
        Self {
            curve: Some(key),
            ..self
        }
    }

    /// Its key.
    pub fn key(&self) -> &'static str {
        self.key
    }
}

/// All kinds of experiments that scenario files may name.
#[derive(Clone, Copy)]
pub struct Experiments(&'static [&'static dyn ExperimentKeys]);

impl Experiments {
    /// These kinds.
    pub const fn new(kinds: &'static [&'static dyn ExperimentKeys]) -> Self {
        Self(kinds)
    }

    fn named(self, name: &str) -> Option<&'static dyn ExperimentKeys> {
        self.0.iter().copied().find(|kind| kind.name() == name)
    }

    fn names(self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|kind| kind.name())
    }

    /// Their tables, each once.
    fn tables(self) -> impl Iterator<Item = &'static OwnTable> {
        let before = move |index: usize, key: &str| {
            let tables = self.0[..index].iter().flat_map(|kind| kind.tables());
            tables.into_iter().any(|table| table.key == key)
        };
        self.0.iter().enumerate().flat_map(move |(index, kind)| {
            let tables = kind.tables().iter();
            tables.filter(move |table| !before(index, table.key))
        })
    }

    /// The key of the table `table` that names a CSV file of corners, if it has one.
    pub(super) fn curve_of(self, table: &str) -> Option<&'static str> {
        self.tables().find(|own| own.key == table)?.curve
    }

    /// Names in words: `"scene", "flagella" or "toy"`.
    pub(super) fn in_words(self) -> String {
        let names: Vec<String> = self.names().map(|name| format!("{name:?}")).collect();
        match names.split_last() {
            Some((last, others)) if !others.is_empty() => {
                format!("{} or {last}", others.join(", "))
            }
            _ => names.join(""),
        }
    }

    /// The kind that the value of the key `experiment` names.
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
                "{name:?} is not known here; allowed: {}",
                allowed()
            ))
            .with_help(did_you_mean(name, self.names()))
        })
    }

    /// Adds the key `experiment` and the tables of all kinds to the schema of the common tables.
    pub(super) fn schema(self) -> Json {
        let mut generator = SchemaGenerator::default();
        let mut own = Map::new();
        for table in self.tables() {
            let mut schema = (table.schema)(&mut generator);
            schema.insert("description".to_owned(), table.description.into());
            own.insert(table.key.to_owned(), schema.to_value());
        }
        let names: Vec<Json> = self
            .0
            .iter()
            .map(|kind| json!({ "type": "string", "const": kind.name(), "description": kind.summary() }))
            .collect();
        let experiment = json!({ "description": "What is simulated.", "oneOf": names });
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

/// A scenario file as typed: its common tables, the kind that it names, and the tables of kinds.
pub struct TypedFile {
    /// The common tables.
    pub common: ScenarioFile,
    /// The kind, where one is named.
    pub kind: Option<&'static dyn ExperimentKeys>,
    own: BTreeMap<&'static str, Box<dyn Any>>,
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
        let mut own = BTreeMap::new();
        for table in experiments.tables() {
            if let Some(entry) = document.entry(table.key) {
                let typed = (table.decode)(&entry.node);
                let below = |faults: Issues| faults.below(&KeyPath::from(table.key));
                if let Some(typed) = issues.keep(typed.map_err(below)) {
                    own.insert(table.key, typed);
                }
            }
        }
        let common = common.unwrap_or_default();
        issues.or_ok(Self { common, kind, own })
    }

    /// The table `[key]` of a kind, where the file has one.
    pub fn own<T: Any>(&self, key: &str) -> Option<&T> {
        self.own.get(key)?.downcast_ref()
    }

    /// Reports tables that belong to other kinds only.
    pub fn refuse_tables_of_others(&self, top: &Section<'_>, kind: &dyn ExperimentKeys) {
        for key in self.own.keys() {
            if !kind.tables().iter().any(|table| table.key == *key) {
                top.fault(key, kind.refusal());
            }
        }
    }
}
