//! Ranges of numbers in one unit.

use crate::scenario::document::Value;
use crate::scenario::units::split_number;

/// A number as typed: its value in front of its unit, and whether it was typed as a whole number.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// The number in front of the unit.
    pub value: f64,
    /// The unit; empty for SI units.
    pub unit: String,
    /// Whether it was typed without a fraction and without a unit.
    pub whole: bool,
}

impl Number {
    /// Reads a number, or text with a unit.
    ///
    /// # Errors
    /// A message with the fault.
    pub fn read(value: &Value) -> Result<Self, String> {
        let number = match value {
            Value::Integer(integer) => Self {
                value: *integer as f64,
                unit: String::new(),
                whole: true,
            },
            Value::Float(float) => Self {
                value: *float,
                unit: String::new(),
                whole: false,
            },
            Value::String(text) => {
                let (value, unit) = split_number(text)?;
                Self {
                    value,
                    unit: unit.to_owned(),
                    whole: unit.is_empty() && text.trim().parse::<i64>().is_ok(),
                }
            }
            _ => return Err("expected a number, or text with a unit".to_owned()),
        };
        if number.value.is_finite() {
            Ok(number)
        } else {
            Err(format!("{} is not a finite number", number.value))
        }
    }
}

/// Spacing of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// By equal differences.
    Linear,
    /// By equal ratios.
    Log,
}

/// An interval of numbers in one unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Interval {
    from: f64,
    to: f64,
    unit: String,
    whole: bool,
    scale: Scale,
}

impl Interval {
    /// The interval between two numbers.
    ///
    /// # Errors
    /// A message, if the units differ, or if ends of a logarithmic scale are not positive.
    pub fn new(from: &Number, to: &Number, scale: Scale) -> Result<Self, String> {
        if from.unit != to.unit {
            return Err(format!(
                "both ends need the same unit; found {:?} and {:?}",
                from.unit, to.unit
            ));
        }
        if scale == Scale::Log && (from.value <= 0.0 || to.value <= 0.0) {
            return Err("a logarithmic scale needs ends greater than 0".to_owned());
        }
        Ok(Self {
            from: from.value,
            to: to.value,
            unit: from.unit.clone(),
            whole: from.whole && to.whole,
            scale,
        })
    }

    /// The value at a fraction of the distance from one end to the other.
    pub fn at(&self, fraction: f64) -> Value {
        let number = match (fraction, self.scale) {
            (0.0, _) => self.from,
            (1.0, _) => self.to,
            (_, Scale::Linear) => self.from + fraction * (self.to - self.from),
            (_, Scale::Log) => self.from * libm::pow(self.to / self.from, fraction),
        };
        self.value_of(number)
    }

    /// `count` values from the first end to the last.
    pub fn spaced(&self, count: usize) -> impl Iterator<Item = Value> + '_ {
        let last = count.saturating_sub(1).max(1) as f64;
        (0..count).map(move |index| self.at(index as f64 / last))
    }

    /// The values from the first end in equal steps, up to the last end.
    ///
    /// # Errors
    /// A message, if the steps do not lead from one end to the other, or if there would be more
    /// than `most` values.
    pub fn stepped(&self, step: f64, most: usize) -> Result<Vec<Value>, String> {
        let steps = (self.to - self.from) / step;
        if !(steps >= 0.0) {
            let [step, from, to] = [step, self.from, self.to].map(|number| self.text_of(number));
            let sign = if self.to < self.from {
                "below"
            } else {
                "above"
            };
            return Err(format!(
                "steps of {step} do not lead from {from} to {to}; allowed: a step {sign} 0"
            ));
        }
        // The last value counts even if round-off puts it slightly beyond the end.
        let last = (steps + 1e-9).floor();
        if last >= most as f64 {
            return Err(format!("{last} values are too many; at most {most}"));
        }
        let values = (0..=last as usize).map(|index| self.from + index as f64 * step);
        Ok(values.map(|number| self.value_of(number)).collect())
    }

    /// A number with its unit.
    fn text_of(&self, number: f64) -> String {
        match self.unit.as_str() {
            "" => number.to_string(),
            unit => format!("{number} {unit}"),
        }
    }

    fn value_of(&self, number: f64) -> Value {
        let number = rounded(number);
        if !self.unit.is_empty() {
            return Value::String(format!("{number:?} {}", self.unit));
        }
        if self.whole && number.fract() == 0.0 {
            return Value::Integer(number as i64);
        }
        Value::Float(number)
    }
}

/// The number rounded to 12 significant digits: 0.3 instead of 0.30000000000000004.
pub fn rounded(number: f64) -> f64 {
    format!("{number:.11e}")
        .parse()
        .expect("a number is written as a number")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(from: &str, to: &str, scale: Scale) -> Interval {
        let read = |text: &str| Number::read(&Value::String(text.into())).unwrap();
        Interval::new(&read(from), &read(to), scale).unwrap()
    }

    fn texts(values: impl IntoIterator<Item = Value>) -> Vec<String> {
        values
            .into_iter()
            .map(|value| match value {
                Value::Integer(integer) => integer.to_string(),
                Value::Float(float) => format!("{float:?}"),
                Value::String(text) => text,
                other => format!("{other:?}"),
            })
            .collect()
    }

    #[test]
    fn spaced_values_are_those_a_person_would_write() {
        assert_eq!(
            texts(interval("0.0", "0.5", Scale::Linear).spaced(6)),
            ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]
        );
        assert_eq!(
            texts(interval("1 mm", "100 mm", Scale::Log).spaced(3)),
            ["1.0 mm", "10.0 mm", "100.0 mm"]
        );
        assert_eq!(
            texts(interval("2", "8", Scale::Linear).spaced(3)),
            ["2", "5", "8"]
        );
        assert_eq!(texts(interval("2", "3", Scale::Linear).spaced(1)), ["2"]);
    }

    #[test]
    fn steps_end_at_the_last_value_that_fits() {
        let stepped = |from, to, step| {
            texts(
                interval(from, to, Scale::Linear)
                    .stepped(step, 100)
                    .unwrap(),
            )
        };
        assert_eq!(stepped("0.1", "0.4", 0.1), ["0.1", "0.2", "0.3", "0.4"]);
        assert_eq!(stepped("1", "6", 2.0), ["1", "3", "5"]);
        assert_eq!(stepped("3", "1", -1.0), ["3", "2", "1"]);
        let up = interval("0.0", "1.0", Scale::Linear);
        assert!(up.stepped(-0.1, 100).is_err());
        assert!(up.stepped(0.0, 100).is_err());
        assert!(up.stepped(1e-9, 100).is_err());
    }

    #[test]
    fn ends_must_fit_each_other() {
        let read = |text: &str| Number::read(&Value::String(text.into())).unwrap();
        assert!(Interval::new(&read("1 mm"), &read("1 m"), Scale::Linear).is_err());
        assert!(Interval::new(&read("0"), &read("1"), Scale::Log).is_err());
        assert!(Number::read(&Value::Boolean(true)).is_err());
        assert!(Number::read(&Value::Float(f64::NAN)).is_err());
    }
}
