//! Forms of keys: how a value is typed, checked and described. Declarations of tables
//! ([`keys!`](super::declaration)) name a form for each key.

use super::place::{Place, TypedPlace};
use super::quantity::{Quantity, Vector};
use super::section::{FINITE, NON_NEGATIVE, Range, Section};
use super::units::{Dimension, Dimensionless, Time};
use schemars::Schema;
use schemars::transform::Transform;
use serde::Serialize;
use serde_json::Value as Json;
use std::marker::PhantomData;
use std::ops::RangeInclusive;

/// The form of a key.
pub trait Form {
    /// The value as typed.
    type Typed;
    /// The value in SI units.
    type Value;

    /// The checked value; a fault is reported.
    fn judge(&self, section: &Section<'_>, key: &str, typed: &Self::Typed) -> Self::Value;

    /// The range in words.
    fn range(&self) -> Option<String> {
        None
    }

    /// The SI unit.
    fn unit(&self) -> Option<&'static str> {
        None
    }

    /// The value, if it is given.
    fn optional(
        &self,
        section: &Section<'_>,
        key: &str,
        typed: &Option<Self::Typed>,
    ) -> Option<Self::Value> {
        typed.as_ref().map(|typed| self.judge(section, key, typed))
    }
}

/// The form of a key that may be required.
pub trait Requirable: Form {
    /// Advice if the key is missing.
    fn help(&self) -> String;

    /// Placeholder for a missing value, which has been reported.
    fn nothing(&self) -> Self::Value;

    /// The value of a required key.
    fn required(
        &self,
        section: &Section<'_>,
        key: &str,
        typed: &Option<Self::Typed>,
    ) -> Self::Value {
        self.optional(section, key, typed).unwrap_or_else(|| {
            section.missing(key, self.help());
            self.nothing()
        })
    }
}

fn si_unit<D: Dimension>() -> Option<&'static str> {
    D::UNITS.first().map(|unit| unit.symbol)
}

/// A number with a unit, in a range.
pub struct Number<D>(Range, PhantomData<D>);

impl<D: Dimension> Number<D> {
    /// Numbers in this range.
    pub fn new(range: Range) -> Self {
        Self(range, PhantomData)
    }
}

impl<D: Dimension> Form for Number<D> {
    type Typed = Quantity<D>;
    type Value = f64;

    fn judge(&self, section: &Section<'_>, key: &str, typed: &Quantity<D>) -> f64 {
        section.number(key, typed, self.0)
    }

    fn range(&self) -> Option<String> {
        self.0.limits()
    }

    fn unit(&self) -> Option<&'static str> {
        si_unit::<D>()
    }
}

impl<D: Dimension> Requirable for Number<D> {
    fn help(&self) -> String {
        format!("{}, {}", D::NAME, self.0.words())
    }

    fn nothing(&self) -> f64 {
        f64::NAN
    }
}

/// Several numbers with the same unit, such as the components of a vector, each in a range.
pub struct Numbers<D, const N: usize>(Range, PhantomData<D>);

impl<D: Dimension, const N: usize> Numbers<D, N> {
    /// Numbers in this range.
    pub fn new(range: Range) -> Self {
        Self(range, PhantomData)
    }
}

impl<D: Dimension, const N: usize> Form for Numbers<D, N> {
    type Typed = [Quantity<D>; N];
    type Value = [f64; N];

    fn judge(&self, section: &Section<'_>, key: &str, typed: &[Quantity<D>; N]) -> [f64; N] {
        let below = section.below(key);
        std::array::from_fn(|index| below.number(&index.to_string(), &typed[index], self.0))
    }

    fn range(&self) -> Option<String> {
        self.0.limits()
    }

    fn unit(&self) -> Option<&'static str> {
        si_unit::<D>()
    }
}

impl<D: Dimension, const N: usize> Requirable for Numbers<D, N> {
    fn help(&self) -> String {
        match N {
            3 => format!("three numbers [x, y, z], each {}", D::NAME),
            _ => format!("{N} numbers, each {}", D::NAME),
        }
    }

    fn nothing(&self) -> [f64; N] {
        [f64::NAN; N]
    }
}

