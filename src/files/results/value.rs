//! Values with column names, which observers of a run add to `series.csv` and to `summary.csv`.

use serde::de::{self, Deserialize, Deserializer, MapAccess, Visitor};
use serde::ser::{Serialize, Serializer};
use std::fmt;

/// A cell of a table.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(remote = "Self")]
pub enum Value {
    /// No value.
    Empty,
    /// `true` or `false`.
    Flag(bool),
    /// An integer.
    Integer(u64),
    /// A number.
    Number(f64),
    /// Text.
    Text(String),
}

impl Value {
    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(number) => Some(*number as f64),
            Self::Number(number) => Some(*number),
            Self::Empty | Self::Flag(_) | Self::Text(_) => None,
        }
    }

    /// The text, if it is one.
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => Ok(()),
            Self::Flag(flag) => flag.fmt(f),
            Self::Integer(number) => number.fmt(f),
            Self::Number(number) => number.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u64> for Value {
    fn from(number: u64) -> Self {
        Self::Integer(number)
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl<T: Into<Self>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// Tables and JSON store the bare value; formats that are not self-describing also store its kind.
impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !serializer.is_human_readable() {
            return Self::serialize(self, serializer);
        }
        match self {
            Self::Empty => serializer.serialize_none(),
            Self::Flag(flag) => serializer.serialize_bool(*flag),
            Self::Integer(number) => serializer.serialize_u64(*number),
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::Text(text) => serializer.serialize_str(text),
        }
    }
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            return Self::deserialize(deserializer);
        }
        deserializer.deserialize_any(ValueVisitor)
    }
}

struct ValueVisitor;

impl Visitor<'_> for ValueVisitor {
    type Value = Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number, text, true, false or null")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Empty)
    }

    fn visit_bool<E>(self, flag: bool) -> Result<Value, E> {
        Ok(Value::Flag(flag))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Value, E> {
        Ok(Value::Integer(number))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Value, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Value, E> {
        Ok(Value::Number(number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Text(text.to_owned()))
    }
}

/// Values by the names of their columns, in order; a map in JSON.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedValues(pub Vec<(String, Value)>);

impl NamedValues {
    /// The value in a column; `None` if there is no such column.
    pub fn get(&self, name: &str) -> Option<&Value> {
        let found = self.0.iter().find(|(column, _)| column == name);
        found.map(|(_, value)| value)
    }

    /// The number in a column; `None` if there is none.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.get(name)?.number()
    }

    /// Names of the columns.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(name, _)| name.as_str())
    }
}

impl<'a, const N: usize> From<[(&'a str, Value); N]> for NamedValues {
    fn from(values: [(&'a str, Value); N]) -> Self {
        Self(values.map(|(name, value)| (name.to_owned(), value)).into())
    }
}

impl Serialize for NamedValues {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

impl<'de> Deserialize<'de> for NamedValues {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            deserializer.deserialize_any(NamedValuesVisitor)
        } else {
            deserializer.deserialize_map(NamedValuesVisitor)
        }
    }
}

struct NamedValuesVisitor;

impl<'de> Visitor<'de> for NamedValuesVisitor {
    type Value = NamedValues;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a map from names to values")
    }

    /// Manifests of earlier versions contain `null` if nothing was observed.
    fn visit_unit<E: de::Error>(self) -> Result<NamedValues, E> {
        Ok(NamedValues::default())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<NamedValues, A::Error> {
        let mut values = Vec::new();
        while let Some(entry) = map.next_entry()? {
            values.push(entry);
        }
        Ok(NamedValues(values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values() -> NamedValues {
        NamedValues::from([
            ("z", Value::from(0.1)),
            ("a", Value::from(3_u64)),
            ("may", Value::from(true)),
            ("word", Value::from("locked")),
            ("none", Value::from(None::<f64>)),
            ("whole", Value::from(2.0)),
            ("below", Value::from(-2.0)),
        ])
    }

    #[test]
    fn names_order_and_kinds_survive_json_and_checkpoints() {
        let json = serde_json::to_string(&values()).unwrap();
        assert_eq!(
            json,
            r#"{"z":0.1,"a":3,"may":true,"word":"locked","none":null,"whole":2.0,"below":-2.0}"#
        );
        assert_eq!(
            serde_json::from_str::<NamedValues>(&json).unwrap(),
            values()
        );
        let bytes = postcard::to_stdvec(&values()).unwrap();
        assert_eq!(
            postcard::from_bytes::<NamedValues>(&bytes).unwrap(),
            values()
        );
    }

    #[test]
    fn null_reads_as_no_values() {
        let read: NamedValues = serde_json::from_str("null").unwrap();
        assert_eq!(read, NamedValues::default());
    }
}
