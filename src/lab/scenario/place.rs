//! Places along a rod, typed and resolved.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, Visitor};
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// A place along a rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The first node or edge.
    Start,
    /// The last node or edge.
    End,
    /// The node or edge with this number, counted from zero.
    Number(usize),
}

impl Serialize for Place {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Start => serializer.serialize_str("start"),
            Self::End => serializer.serialize_str("end"),
            Self::Number(number) => number.serialize(serializer),
        }
    }
}

/// A place along a rod as typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TypedPlace {
    /// "start".
    Start,
    /// "end".
    End,
    /// A number that is not checked yet.
    Number(i64),
}

impl<'de> Deserialize<'de> for TypedPlace {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PlaceVisitor)
    }
}

struct PlaceVisitor;

impl Visitor<'_> for PlaceVisitor {
    type Value = TypedPlace;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("\"start\", \"end\" or a number counted from zero")
    }

    fn visit_i64<E>(self, number: i64) -> Result<TypedPlace, E> {
        Ok(TypedPlace::Number(number))
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<TypedPlace, E> {
        match text {
            "start" => Ok(TypedPlace::Start),
            "end" => Ok(TypedPlace::End),
            _ => Err(E::invalid_value(de::Unexpected::Str(text), &self)),
        }
    }
}

impl JsonSchema for TypedPlace {
    fn schema_name() -> Cow<'static, str> {
        "place".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "\"start\", \"end\", or a number counted from zero.",
            "anyOf": [{ "enum": ["start", "end"] }, { "type": "integer", "minimum": 0 }],
        })
    }
}
