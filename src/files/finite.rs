//! Checks that numbers read from files, and numbers written for machines, are finite.
//!
//! NaN passes comparisons silently: an arm with a length of NaN never collides, and a pose of NaN
//! never exceeds a limit.

use std::fmt::Display;
use thiserror::Error;

/// A number that is not finite.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{what} is not a finite number")]
pub struct NotFinite {
    /// Name of the number.
    pub what: String,
}

/// Parses a finite number; `None` for anything else, such as `nan`, `inf` or `1e999`.
pub fn number(text: &str) -> Option<f64> {
    let number = text.trim().parse().ok();
    number.filter(|number: &f64| number.is_finite())
}

/// Checks that all numbers are finite.
///
/// # Errors
/// The first one that is not; `what` names it by its index.
pub fn check<'a, Name: Display>(
    numbers: impl IntoIterator<Item = &'a f64>,
    what: impl Fn(usize) -> Name,
) -> Result<(), NotFinite> {
    let mut numbers = numbers.into_iter();
    match numbers.position(|number| !number.is_finite()) {
        Some(index) => Err(NotFinite {
            what: what(index).to_string(),
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_finite_numbers_pass() {
        assert_eq!(number(" -1.5e-3 "), Some(-1.5e-3));
        for text in ["nan", "NaN", "inf", "-infinity", "1e999", "", "1,5", "0x1"] {
            assert_eq!(number(text), None, "{text}");
        }
        let names = ["x", "y", "z"];
        let words =
            |numbers: &[f64]| check(numbers, |index| names[index]).map_err(|e| e.to_string());
        assert_eq!(words(&[1.0, -2.0, f64::MAX]), Ok(()));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let expected = Err("y is not a finite number".to_owned());
            assert_eq!(words(&[1.0, bad, bad]), expected);
        }
    }
}
