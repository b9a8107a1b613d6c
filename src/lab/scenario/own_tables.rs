//! Tables of scenario files for some kinds of experiments, or for a part of the scene.

use super::decode::decode;
use super::document::Node;
use super::issue::{Issues, KeyPath};
use super::part::{self, Part};
use super::resolved::{Parts, Time};
use super::section::Section;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::DeserializeOwned;
use std::any::Any;
use std::collections::BTreeMap;

/// A table of scenario files that belongs to some kinds of experiments, or to a part.
#[derive(Clone, Copy)]
pub struct OwnTable {
    key: &'static str,
    description: &'static str,
    curve: Option<&'static str>,
    schema: fn(&mut SchemaGenerator) -> Schema,
    decode: fn(&Node) -> Result<Box<dyn Any>, Issues>,
    resolve: Option<Resolve>,
    lumps_inertia: bool,
}

/// Resolves the parts in a typed table and adds them to the others.
type Resolve = fn(&Section<'_>, &dyn Any, &Time, &mut Parts);

impl OwnTable {
    /// The table `[key]`, declared as the struct `T`, whose doc comments explain its keys.
    /// `description` states the purpose of the table.
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
            resolve: None,
            lumps_inertia: false,
        }
    }

    /// The array of tables of a kind of part.
    pub const fn of_part<P: Part>() -> Self {
        Self {
            schema: |generator| {
                let mut schema = generator.subschema_for::<Vec<P::Typed>>();
                schema.insert("default".to_owned(), serde_json::json!([]));
                schema
            },
            resolve: Some(part::resolve::<P>),
            lumps_inertia: P::LUMPS_INERTIA,
            ..Self::new::<Vec<P::Typed>>(P::KEY, P::DESCRIPTION)
        }
    }

    /// Adds a `key` that names a CSV file of corners. The corners may instead be given in the
    /// table as `points`.
    #[must_use]
    pub const fn with_curve(self, key: &'static str) -> Self {
        Self {
            curve: Some(key),
            ..self
        }
    }

    /// Schema of the table, with its description.
    pub fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        let mut schema = (self.schema)(generator);
        schema.insert("description".to_owned(), self.description.into());
        schema
    }

    /// The key that names a CSV file of corners, if it has one.
    pub(super) fn curve(&self) -> Option<&'static str> {
        self.curve
    }

    /// Key of the table.
    pub fn key(&self) -> &'static str {
        self.key
    }
}

/// The typed tables of kinds and of parts that a file has.
#[derive(Default)]
pub struct OwnTables(BTreeMap<&'static str, (&'static OwnTable, Box<dyn Any>)>);

impl OwnTables {
    /// Decodes the tables among `tables` that a document has.
    ///
    /// # Errors
    /// All structural faults.
    pub fn decode(
        document: &Node,
        tables: impl Iterator<Item = &'static OwnTable>,
    ) -> Result<Self, Issues> {
        let mut issues = Issues::default();
        let mut own = BTreeMap::new();
        for table in tables {
            if let Some(entry) = document.entry(table.key) {
                let typed = (table.decode)(&entry.node);
                let below = |faults: Issues| faults.below(&KeyPath::from(table.key));
                if let Some(typed) = issues.keep(typed.map_err(below)) {
                    own.insert(table.key, (table, typed));
                }
            }
        }
        issues.or_ok(Self(own))
    }

    /// The table `[key]`, if the file has it.
    pub fn get<T: Any>(&self, key: &str) -> Option<&T> {
        self.0.get(key)?.1.downcast_ref()
    }

    /// The keys of the tables of kinds that the file has.
    pub fn keys(&self) -> impl Iterator<Item = &'static str> {
        let of_kinds = self.0.values().filter(|(table, _)| table.resolve.is_none());
        of_kinds.map(|(table, _)| table.key)
    }

    /// Whether rods have lumped inertia because of a part that the file has.
    pub fn lump_inertia(&self) -> bool {
        self.0.values().any(|(table, _)| table.lumps_inertia)
    }

    /// Resolves the parts that the file has.
    pub fn parts(&self, top: &Section<'_>, time: &Time) -> Parts {
        let mut parts = Parts::default();
        for (table, typed) in self.0.values() {
            if let Some(resolve) = table.resolve {
                resolve(top, &**typed, time, &mut parts);
            }
        }
        parts
    }
}
