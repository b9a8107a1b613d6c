//! Decodes the tree of a document into the typed scenario file, with serde.
//!
//! The tree is its own serde deserialiser, for better messages: they name the keys that a table
//! may have, suggest the nearest one, and report the path of the fault. A table with a `kind` is
//! an enum: the kind is the variant, the other keys are its fields. Text in place of such a table
//! is a kind without further keys.

use super::document::{Entry, Node, Value};
use super::issue::{Issue, Issues, KeyPath, did_you_mean};
use serde::de::{
    self, DeserializeOwned, DeserializeSeed, EnumAccess, IntoDeserializer, MapAccess, SeqAccess,
    VariantAccess, Visitor,
};
use std::fmt;

/// Maximum number of faults to find: each takes another pass through the document.
const MOST_FAULTS: usize = 100;

/// Decodes a document.
///
/// # Errors
/// All structural faults: unknown keys, wrong types, unknown names of kinds and models. After each
/// fault the faulty key is removed and the rest is decoded again, so that all faults are found
/// together.
pub fn decode<T: DeserializeOwned>(document: &Node) -> Result<T, Issues> {
    decode_beside(document, &[])
}

/// Decodes a document except the keys `beside` at its top, which other code decodes. An unknown
/// key may be a misspelling of one of them.
///
/// # Errors
/// As [`decode`].
pub fn decode_beside<T: DeserializeOwned>(document: &Node, beside: &[&str]) -> Result<T, Issues> {
    let mut rest = document.clone();
    let mut issues = Issues::default();
    loop {
        let top = Top {
            node: &rest,
            beside,
        };
        match T::deserialize(top) {
            Ok(value) => return issues.or_ok(value),
            Err(fault) => {
                let mut steps: Vec<String> = fault.reversed_path.iter().rev().cloned().collect();
                let mut path = KeyPath::root();
                for step in &steps {
                    path = path.key(step);
                }
                issues.push(
                    Issue {
                        labels_key: fault.at_key,
                        ..Issue::new(path, fault.message)
                    }
                    .with_help(fault.help),
                );
                if issues.0.len() >= MOST_FAULTS {
                    return Err(issues);
                }
                // A table without its kind has no meaning, so the whole table is removed. Elements
                // of arrays stay, so that the numbers of the following elements do not change.
                if steps.last().is_some_and(|step| step == KIND) {
                    steps.pop();
                }
                while !remove(&mut rest, &steps) {
                    if steps.pop().is_none() {
                        return Err(issues);
                    }
                }
            }
        }
    }
}

/// Removes the key at a path of table keys and array indices; `false` if the path does not end at
/// a key.
fn remove(node: &mut Node, steps: &[String]) -> bool {
    match (steps, &mut node.value) {
        ([last], Value::Table(_)) => node.remove(last).is_some(),
        ([first, rest @ ..], Value::Table(entries)) => entries
            .iter_mut()
            .find(|entry| entry.key == *first)
            .is_some_and(|entry| remove(&mut entry.node, rest)),
        ([first, rest @ ..], Value::Array(elements)) => first
            .parse()
            .ok()
            .and_then(|index: usize| elements.get_mut(index))
            .is_some_and(|element| remove(element, rest)),
        _ => false,
    }
}

/// Reason and place of a decoding fault.
#[derive(Debug)]
pub struct Fault {
    message: String,
    help: Option<String>,
    /// Steps from the fault up to the top.
    reversed_path: Vec<String>,
    at_key: bool,
}

impl Fault {
    fn below(mut self, step: &str) -> Self {
        self.reversed_path.push(step.to_owned());
        self
    }

    fn with_help(mut self, help: Option<String>) -> Self {
        self.help = help;
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

impl de::Error for Fault {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self {
            message: message.to_string(),
            help: None,
            reversed_path: Vec::new(),
            at_key: false,
        }
    }
}

fn expected(what: impl fmt::Display, found: &Node) -> Fault {
    de::Error::custom(format_args!(
        "expected {what}, found {}",
        found.description()
    ))
}

/// The top of a document. Other code decodes some of its keys.
struct Top<'a> {
    node: &'a Node,
    beside: &'a [&'a str],
}

