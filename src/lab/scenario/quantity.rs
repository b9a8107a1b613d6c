//! Numbers as typed: plain numbers in SI units, or text with a unit.

use crate::scenario::units::{self, Dimension};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// A typed physical quantity. Reading it never fails, so that all faulty numbers of a file can be
/// reported together; [`Quantity::si`] checks them.
#[derive(Clone, Debug)]
pub struct Quantity<D> {
    typed: Typed,
    dimension: PhantomData<D>,
}

#[derive(Clone, Debug)]
enum Typed {
    Number(f64),
    Text(String),
    /// Anything else; its description.
    Other(&'static str),
}

/// Three components of a vector.
pub type Vector<D> = [Quantity<D>; 3];

impl<D: Dimension> Quantity<D> {
    /// Whether the user typed the text `word` instead of a quantity.
    pub fn is_word(&self, word: &str) -> bool {
        matches!(&self.typed, Typed::Text(text) if text == word)
    }

    /// The value in SI units, finite.
    ///
    /// # Errors
    /// A message with the fault and what is allowed.
    pub fn si(&self) -> Result<f64, String> {
        let value = match &self.typed {
            Typed::Number(number) => *number,
            Typed::Text(text) => units::parse::<D>(text)?,
            Typed::Other(what) => {
                return Err(format!(
                    "expected {} as a number in SI units or as text with a unit, found {what}",
                    D::NAME
                ));
            }
        };
        if value.is_finite() {
            Ok(value)
        } else {
            Err(format!("{value} is not a finite number"))
        }
    }
}

impl<'de, D> Deserialize<'de> for Quantity<D> {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> Result<Self, S::Error> {
        Ok(Self {
            typed: deserializer.deserialize_any(TypedVisitor)?,
            dimension: PhantomData,
        })
    }
}

struct TypedVisitor;

impl<'de> Visitor<'de> for TypedVisitor {
    type Value = Typed;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number, or text with a unit")
    }

    fn visit_f64<E>(self, number: f64) -> Result<Typed, E> {
        Ok(Typed::Number(number))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Typed, E> {
        Ok(Typed::Number(number as f64))
    }

    fn visit_str<E>(self, text: &str) -> Result<Typed, E> {
        Ok(Typed::Text(text.to_owned()))
    }

    fn visit_bool<E>(self, _: bool) -> Result<Typed, E> {
        Ok(Typed::Other("a boolean"))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Typed, A::Error> {
        while sequence.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Typed::Other("an array"))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Typed, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Typed::Other("a table"))
    }
}

impl<D: Dimension> JsonSchema for Quantity<D> {
    fn schema_name() -> Cow<'static, str> {
        let words: Vec<&str> = D::NAME.split(' ').skip(1).collect();
        Cow::Owned(words.join("_"))
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let Some(si) = D::UNITS.first() else {
            return json_schema!({ "type": "number", "description": "A pure number." });
        };
        let name = D::NAME.split_once(' ').map_or(D::NAME, |(_, name)| name);
        json_schema!({
            "type": ["number", "string"],
            "description": format!(
                "A number in {}, or text with a unit; {}.", si.symbol, units::allowed::<D>()
            ),
            "title": name,
            "examples": [format!("1 {}", si.symbol)],
        })
    }
}
