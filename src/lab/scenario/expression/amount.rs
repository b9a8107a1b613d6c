//! Numbers with a physical dimension.

use crate::scenario::units::{self, Powers};

/// A number in SI units, and the powers of metre, second and kilogram in its unit. Angles are pure
/// numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amount {
    /// The number in SI units.
    pub value: f64,
    /// Powers of metre, second and kilogram.
    pub powers: Powers,
}

impl Amount {
    /// A number without a dimension.
    pub const fn pure(value: f64) -> Self {
        let powers = [0; 3];
        Self { value, powers }
    }

    /// Another number of the same dimension.
    pub const fn with(self, value: f64) -> Self {
        Self { value, ..self }
    }

    /// Dimension of the amount in words, such as "a length".
    pub fn dimension(&self) -> String {
        units::dimension_of(self.powers)
    }

    /// The number, if it is dimensionless.
    ///
    /// # Errors
    /// A message with the actual dimension; `what` names the function that needs a pure number.
    pub fn pure_number(&self, what: &str) -> Result<f64, String> {
        match self.powers {
            [0, 0, 0] => Ok(self.value),
            _ => Err(format!(
                "{what} needs a pure number, found {}",
                self.dimension()
            )),
        }
    }

    /// Rejects another dimension. `doing` is the failed operation, such as "cannot be added to".
    ///
    /// # Errors
    /// A message that names both dimensions.
    pub fn must_match(&self, other: &Self, doing: &str) -> Result<(), String> {
        if self.powers == other.powers {
            return Ok(());
        }
        Err(format!(
            "{} {doing} {}",
            other.dimension(),
            self.dimension()
        ))
    }

    /// The product of numbers and dimensions.
    pub fn times(&self, other: &Self) -> Self {
        self.combined(other, 1, self.value * other.value)
    }

    /// The quotient of numbers and dimensions.
    pub fn over(&self, other: &Self) -> Self {
        self.combined(other, -1, self.value / other.value)
    }

    fn combined(&self, other: &Self, sign: i32, value: f64) -> Self {
        let power = |axis: usize| self.powers[axis].saturating_add(sign * other.powers[axis]);
        Self {
            value,
            powers: [power(0), power(1), power(2)],
        }
    }

    /// The power with a dimensionless exponent.
    ///
    /// # Errors
    /// A message, if the exponent has a dimension, or if the powers of units in the result would
    /// be fractions.
    pub fn raised(&self, exponent: &Self) -> Result<Self, String> {
        let exponent = exponent.pure_number("an exponent")?;
        let power = |power: i32| {
            let product = f64::from(power) * exponent;
            let is_usable = product == product.round() && product.abs() < 1e3;
            // Whole numbers in this range are exact.
            is_usable.then_some(product as i32)
        };
        let [length, time, mass] = self.powers;
        match (power(length), power(time), power(mass)) {
            (Some(length), Some(time), Some(mass)) => Ok(Self {
                value: libm::pow(self.value, exponent),
                powers: [length, time, mass],
            }),
            _ => Err(format!(
                "{} to the power of {exponent} would have fractional powers of units",
                self.dimension()
            )),
        }
    }
}
