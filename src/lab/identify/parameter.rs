//! Keys that are fitted.
//!
//! A key that cannot be negative is fitted by its logarithm, so that it stays positive and its
//! error is relative; any other key is fitted in units of a scale. The result is the coordinate u
//! of the fit, which is 0 at the start.

use super::error::IdentifyError;
use crate::experiment;
use crate::scenario::CaseSet;
use libm::{exp, log};

/// Request to fit a key, with prior knowledge about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// The dotted key, as for `--set`.
    pub key: String,
    /// Least and greatest value, SI units.
    pub bounds: Option<[f64; 2]>,
    /// Expected value and standard deviation, SI units.
    pub prior: Option<[f64; 2]>,
}

/// A key with its coordinate.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// The dotted key.
    pub key: String,
    /// SI unit of the parameter; empty if it has none.
    pub unit: String,
    /// Value at the start.
    pub start: f64,
    /// Least and greatest value.
    pub bounds: [f64; 2],
    /// Expected value and standard deviation.
    pub prior: Option<[f64; 2]>,
    /// Whether the coordinate is the logarithm.
    pub is_logarithmic: bool,
    /// Value of one unit of the coordinate, unless the coordinate is a logarithm.
    pub scale: f64,
    /// Whether each scenario states the key; those that do not are independent of it.
    pub concerns: Vec<bool>,
}

impl Parameter {
    /// Builds the parameter of a key that some of the scenarios state; they give its start value.
    ///
    /// # Errors
    /// The key has no number in any scenario, different values, or a start outside of its bounds.
    pub fn new(request: &Request, scenarios: &[CaseSet]) -> Result<Self, IdentifyError> {
        let key = request.key.as_str();
        let fault = |message: String| IdentifyError::Input(format!("--fit {key}: {message}"));
        let mut starts = Vec::new();
        for scenario in scenarios {
            starts.push(scenario.number(key)?);
        }
        let concerns: Vec<bool> = starts.iter().map(Option::is_some).collect();
        let mut stated = starts.into_iter().flatten();
        let start = stated.next().ok_or_else(|| {
            let names: Vec<&str> = scenarios.iter().map(CaseSet::name).collect();
            fault(format!(
                "`{}` has no value for this key; give a start value by --set {key}=VALUE",
                names.join("`, `")
            ))
        })?;
        if let Some(other) = stated.find(|other| *other != start) {
            return Err(fault(format!(
                "the scenarios start at different values, {start} and {other}; give one start by --set {key}=VALUE"
            )));
        }
        let bounds = request.bounds.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        if bounds[0] >= bounds[1] || !(bounds[0]..=bounds[1]).contains(&start) {
            return Err(fault(format!(
                "the start {start} is outside of the bounds {} to {}",
                bounds[0], bounds[1]
            )));
        }
        let first = scenarios
            .iter()
            .zip(&concerns)
            .find(|(_, concerns)| **concerns);
        let is_positive = bounds[0] > 0.0
            || first.is_some_and(|(scenario, _)| refuses_negative(scenario, key, start));
        if is_positive && start <= 0.0 {
            return Err(fault(format!(
                "it cannot be negative and starts at {start}; give a start above 0 by --set {key}=VALUE"
            )));
        }
        // A prior sets the scale of its key, so that the coordinate is small within it.
        let deviation = request.prior.map(|prior| 10.0 * prior[1]);
        let width = (bounds[1] - bounds[0])
            .is_finite()
            .then(|| 0.5 * (bounds[1] - bounds[0]));
        let size = (start != 0.0).then_some(start.abs());
        Ok(Self {
            key: key.to_owned(),
            unit: experiment::unit(key).unwrap_or_default(),
            start,
            bounds,
            prior: request.prior,
            is_logarithmic: is_positive,
            scale: deviation.or(size).or(width).unwrap_or(1.0),
            concerns,
        })
    }

    /// The value at a coordinate.
    pub fn value(&self, coordinate: f64) -> f64 {
        match self.is_logarithmic {
            true => self.start * exp(coordinate),
            false => self.start + self.scale * coordinate,
        }
    }

    /// The coordinate of a value.
    pub fn coordinate(&self, value: f64) -> f64 {
        match self.is_logarithmic {
            true if value <= 0.0 => f64::NEG_INFINITY,
            true => log(value / self.start),
            false => (value - self.start) / self.scale,
        }
    }

    /// Derivative of the value with respect to the coordinate.
    pub fn slope(&self, coordinate: f64) -> f64 {
        match self.is_logarithmic {
            true => self.value(coordinate),
            false => self.scale,
        }
    }

    /// Least and greatest coordinate.
    pub fn range(&self) -> [f64; 2] {
        self.bounds.map(|bound| self.coordinate(bound))
    }
}

/// Whether a scenario rejects the negative of a value.
fn refuses_negative(scenario: &CaseSet, key: &str, start: f64) -> bool {
    let negative = if start == 0.0 { -1.0 } else { -start.abs() };
    let positive = start.abs().max(f64::MIN_POSITIVE);
    let is_refused = |value: f64| match scenario.scenario_with(&[(key, value)]) {
        Ok(loaded) => experiment::prepare(&loaded.scenario).is_err(),
        Err(_) => true,
    };
    start.is_finite() && is_refused(negative) && (start == 0.0 || !is_refused(positive))
}
