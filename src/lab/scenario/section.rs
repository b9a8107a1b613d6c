//! Checks of the values of one table, and the collection of their faults.

use crate::scenario::issue::{Issue, Issues, KeyPath};
use crate::scenario::place::{Place, TypedPlace};
use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::units::{Dimension, Time};
use std::cell::RefCell;
use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Range of the numbers that a key allows.
#[derive(Clone, Copy)]
pub struct Range {
    allows: fn(f64) -> bool,
    words: &'static str,
}

impl Range {
    /// The range in words.
    pub fn words(self) -> &'static str {
        self.words
    }

    /// The range in words, if it excludes any finite numbers.
    pub fn limits(self) -> Option<String> {
        (self.words != FINITE.words).then(|| self.words.to_owned())
    }
}

/// Greater than 0.
pub const POSITIVE: Range = Range {
    allows: |value| value > 0.0,
    words: "greater than 0",
};
/// At least 0.
pub const NON_NEGATIVE: Range = Range {
    allows: |value| value >= 0.0,
    words: "at least 0",
};
/// Residual tolerances of Newton's method: larger ones would leave forces unbalanced.
pub const FORCE_TOLERANCE: Range = Range {
    allows: |value| value > 0.0 && value <= 1e-3,
    words: "greater than 0 and at most 0.001",
};
/// Errors and corrections of positions, in radii.
pub const DISPLACEMENT_TOLERANCE: Range = Range {
    allows: |value| value > 0.0 && value <= 1.0,
    words: "greater than 0 and at most 1",
};
/// Relative errors of a far field: none, or the range of its approximation.
pub const FAR_FIELD_ERROR: Range = Range {
    allows: |value| value == 0.0 || (1e-6..=1e-2).contains(&value),
    words: "0, or from 1e-6 to 1e-2",
};
/// Any finite number.
pub const FINITE: Range = Range {
    allows: f64::is_finite,
    words: "any finite number",
};
/// Between 0 and 1, both excluded.
pub const FRACTION: Range = Range {
    allows: |value| value > 0.0 && value < 1.0,
    words: "greater than 0 and less than 1",
};
/// Angles between two triangles of a smooth surface, rad.
pub const CREASE: Range = Range {
    allows: |value| (0.0..=FRAC_PI_2).contains(&value),
    words: "from 0 to 90 deg",
};
/// Poisson's ratios of stable isotropic materials.
pub const POISSONS_RATIO: Range = Range {
    allows: |value| value > -1.0 && value <= 0.5,
    words: "greater than -1 and at most 0.5",
};

/// Default of directions.
pub const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Largest magnitude of a number in SI units. Squares and products of three must not overflow;
/// physical quantities are far smaller.
pub const LARGEST: f64 = 1e100;

/// One table of the scenario: its path, and all faults found so far.
///
/// A faulty number is reported and becomes NaN; the scenario is discarded at the end.
pub struct Section<'a> {
    /// Path of the table.
    pub path: KeyPath,
    issues: &'a RefCell<Issues>,
    directory_of: &'a dyn Fn(&KeyPath) -> PathBuf,
}

impl<'a> Section<'a> {
    /// The table at `path`; `directory_of` returns the directory relative to which the value of a
    /// key names files.
    pub fn new(
        path: KeyPath,
        issues: &'a RefCell<Issues>,
        directory_of: &'a dyn Fn(&KeyPath) -> PathBuf,
    ) -> Self {
        Self {
            path,
            issues,
            directory_of,
        }
    }

    /// Path of the file that the value of `key` names.
    pub fn path_of(&self, key: &str, file: &str) -> PathBuf {
        (self.directory_of)(&self.path.key(key)).join(file)
    }

    /// The table or element below `key`.
    pub fn below(&self, key: &str) -> Self {
        Self::new(self.path.key(key), self.issues, self.directory_of)
    }

