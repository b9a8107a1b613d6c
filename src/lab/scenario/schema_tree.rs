//! Traverses the JSON Schema of scenario files together with a document, to find the schema of
//! each key.

use super::units::{self, Powers};
use serde_json::Value as Json;

/// The JSON Schema of scenario files.
#[derive(Clone, Copy)]
pub struct SchemaTree<'a> {
    root: &'a Json,
}

/// Types of numbers and text that a key accepts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accepted<'a> {
    /// A number with an optional unit: name of the dimension and powers of its unit.
    pub quantity: Option<(&'static str, Powers)>,
    /// A number without a unit.
    pub number: bool,
    /// A whole number.
    pub integer: bool,
    /// Any text.
    pub text: bool,
    /// These words.
    pub words: Vec<&'a str>,
}

impl Accepted<'_> {
    /// Whether numbers are accepted, but no free text.
    pub fn is_numeric(&self) -> bool {
        !self.text && (self.quantity.is_some() || self.number || self.integer)
    }
}

impl<'a> SchemaTree<'a> {
    /// A schema with its definitions.
    pub fn new(root: &'a Json) -> Self {
        Self { root }
    }

    /// The schemas that a schema refers to or is composed of.
    fn parts(self, schema: &'a Json) -> impl Iterator<Item = &'a Json> {
        let named = self
            .name(schema)
            .and_then(|name| self.root["$defs"].get(name));
        let lists = ["anyOf", "oneOf", "allOf"].into_iter();
        let listed = lists.filter_map(|list| schema.get(list)?.as_array());
        named.into_iter().chain(listed.flatten())
    }

    /// The name of the definition that a schema refers to.
    fn name(self, schema: &'a Json) -> Option<&'a str> {
        schema.get("$ref")?.as_str()?.strip_prefix("#/$defs/")
    }

    /// The schema of a key of a table; `kind` is the kind of the table, if it has several.
    pub fn property(self, schema: &'a Json, key: &str, kind: Option<&str>) -> Option<&'a Json> {
        let properties = schema.get("properties");
        let constant = properties.and_then(|all| all.get("kind")?.get("const")?.as_str());
        if constant.is_some() && constant != kind {
            return None;
        }
        properties.and_then(|all| all.get(key)).or_else(|| {
            self.parts(schema)
                .find_map(|part| self.property(part, key, kind))
        })
    }

    /// The schema of an item of an array.
    pub fn item(self, schema: &'a Json, index: usize) -> Option<&'a Json> {
        schema
            .get("prefixItems")
            .and_then(|items| items.get(index))
            .or_else(|| schema.get("items").filter(|items| items.is_object()))
            .or_else(|| self.parts(schema).find_map(|part| self.item(part, index)))
    }

    /// Powers of length, time and mass of a quantity. Their name is the title of its schema.
    pub fn powers(self, schema: &'a Json) -> Option<Powers> {
        self.accepted(schema).quantity.map(|(_, powers)| powers)
    }

    /// Allowed values of a key with this schema.
    pub fn accepted(self, schema: &'a Json) -> Accepted<'a> {
        let mut accepted = Accepted::default();
        self.collect(schema, &mut accepted);
        accepted
    }

    fn collect(self, schema: &'a Json, accepted: &mut Accepted<'a>) {
        let types: Vec<&str> = match &schema["type"] {
            Json::String(one) => vec![one.as_str()],
            Json::Array(several) => several.iter().filter_map(Json::as_str).collect(),
            _ => Vec::new(),
        };
        let words = schema["enum"].as_array().into_iter().flatten();
        let words = words.chain(schema.get("const")).filter_map(Json::as_str);
        let before = accepted.words.len();
        accepted.words.extend(words);
        let has_words = accepted.words.len() > before;
        if is_quantity(schema) {
            accepted.quantity = schema["title"].as_str().and_then(units::with_article);
        } else if !has_words {
            accepted.number |= types.contains(&"number");
            accepted.integer |= types.contains(&"integer");
            accepted.text |= types.contains(&"string");
        }
        for part in self.parts(schema) {
            self.collect(part, accepted);
        }
    }
}

/// Whether a schema describes a quantity: a number in SI units, or text with a unit.
pub fn is_quantity(schema: &Json) -> bool {
    schema["type"] == serde_json::json!(["number", "string"])
}
