//! Probes: quantities that a scenario measures at each output.

mod distance;
mod gauss;
mod quantity;
mod statistic;

pub(super) use gauss::{linking_number, writhe};
pub use quantity::{ContactPartner, Quantity};
pub use statistic::Summary;

use super::observer::{Finding, Observer, Sample};
use rodlab_files::results::{CaseOutcome, Ending, NamedValues, SeriesRow, Value};
use serde::{Deserialize, Serialize};
use statistic::Statistic;

/// A measured quantity and its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// The prefix of its columns.
    pub name: String,
    /// The measured quantity.
    pub quantity: Quantity,
    /// Statistic of the probe in the summary; `None` for none.
    pub summary: Option<Summary>,
}

impl Probe {
    /// Names of its columns in `series.csv`: name, component, unit.
    pub fn columns(&self) -> Vec<String> {
        self.names("")
    }

    /// Names of its columns in `summary.csv`, if it has any: the statistic precedes the unit.
    pub fn summary_columns(&self) -> Vec<String> {
        self.summary.map_or_else(Vec::new, |summary| {
            self.names(&format!("_{}", summary.word()))
        })
    }

    fn names(&self, summary: &str) -> Vec<String> {
        let parts = self.quantity.columns().iter();
        let name =
            |(component, unit): &(&str, &str)| format!("{}{component}{summary}{unit}", self.name);
        parts.map(name).collect()
    }
}

/// The column in `summary.csv` with the condition that ended a run.
pub const STOPPED_BY: &str = "stopped_by";

/// A condition on a column that ends the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StopWhen {
    /// The column of a probe.
    pub column: String,
    /// The value beyond which the run ends.
    pub limit: Limit,
}

/// Side of a value on which a condition holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Limit {
    /// The column exceeds it.
    Above(f64),
    /// The column falls below it.
    Below(f64),
}

impl StopWhen {
    fn sentence(&self, value: f64) -> Option<String> {
        let (side, limit) = match self.limit {
            Limit::Above(limit) if value > limit => ("above", limit),
            Limit::Below(limit) if value < limit => ("below", limit),
            _ => return None,
        };
        Some(format!("{} is {value}, {side} {limit}", self.column))
    }
}

/// All probes of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probes {
    probes: Vec<Probe>,
    stop_when: Option<StopWhen>,
    /// One for each column, in their order.
    statistics: Vec<Statistic>,
    stopped: bool,
}

impl Probes {
    /// Probes that have measured nothing yet. The column of `stop_when` must be one of their
    /// columns.
    pub fn new(probes: Vec<Probe>, stop_when: Option<StopWhen>) -> Self {
        let columns = probes.iter().map(|probe| probe.quantity.columns().len());
        Self {
            statistics: vec![Statistic::default(); columns.sum()],
            probes,
            stop_when,
            stopped: false,
        }
    }

    /// Names of the probes.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.probes.iter().map(|probe| probe.name.as_str())
    }

    /// The measured quantities, in their order.
    pub fn quantities(&self) -> impl Iterator<Item = &Quantity> {
        self.probes.iter().map(|probe| &probe.quantity)
    }

    /// Columns of each probe, in their order.
    pub fn columns_of_each(&self) -> impl Iterator<Item = Vec<String>> {
        self.probes.iter().map(Probe::columns)
    }

    /// Whether a condition on a column may end the run.
    pub fn may_stop(&self) -> bool {
        self.stop_when.is_some()
    }

    /// The current values of all columns.
    pub fn values(&self, sample: &Sample<'_>) -> Vec<Option<f64>> {
        let probes = self.probes.iter();
        probes
            .flat_map(|probe| probe.quantity.measure(sample))
            .collect()
    }

    fn stop(&mut self, values: &[Option<f64>]) -> Finding {
        let Some(condition) = &self.stop_when else {
            return Finding::GoOn;
        };
        let mut columns = self.probes.iter().flat_map(Probe::columns);
        let index = columns.position(|column| column == condition.column);
        let value = index.and_then(|index| values[index]);
        match value.and_then(|value| condition.sentence(value)) {
            None => Finding::GoOn,
            Some(sentence) => {
                self.stopped = true;
                Finding::End(Ending {
                    word: condition.column.clone(),
                    sentence,
                })
            }
        }
    }
}

impl Observer for Probes {
    fn name(&self) -> &str {
        "probes"
    }

    fn columns(&self) -> Vec<String> {
        self.probes.iter().flat_map(Probe::columns).collect()
    }

    fn measure(&mut self, sample: &Sample<'_>, _: &SeriesRow) -> (Vec<Value>, Finding) {
        let values = self.values(sample);
        for (statistic, value) in self.statistics.iter_mut().zip(&values) {
            statistic.add(*value);
        }
        let finding = self.stop(&values);
        (values.into_iter().map(Value::from).collect(), finding)
    }

    fn outcomes(&self) -> NamedValues {
        let mut statistics = self.statistics.iter();
        let mut values = Vec::new();
        for probe in &self.probes {
            let own = statistics.by_ref().take(probe.quantity.columns().len());
            let own: Vec<&Statistic> = own.collect();
            if let Some(summary) = probe.summary {
                let own = own
                    .into_iter()
                    .map(|statistic| statistic.get(summary).into());
                values.extend(probe.summary_columns().into_iter().zip(own));
            }
        }
        if let Some(condition) = &self.stop_when {
            let column = self.stopped.then_some(condition.column.as_str());
            values.push((STOPPED_BY.to_owned(), column.into()));
        }
        NamedValues(values)
    }

    fn highlights(&self, outcome: &CaseOutcome) -> Vec<(String, String)> {
        let columns = self.probes.iter().flat_map(Probe::summary_columns);
        let line = |column: String| {
            let value = outcome.observed.number(&column)?;
            Some((column, format!("{value:.6e}")))
        };
        columns.filter_map(line).collect()
    }
}