/// A direction, normalised to a unit vector.
pub struct Direction;

impl Form for Direction {
    type Typed = Vector<Dimensionless>;
    type Value = [f64; 3];

    fn judge(&self, section: &Section<'_>, key: &str, typed: &Vector<Dimensionless>) -> [f64; 3] {
        section.unit_vector(key, typed)
    }

    fn range(&self) -> Option<String> {
        Some("any length but 0".to_owned())
    }
}

impl Requirable for Direction {
    fn help(&self) -> String {
        "a direction [x, y, z]".to_owned()
    }

    fn nothing(&self) -> [f64; 3] {
        [f64::NAN; 3]
    }
}

/// A value that needs no check, such as a word, true or false, or text.
pub struct Plain<T> {
    help: &'static str,
    value: PhantomData<T>,
}

impl<T> Plain<T> {
    /// Such a value; `help` is the advice if it is missing.
    pub fn new(help: &'static str) -> Self {
        Self {
            help,
            value: PhantomData,
        }
    }
}

impl<T: Clone> Form for Plain<T> {
    type Typed = T;
    type Value = T;

    fn judge(&self, _: &Section<'_>, _: &str, typed: &T) -> T {
        typed.clone()
    }
}

impl<T: Clone + Default> Requirable for Plain<T> {
    fn help(&self) -> String {
        self.help.to_owned()
    }

    fn nothing(&self) -> T {
        T::default()
    }
}

/// A name that can be the prefix of columns of results.
pub struct ColumnName;

impl Form for ColumnName {
    type Typed = String;
    type Value = String;

    fn judge(&self, section: &Section<'_>, key: &str, name: &String) -> String {
        let allowed =
            |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_';
        let begins = name.starts_with(|letter: char| letter.is_ascii_lowercase());
        if begins && name.chars().all(allowed) && !name.ends_with('_') {
            return name.clone();
        }
        let message = format!(
            "`{name}` cannot begin the name of a column; allowed: small letters, digits and underscores, a letter first \
             and no underscore last"
        );
        section.fault(key, message);
        self.nothing()
    }
}

impl Requirable for ColumnName {
    fn help(&self) -> String {
        "the name with which the columns begin".to_owned()
    }

    fn nothing(&self) -> String {
        String::new()
    }
}

/// A whole number.
pub struct Count(pub RangeInclusive<usize>);

impl Form for Count {
    type Typed = i64;
    type Value = usize;

    fn judge(&self, section: &Section<'_>, key: &str, typed: &i64) -> usize {
        let count = section.count(key, Some(*typed), self.0.clone());
        count.unwrap_or(self.nothing())
    }

    fn range(&self) -> Option<String> {
        Some(format!("{} to {}", self.0.start(), self.0.end()))
    }
}

impl Requirable for Count {
    fn help(&self) -> String {
        format!("a whole number, {} to {}", self.0.start(), self.0.end())
    }

    fn nothing(&self) -> usize {
        *self.0.start()
    }
}

/// A number counted from zero.
pub struct Index;

impl Form for Index {
    type Typed = i64;
    type Value = usize;

    fn judge(&self, section: &Section<'_>, key: &str, typed: &i64) -> usize {
        section.number_from_zero(key, *typed).unwrap_or(0)
    }

    fn range(&self) -> Option<String> {
        Some("0 and up".to_owned())
    }
}

/// A place along a rod.
pub struct Along;

impl Form for Along {
    type Typed = TypedPlace;
    type Value = Place;

    fn judge(&self, section: &Section<'_>, key: &str, typed: &TypedPlace) -> Place {
        section.place(key, *typed)
    }
}

impl Requirable for Along {
    fn help(&self) -> String {
        "\"start\", \"end\", or a number counted from zero".to_owned()
    }

    fn nothing(&self) -> Place {
        Place::Start
    }
}

