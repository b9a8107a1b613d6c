//! Statistics of a column for the summary.

use serde::{Deserialize, Serialize};

/// Statistic of the values of a column in the summary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Summary {
    /// That of the last row.
    Last,
    /// The largest.
    Maximum,
    /// The smallest.
    Minimum,
    /// The mean of all rows that have a value.
    Mean,
}

impl Summary {
    /// The word in names of columns.
    pub fn word(self) -> &'static str {
        match self {
            Self::Last => "last",
            Self::Maximum => "max",
            Self::Minimum => "min",
            Self::Mean => "mean",
        }
    }
}

/// Statistics of the values of a column so far. Rows without a value are ignored, except by the
/// statistic of the last row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Statistic {
    last: Option<f64>,
    largest: f64,
    smallest: f64,
    sum: f64,
    count: u64,
}

impl Default for Statistic {
    fn default() -> Self {
        Self {
            last: None,
            largest: f64::NEG_INFINITY,
            smallest: f64::INFINITY,
            sum: 0.0,
            count: 0,
        }
    }
}

impl Statistic {
    /// Takes the value of another row into account.
    pub fn add(&mut self, value: Option<f64>) {
        self.last = value;
        let Some(value) = value else { return };
        self.largest = self.largest.max(value);
        self.smallest = self.smallest.min(value);
        self.sum += value;
        self.count += 1;
    }

    /// The statistic in the summary; `None` if no row had a value.
    pub fn get(&self, summary: Summary) -> Option<f64> {
        let value = match summary {
            Summary::Last => return self.last,
            Summary::Maximum => self.largest,
            Summary::Minimum => self.smallest,
            Summary::Mean => self.sum / self.count as f64,
        };
        (self.count > 0).then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_without_a_value_count_only_as_the_last() {
        let mut statistic = Statistic::default();
        let all = [
            Summary::Last,
            Summary::Maximum,
            Summary::Minimum,
            Summary::Mean,
        ];
        assert_eq!(all.map(|summary| statistic.get(summary)), [None; 4]);
        for value in [None, Some(-3.0), Some(1.0), Some(-1.0)] {
            statistic.add(value);
        }
        let expected = [-1.0, 1.0, -3.0, -1.0].map(Some);
        assert_eq!(all.map(|summary| statistic.get(summary)), expected);
        statistic.add(None);
        assert_eq!(statistic.get(Summary::Last), None);
        assert_eq!(statistic.get(Summary::Maximum), Some(1.0));
    }
}
