//! One case of a sweep: its values and its id.

use crate::scenario::document::Value;
use crate::scenario::document_values;
use crate::scenario::units::parse_any;
use std::fmt::Write;

/// Maximum length of the readable part of an id.
const SLUG_LENGTH: usize = 60;
/// Number of hexadecimal digits of the hash in an id: 64 bits, so that two of a million cases have
/// the same hash with a probability of 3·10⁻⁸.
const HASH_DIGITS: usize = 16;

/// One case of a sweep.
#[derive(Clone, Debug)]
pub struct Case {
    /// Readable id, independent of the other cases and their order.
    pub id: String,
    /// The varied keys and their values, in the order of the sweep.
    pub parameters: Vec<Parameter>,
}

/// A key and its value in one case.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// The dotted key.
    pub key: String,
    /// The value as typed.
    pub typed: String,
    /// The value in SI units, if it is a number.
    pub number: Option<f64>,
}

impl Parameter {
    /// A key and its value.
    pub fn new(key: &str, value: &Value) -> Self {
        let number = match value {
            Value::Integer(integer) => Some(*integer as f64),
            Value::Float(float) => Some(*float),
            Value::String(text) => parse_any(text),
            _ => None,
        };
        let typed = match value {
            Value::String(text) => text.clone(),
            other => document_values::inline(other),
        };
        Self {
            key: key.to_owned(),
            typed,
            number,
        }
    }

    /// The value as shown in tables: numbers in SI units.
    pub fn column(&self) -> String {
        match self.number {
            Some(_) if self.typed.parse::<i64>().is_ok() => self.typed.clone(),
            Some(number) => format!("{number:?}"),
            None => self.typed.clone(),
        }
    }
}

impl Case {
    /// The case with these values.
    pub fn new(parameters: Vec<Parameter>) -> Self {
        Self {
            id: id(&parameters),
            parameters,
        }
    }
}

/// The id of the case in earlier versions: it had half as many digits of the same hash.
pub fn earlier_id(id: &str) -> &str {
    &id[..id.len() - HASH_DIGITS / 2]
}

/// A slug of the last steps of the keys and their values, followed by a hash of all keys and
/// values.
fn id(parameters: &[Parameter]) -> String {
    let mut sorted: Vec<&Parameter> = parameters.iter().collect();
    sorted.sort_by(|a, b| a.key.cmp(&b.key));
    let (mut slug, mut identity) = (String::new(), String::new());
    for parameter in sorted {
        let name = parameter.key.rsplit('.').next().unwrap_or_default();
        // Writing to a string cannot fail.
        let _ = write!(slug, "{name}-{} ", parameter.typed.replace(' ', ""));
        let _ = writeln!(identity, "{}={}", parameter.key, parameter.typed);
    }
    let allowed = |c: char| {
        if c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+') {
            c
        } else {
            '_'
        }
    };
    let slug: String = slug.trim().chars().map(allowed).take(SLUG_LENGTH).collect();
    let slug = slug.trim_start_matches('.');
    let hash = blake3::hash(identity.as_bytes()).to_hex();
    format!("{slug}-{}", &hash[..HASH_DIGITS])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn case(parameters: &[(&str, Value)]) -> Case {
        let parameter = |(key, value): &(&str, Value)| Parameter::new(key, value);
        Case::new(parameters.iter().map(parameter).collect())
    }

    #[test]
    fn ids_are_readable_and_do_not_depend_on_the_order_of_the_keys() {
        let radius = ("rods.rope.radius", Value::String("1.5 mm".into()));
        let friction = ("contact.friction", Value::Float(0.3));
        let one = case(&[radius.clone(), friction.clone()]);
        assert!(
            one.id.starts_with("friction-0.3_radius-1.5mm-"),
            "{}",
            one.id
        );
        assert_eq!(case(&[friction, radius]).id, one.id);
    }

    #[test]
    fn earlier_ids_are_those_of_eight_digits() {
        let id = case(&[("contact.friction", Value::Float(0.3))]).id;
        assert!(
            id.starts_with("friction-0.3-") && id.len() == "friction-0.3-".len() + 16,
            "{id}"
        );
        assert_eq!(earlier_id(&id).len(), "friction-0.3-".len() + 8);
    }

    #[test]
    fn other_keys_of_the_same_name_give_another_id() {
        let one = case(&[("rods.a.radius", Value::Float(0.3))]);
        let other = case(&[("rods.b.radius", Value::Float(0.3))]);
        assert_ne!(one.id, other.id);
    }

    #[test]
    fn columns_are_in_si_units() {
        let column = |value| Parameter::new("key", &value).column();
        assert_eq!(column(Value::String("1.5 mm".into())), "0.0015");
        assert_eq!(column(Value::String("imc".into())), "imc");
        assert_eq!(column(Value::Integer(3)), "3");
        assert_eq!(column(Value::Float(3.0)), "3.0");
        assert_eq!(column(Value::Boolean(true)), "true");
    }

    proptest! {
        #[test]
        fn ids_are_names_of_folders(key in "[a-z.]{1,30}", text in ".{0,80}") {
            let id = case(&[(&key, Value::String(text))]).id;
            prop_assert!(id.len() <= SLUG_LENGTH + 1 + HASH_DIGITS);
            prop_assert!(!id.starts_with('.'));
            prop_assert!(id.chars().all(|c| c.is_ascii_alphanumeric() || "._-+".contains(c)));
        }
    }
}