/// A place along each of two rods.
pub struct AlongBoth(pub &'static str);

impl Form for AlongBoth {
    type Typed = [TypedPlace; 2];
    type Value = [Place; 2];

    fn judge(&self, section: &Section<'_>, key: &str, typed: &[TypedPlace; 2]) -> [Place; 2] {
        let below = section.below(key);
        std::array::from_fn(|k| below.place(&k.to_string(), typed[k]))
    }
}

impl Requirable for AlongBoth {
    fn help(&self) -> String {
        self.0.to_owned()
    }

    fn nothing(&self) -> [Place; 2] {
        [Place::Start; 2]
    }
}

/// Corners of a piecewise linear function of time, [[time, value], ...].
pub struct Corners<D>(PhantomData<D>);

impl<D: Dimension> Corners<D> {
    /// Any values.
    pub fn any() -> Self {
        Self(PhantomData)
    }
}

impl<D: Dimension> Form for Corners<D> {
    type Typed = Vec<(Quantity<Time>, Quantity<D>)>;
    type Value = Vec<(f64, f64)>;

    fn judge(&self, section: &Section<'_>, key: &str, typed: &Self::Typed) -> Vec<(f64, f64)> {
        section.corners(key, typed, |corner, value| {
            corner.number("1", value, FINITE)
        })
    }

    fn range(&self) -> Option<String> {
        Some(format!("times {} that grow", NON_NEGATIVE.words()))
    }
}

impl<D: Dimension> Requirable for Corners<D> {
    fn help(&self) -> String {
        format!("corners [[time, value], ...], each value {}", D::NAME)
    }

    fn nothing(&self) -> Vec<(f64, f64)> {
        Vec::new()
    }
}

/// A table below the key.
pub struct Nested<T, V>(pub fn(&T, &Section<'_>) -> V);

impl<T, V> Form for Nested<T, V> {
    type Typed = T;
    type Value = V;

    fn judge(&self, section: &Section<'_>, key: &str, typed: &T) -> V {
        (self.0)(typed, &section.below(key))
    }
}

/// Notes of the schema on a key in addition to its description: whether it is required, its range,
/// unit and default.
#[derive(Default)]
pub struct Note {
    range: Option<String>,
    unit: Option<&'static str>,
    is_required: bool,
    default: Option<Json>,
}

impl Note {
    /// The note of an optional key.
    pub fn of(form: &impl Form) -> Self {
        Self {
            range: form.range(),
            unit: form.unit(),
            ..Self::default()
        }
    }

    /// Marks the key as required.
    #[must_use]
    pub fn required(self) -> Self {
        Self {
            is_required: true,
            ..self
        }
    }

    /// Adds the default of the key.
    #[must_use]
    pub fn with_default(self, default: &impl Serialize) -> Self {
        Self {
            default: serde_json::to_value(default).ok().map(whole),
            ..self
        }
    }
}

/// A default with whole numbers in their usual form.
fn whole(value: Json) -> Json {
    match value {
        Json::Array(elements) => elements.into_iter().map(whole).collect(),
        Json::Number(number) => match number.as_f64() {
            Some(float) if float.fract() == 0.0 && float.abs() < 1e6 => (float as i64).into(),
            _ => Json::Number(number),
        },
        other => other,
    }
}

/// A default in its usual form.
fn in_words(value: &Json) -> String {
    match value {
        Json::Array(elements) => {
            let elements: Vec<String> = elements.iter().map(in_words).collect();
            format!("[{}]", elements.join(", "))
        }
        other => other.to_string(),
    }
}

impl Transform for Note {
    fn transform(&mut self, schema: &mut Schema) {
        let words = schema.get("description").and_then(Json::as_str);
        let words = words.unwrap_or_default().to_owned();
        let names_default = words.contains("efault");
        if let Some(range) = self.range.take() {
            schema.insert("x-range".to_owned(), range.into());
        }
        if let Some(unit) = self.unit {
            schema.insert("x-unit".to_owned(), unit.into());
        }
        if self.is_required && !names_default {
            schema.insert("x-required".to_owned(), true.into());
        }
        if let Some(default) = self.default.take() {
            if !names_default {
                let unit = self
                    .unit
                    .filter(|_| default.as_f64().is_some_and(|value| value != 0.0));
                let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
                let words = format!("{words} Default: {}{unit}.", in_words(&default));
                schema.insert("description".to_owned(), words.into());
            }
            schema.insert("x-default".to_owned(), default);
        }
    }
}
