//! The search of a sweep for one value of one key.

use super::axis::{SweptKey, sweep_path};
use super::range::{Interval, Number, Scale};
use crate::scenario::decode::decode;
use crate::scenario::document::{Entry, Node, Value};
use crate::scenario::issue::{Issue, Issues};
use crate::scenario::typed::{self, SearchMethod};

/// A validated search, with the numbers in front of the unit of the ends.
#[derive(Clone, Debug)]
pub struct Search {
    /// Method.
    pub method: SearchMethod,
    /// Column of the summary or of the series.
    pub objective: String,
    /// One end of the interval.
    pub from: f64,
    /// The other end.
    pub to: f64,
    /// Width of the interval at which the search ends.
    pub tolerance: f64,
    /// Target value of the objective.
    pub target: f64,
    /// The key that is varied.
    pub(super) key: SweptKey,
    interval: Interval,
    /// The table as typed.
    pub(super) typed: Node,
}

impl Search {
    /// Reads `[sweep.search]`.
    pub(super) fn read(entry: &Entry) -> Result<Self, Issues> {
        let path = sweep_path().key("search");
        let typed: typed::Search =
            decode(&entry.node).map_err(|issues: Issues| issues.below(&path))?;
        let fault = |key: &str, message: String| Issues::from(Issue::new(path.key(key), message));
        let number =
            |key: &str, end: &typed::End| end.number().map_err(|message| fault(key, message));
        let from = number("from", &typed.from)?;
        let to = number("to", &typed.to)?;
        let tolerance = number("tolerance", &typed.tolerance)?;
        // Whole numbers would round the values between them.
        let real = |number: &Number| Number {
            whole: false,
            ..number.clone()
        };
        let interval = Interval::new(&real(&from), &real(&to), Scale::Linear)
            .map_err(|message| fault("to", message))?;
        if tolerance.unit != from.unit {
            let message = format!("the tolerance needs the unit of the ends, {:?}", from.unit);
            return Err(fault("tolerance", message));
        }
        let width = (to.value - from.value).abs();
        if !(tolerance.value > 0.0 && width > 0.0) {
            let message = "allowed: a tolerance greater than 0, and ends that differ".to_owned();
            return Err(fault("tolerance", message));
        }
        if !typed.target.is_finite() {
            return Err(fault("target", "expected a finite number".to_owned()));
        }
        let parameter = entry.node.entry("parameter");
        let span = parameter.map_or(&entry.node.span, |entry| &entry.node.span);
        Ok(Self {
            method: typed.method,
            objective: typed.objective,
            from: from.value,
            to: to.value,
            tolerance: tolerance.value,
            target: typed.target,
            key: SweptKey {
                key: typed.parameter,
                span: span.clone(),
            },
            interval,
            typed: entry.node.clone(),
        })
    }

    /// The value of the key for a `number` in front of the unit.
    pub(super) fn value(&self, number: f64) -> Value {
        self.interval
            .at((number - self.from) / (self.to - self.from))
    }
}