    /// The elements of the array `key`, each with its section.
    pub fn elements<'t, T>(
        &self,
        key: &str,
        typed: &'t [T],
    ) -> impl Iterator<Item = (Self, &'t T)> + use<'a, 't, T> {
        let array = self.below(key);
        let numbered = typed.iter().enumerate();
        numbered.map(move |(index, typed)| (array.below(&index.to_string()), typed))
    }

    /// Reports a fault of `key`.
    pub fn fault(&self, key: &str, message: impl Into<String>) {
        self.fault_with_help(key, message, None);
    }

    /// Reports a fault of `key`, with advice on what to type instead.
    pub fn fault_with_help(&self, key: &str, message: impl Into<String>, help: Option<String>) {
        let issue = Issue::new(self.path.key(key), message).with_help(help);
        self.issues.borrow_mut().push(issue);
    }

    /// Reports a value of `key` out of the allowed range.
    pub fn out_of_range(&self, key: &str, value: impl fmt::Debug, allowed: impl fmt::Display) {
        self.fault(
            key,
            format!("{value:?} is out of range; allowed: {allowed}"),
        );
    }

    /// Reports those of the given keys that are present.
    pub fn refuse(&self, keys: &[(&str, bool)], why: &str) {
        for (key, _) in keys.iter().filter(|(_, is_there)| *is_there) {
            self.fault(key, why);
        }
    }

    /// Reports that a key is missing.
    pub fn missing(&self, key: &str, help: impl Into<String>) {
        let issue = Issue::new(self.path.clone(), format!("missing key `{key}`"));
        self.issues.borrow_mut().push(issue.with_help(help.into()));
    }

    /// A required value.
    pub fn needed<T>(&self, key: &str, value: Option<T>, help: &str) -> Option<T> {
        if value.is_none() {
            self.missing(key, help);
        }
        value
    }

    /// A number, if it is given.
    pub fn optional<D: Dimension>(
        &self,
        key: &str,
        typed: &Option<Quantity<D>>,
        range: Range,
    ) -> Option<f64> {
        typed.as_ref().map(|typed| self.number(key, typed, range))
    }

    /// A required number.
    pub fn required<D: Dimension>(
        &self,
        key: &str,
        typed: &Option<Quantity<D>>,
        range: Range,
    ) -> f64 {
        self.optional(key, typed, range).unwrap_or_else(|| {
            self.missing(key, format!("{}, {}", D::NAME, range.words));
            f64::NAN
        })
    }

    /// A number with a default.
    pub fn with_default<D: Dimension>(
        &self,
        key: &str,
        typed: &Option<Quantity<D>>,
        range: Range,
        default: f64,
    ) -> f64 {
        self.optional(key, typed, range).unwrap_or(default)
    }

    /// One number.
    pub fn number<D: Dimension>(&self, key: &str, typed: &Quantity<D>, range: Range) -> f64 {
        match typed.si() {
            Ok(value) if (range.allows)(value) && value.abs() > LARGEST => {
                let allowed = format_args!("at most {LARGEST:e} in magnitude");
                self.out_of_range(key, value, allowed);
                f64::NAN
            }
            Ok(value) if (range.allows)(value) => value,
            Ok(value) => {
                self.out_of_range(key, value, range.words);
                f64::NAN
            }
            Err(message) => {
                self.fault(key, message);
                f64::NAN
            }
        }
    }

    /// A whole number within bounds; `None` if it is missing or out of range, which is reported.
    pub fn count(
        &self,
        key: &str,
        typed: Option<i64>,
        allowed: RangeInclusive<usize>,
    ) -> Option<usize> {
        let words = format!("{} to {}", allowed.start(), allowed.end());
        let Some(typed) = typed else {
            self.missing(key, format!("a whole number, {words}"));
            return None;
        };
        let count = usize::try_from(typed)
            .ok()
            .filter(|count| allowed.contains(count));
        if count.is_none() {
            self.out_of_range(key, typed, words);
        }
        count
    }

    /// A number counted from zero; `None` if it is negative, which is reported.
    pub fn number_from_zero(&self, key: &str, typed: i64) -> Option<usize> {
        let number = usize::try_from(typed).ok();
        if number.is_none() {
            self.out_of_range(key, typed, "0 and up");
        }
        number
    }

    /// A place along a rod; a faulty one becomes the start.
    pub fn place(&self, key: &str, typed: TypedPlace) -> Place {
        match typed {
            TypedPlace::Start => Place::Start,
            TypedPlace::End => Place::End,
            TypedPlace::Number(number) => {
                let number = self.number_from_zero(key, number);
                number.map_or(Place::Start, Place::Number)
            }
        }
    }

    /// A vector, if it is given.
    pub fn vector<D: Dimension>(&self, key: &str, typed: &Option<Vector<D>>) -> Option<[f64; 3]> {
        typed.as_ref().map(|typed| self.components(key, typed))
    }

    /// A direction: a vector of any length except zero, normalised to a unit vector.
    pub fn unit_vector<D: Dimension>(&self, key: &str, typed: &Vector<D>) -> [f64; 3] {
        let vector = self.components(key, typed);
        if vector.iter().any(|component| component.is_nan()) {
            return vector;
        }
        normalised(vector).unwrap_or_else(|| {
            self.fault(key, "a direction cannot be [0, 0, 0]");
            [f64::NAN; 3]
        })
    }

    /// Each component of an array of numbers.
    pub fn components<D: Dimension, const N: usize>(
        &self,
        key: &str,
        typed: &[Quantity<D>; N],
    ) -> [f64; N] {
        let below = self.below(key);
        std::array::from_fn(|index| below.number(&index.to_string(), &typed[index], FINITE))
    }

    /// Corners of a piecewise linear function: increasing times, each with a value.
    pub fn corners<T, V>(
        &self,
        key: &str,
        typed: &[(Quantity<Time>, T)],
        mut value: impl FnMut(&Section<'_>, &T) -> V,
    ) -> Vec<(f64, V)> {
        let mut corners: Vec<(f64, V)> = Vec::new();
        for (corner, (time, typed)) in self.elements(key, typed) {
            let time = corner.number("0", time, NON_NEGATIVE);
            if let Some((before, _)) = corners.last()
                && time <= *before
            {
                corner.fault(
                    "0",
                    format!("time {time:?} s is not after {before:?} s; times must increase"),
                );
            }
            let value = value(&corner, typed);
            corners.push((time, value));
        }
        corners
    }
}

/// The unit vector along `vector`; `None` if that is zero. A vector that is one already, up to
/// round-off, is unchanged, so that resolved scenarios read back to themselves.
fn normalised(vector: [f64; 3]) -> Option<[f64; 3]> {
    let largest = vector.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    if largest == 0.0 {
        return None;
    }
    let scaled = vector.map(|component| component / largest);
    let norm = scaled.iter().map(|c| c * c).sum::<f64>().sqrt();
    if (largest * norm - 1.0).abs() < 4.0 * f64::EPSILON {
        return Some(vector);
    }
    Some(scaled.map(|component| component / norm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn unit_vectors_stay_as_they_are(vector in prop::array::uniform3(-1e3..1e3f64)) {
            prop_assume!(vector != [0.0; 3]);
            let unit = normalised(vector).unwrap();
            prop_assert_eq!(normalised(unit), Some(unit));
            let norm = unit.iter().map(|c| c * c).sum::<f64>().sqrt();
            prop_assert!((norm - 1.0).abs() < 1e-15);
        }
    }
}