impl<'de> de::Deserializer<'de> for Top<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.node.deserialize_any(visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match &self.node.value {
            Value::Table(entries) => {
                visitor.visit_map(Entries::strict(entries, fields, self.beside)?)
            }
            _ => self.node.deserialize_struct(name, fields, visitor),
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

impl<'de> de::Deserializer<'de> for &'de Node {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.value {
            Value::Boolean(boolean) => visitor.visit_bool(*boolean),
            Value::Integer(integer) => visitor.visit_i64(*integer),
            Value::Float(float) => visitor.visit_f64(*float),
            Value::String(text) => visitor.visit_str(text),
            Value::Datetime => Err(expected("a number or text", self)),
            Value::Array(elements) => visitor.visit_seq(Elements { elements, next: 0 }),
            Value::Table(entries) => visitor.visit_map(Entries::new(entries)),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value {
            Value::Boolean(boolean) => visitor.visit_bool(boolean),
            _ => Err(expected("`true` or `false`", self)),
        }
    }

    fn deserialize_i64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value {
            Value::Integer(integer) => visitor.visit_i64(integer),
            _ => Err(expected("a whole number", self)),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.value {
            Value::String(text) => visitor.visit_str(text),
            _ => Err(expected("text in quotes", self)),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.value {
            Value::Array(elements) => visitor.visit_seq(Elements { elements, next: 0 }),
            _ => Err(expected("an array", self)),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match &self.value {
            Value::Array(elements) if elements.len() == length => {
                visitor.visit_seq(Elements { elements, next: 0 })
            }
            Value::Array(elements) => Err(de::Error::custom(format_args!(
                "expected an array of {length} values, found {}",
                elements.len()
            ))),
            _ => Err(expected(format_args!("an array of {length} values"), self)),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match &self.value {
            Value::Table(entries) => visitor.visit_map(Entries::strict(entries, fields, &[])?),
            _ => Err(expected("a table", self).with_help(keys_in_words(fields))),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let (kind, entries, at_kind): (&str, &[Entry], bool) = match &self.value {
            Value::String(kind) => (kind, &[], false),
            Value::Table(entries) => match self.entry(KIND).map(|entry| &entry.node.value) {
                Some(Value::String(kind)) => (kind, entries, true),
                Some(_) => return Err(expected("text in quotes", self).below(KIND)),
                None => {
                    return Err(de::Error::custom(format_args!(
                        "missing key `{KIND}`; allowed: {}",
                        variants.join(", ")
                    )));
                }
            },
            _ => {
                return Err(expected(
                    format_args!("one of {}", variants.join(", ")),
                    self,
                ));
            }
        };
        let Some(variant) = variants.iter().find(|variant| **variant == kind) else {
            let fault: Fault = de::Error::custom(format_args!(
                "{kind:?} is not a valid value; allowed: {}",
                variants.join(", ")
            ));
            let fault = fault.with_help(did_you_mean(kind, variants.iter().copied()));
            return Err(if at_kind { fault.below(KIND) } else { fault });
        };
        visitor.visit_enum(Variant {
            name: variant,
            entries,
        })
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_unit()
    }

    serde::forward_to_deserialize_any! {
        i8 i16 i32 i128 u8 u16 u32 u64 u128 f32 f64 char str bytes byte_buf unit unit_struct
        tuple_struct map identifier
    }
}

/// The key whose value names the variant of an enum.
const KIND: &str = "kind";

fn keys_in_words(fields: &[&str]) -> Option<String> {
    Some(format!("its keys are: {}", fields.join(", ")))
}

struct Elements<'a> {
    elements: &'a [Node],
    next: usize,
}

impl<'a> SeqAccess<'a> for Elements<'a> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'a>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Fault> {
        let Some(element) = self.elements.get(self.next) else {
            return Ok(None);
        };
        let index = self.next;
        self.next += 1;
        seed.deserialize(element)
            .map(Some)
            .map_err(|fault| fault.below(&index.to_string()))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.elements.len() - self.next)
    }
}

struct Entries<'a> {
    entries: std::slice::Iter<'a, Entry>,
    current: Option<&'a Entry>,
    skipped: &'a [&'a str],
}

impl<'a> Entries<'a> {
    fn new(entries: &'a [Entry]) -> Self {
        Self {
            entries: entries.iter(),
            current: None,
            skipped: &[],
        }
    }

    /// The entries of a table that may have only the given keys. The keys `skipped` are ignored.
    fn strict(
        entries: &'a [Entry],
        fields: &'static [&'static str],
        skipped: &'a [&'a str],
    ) -> Result<Self, Fault> {
        let unknown = entries.iter().find(|entry| {
            let key = entry.key.as_str();
            !fields.contains(&key) && !skipped.contains(&key)
        });
        match unknown {
            None => Ok(Self {
                skipped,
                ..Self::new(entries)
            }),
            Some(entry) => Err(Fault {
                message: "unknown key".to_owned(),
                help: {
                    // The kind of a table is its name, not one of its keys.
                    let others = skipped.iter().filter(|key| **key != KIND);
                    let known: Vec<&str> = fields.iter().chain(others).copied().collect();
                    did_you_mean(&entry.key, known.iter().copied())
                        .or_else(|| keys_in_words(&known))
                },
                reversed_path: vec![entry.key.clone()],
                at_key: true,
            }),
        }
    }
}

impl<'a> MapAccess<'a> for Entries<'a> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'a>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Fault> {
        self.current = self
            .entries
            .find(|entry| !self.skipped.contains(&entry.key.as_str()));
        self.current
            .map(|entry| seed.deserialize(entry.key.as_str().into_deserializer()))
            .transpose()
    }

    fn next_value_seed<V: DeserializeSeed<'a>>(&mut self, seed: V) -> Result<V::Value, Fault> {
        let entry = self
            .current
            .ok_or_else(|| <Fault as de::Error>::custom("a value was asked for before its key"))?;
        seed.deserialize(&entry.node)
            .map_err(|fault| fault.below(&entry.key))
    }
}

struct Variant<'a> {
    name: &'static str,
    entries: &'a [Entry],
}

impl<'a> EnumAccess<'a> for Variant<'a> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'a>>(self, seed: V) -> Result<(V::Value, Self), Fault> {
        let name = seed.deserialize(de::value::StrDeserializer::<Fault>::new(self.name))?;
        Ok((name, self))
    }
}

impl<'a> VariantAccess<'a> for Variant<'a> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        Entries::strict(self.entries, &[], &[KIND]).map(|_| ())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'a>>(self, seed: T) -> Result<T::Value, Fault> {
        seed.deserialize(Fields(self.entries))
    }

    fn tuple_variant<V: Visitor<'a>>(self, _: usize, _: V) -> Result<V::Value, Fault> {
        Err(de::Error::custom("kinds have named keys only"))
    }

    fn struct_variant<V: Visitor<'a>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        visitor.visit_map(Entries::strict(self.entries, fields, &[KIND])?)
    }
}

/// The keys of a table besides `kind`.
struct Fields<'a>(&'a [Entry]);

impl<'de> de::Deserializer<'de> for Fields<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_map(Entries::new(self.0))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        visitor.visit_map(Entries::strict(self.0, fields, &[KIND])?)
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}
