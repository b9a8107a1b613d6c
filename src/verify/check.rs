//! One line of the table: expected value, found value, and allowed error.

use serde::Serialize;
use std::fmt::Write;

/// Origin of an expected value.
#[derive(Clone, Copy, Debug)]
pub struct Expectation {
    /// The formula or equation.
    pub formula: &'static str,
    /// Source of the formula.
    pub source: &'static str,
}

/// A comparison of a simulation with theory.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// The compared quantity.
    pub name: String,
    /// The formula or equation behind the expected value.
    pub formula: String,
    /// Source of the formula.
    pub source: String,
    /// Theoretical value.
    pub expected: f64,
    /// Simulated value; NaN if the simulation failed.
    pub got: f64,
    /// Unit of both values; empty for pure numbers.
    pub unit: String,
    /// |got − expected| as a fraction of the scale of the check.
    pub error: f64,
    /// Largest error that passes.
    pub bound: f64,
}

/// Whether a check passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The error is within its bound.
    Pass,
    /// The error exceeds its bound or is not a number.
    Fail,
}

/// Second order of convergence of rods and joints, measured between a mesh and one with edges half
/// as long.
const ORDER: Expectation = Expectation::new("log₂(error at N / error at 2N)", "second order");

/// A compared quantity without values.
#[derive(Clone, Debug)]
pub struct Quantity<'a> {
    expectation: Expectation,
    name: String,
    unit: &'a str,
}

impl Expectation {
    /// A formula or equation, and its source.
    pub const fn new(formula: &'static str, source: &'static str) -> Self {
        Self { formula, source }
    }

    /// A quantity with this expectation and a unit.
    pub fn of(self, name: impl Into<String>, unit: &str) -> Quantity<'_> {
        Quantity {
            expectation: self,
            name: name.into(),
            unit,
        }
    }
}

impl Quantity<'_> {
    /// A check whose error is relative to the expected value.
    pub fn relative(self, expected: f64, got: f64, bound: f64) -> Check {
        self.scaled(expected, got, expected.abs(), bound)
    }

    /// A check of a number that is zero in theory; its error is the number itself.
    pub fn zero(self, got: f64, bound: f64) -> Check {
        self.scaled(0.0, got, 1.0, bound)
    }

    /// A check whose error is a fraction of `scale`, given in the unit of the values.
    pub fn scaled(self, expected: f64, got: f64, scale: f64, bound: f64) -> Check {
        Check {
            name: self.name,
            formula: self.expectation.formula.into(),
            source: self.expectation.source.into(),
            expected,
            got,
            unit: self.unit.into(),
            error: (got - expected).abs() / scale,
            bound,
        }
    }
}

/// Check of second-order convergence, from the ratio of the errors on a mesh and on the mesh with
/// edges half as long.
pub(super) fn order(name: impl Into<String>, ratio_of_errors: f64) -> Check {
    let found = libm::log2(ratio_of_errors);
    ORDER.of(name, "").scaled(2.0, found, 1.0, 0.2)
}

impl Check {
    /// A failed check in place of a group whose simulation failed; the reason replaces its source.
    pub fn not_run(group: &str, reason: &str) -> Self {
        Self {
            name: format!("{group}: not run"),
            formula: String::new(),
            source: reason.into(),
            expected: f64::NAN,
            got: f64::NAN,
            unit: String::new(),
            error: f64::NAN,
            bound: 0.0,
        }
    }

    /// Whether the error is within its bound.
    pub fn verdict(&self) -> Verdict {
        if self.error <= self.bound {
            Verdict::Pass
        } else {
            Verdict::Fail
        }
    }
}

/// Formats the checks as a text table.
pub fn table(checks: &[Check]) -> String {
    let width = |of: fn(&Check) -> &str| {
        checks
            .iter()
            .map(|check| of(check).chars().count())
            .max()
            .unwrap_or(0)
    };
    let name = width(|check| &check.name).max("check".len());
    let formula = width(|check| &check.formula).max("formula".len());
    let mut text = String::new();
    let mut line = |row: std::fmt::Arguments| writeln!(text, "{row}").expect("writing to a string");
    line(format_args!(
        "{:name$}  {:formula$}  {:>13}  {:>13}  {:6}  {:>8}  {:>8}  verdict  source",
        "check", "formula", "expected", "got", "unit", "error", "bound"
    ));
    for check in checks {
        let verdict = match check.verdict() {
            Verdict::Pass => "pass",
            Verdict::Fail => "FAIL",
        };
        line(format_args!(
            "{:name$}  {:formula$}  {:>13}  {:>13}  {:6}  {:>8.1e}  {:>8.1e}  {verdict:7}  {}",
            check.name,
            check.formula,
            number(check.expected),
            number(check.got),
            check.unit,
            check.error,
            check.bound,
            check.source
        ));
    }
    let passed = checks
        .iter()
        .filter(|check| check.verdict() == Verdict::Pass)
        .count();
    line(format_args!("{passed} of {} checks pass", checks.len()));
    text
}

/// Formats a number with eight significant digits, in scientific notation only if it is very large
/// or small.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        format!("{value:.8}")
    } else {
        format!("{value:.6e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUM: Expectation = Expectation::new("1 + 1", "Peano 1889");

    #[test]
    fn nan_fails_a_check() {
        let sum = SUM.of("sum", "").relative(2.0, f64::NAN, 1.0);
        assert_eq!(sum.verdict(), Verdict::Fail);
        assert_eq!(Check::not_run("sums", "no pencil").verdict(), Verdict::Fail);
    }

    #[test]
    fn errors_are_fractions_of_their_scale() {
        let check = SUM.of("sum", "m").scaled(2.0, 2.5, 10.0, 0.05);
        assert_eq!(check.error, 0.05);
        assert_eq!(check.verdict(), Verdict::Pass);
        let check = SUM.of("sum", "m").relative(2.0, 2.5, 0.2);
        assert_eq!(check.verdict(), Verdict::Fail);
    }

    #[test]
    fn the_table_names_each_check_and_counts_the_passed() {
        let checks = [2.0, 3.0].map(|got| SUM.of("one", "").relative(2.0, got, 1e-9));
        let text = table(&checks);
        assert_eq!(text.lines().count(), 4);
        assert!(text.contains("FAIL") && text.ends_with("1 of 2 checks pass\n"));
    }
}
