//! Standardisation: inputs and outputs of a network are scaled to the order of one.

use serde::{Deserialize, Serialize};

/// Mean and standard deviation of each column (thesis Eq. 5.13).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// Mean of each column.
    pub mean: Vec<f64>,
    /// Standard deviation of each column divided by its weight; 1 for constant columns.
    pub deviation: Vec<f64>,
}

impl Scaling {
    /// Of rows of numbers.
    pub fn of(rows: &[f64], width: usize) -> Self {
        let count = (rows.len() / width.max(1)).max(1) as f64;
        let mut mean = vec![0.0; width];
        for row in rows.chunks_exact(width) {
            for (mean, value) in mean.iter_mut().zip(row) {
                *mean += value / count;
            }
        }
        let mut variance = vec![0.0; width];
        for row in rows.chunks_exact(width) {
            for ((variance, mean), value) in variance.iter_mut().zip(&mean).zip(row) {
                *variance += (value - mean).powi(2) / count;
            }
        }
        let deviation = variance.iter().map(|variance| {
            let deviation = variance.sqrt();
            if deviation > 0.0 { deviation } else { 1.0 }
        });
        Self {
            deviation: deviation.collect(),
            mean,
        }
    }

    /// Mean and standard deviation with weights of the columns, or equal weights if none are
    /// given.
    pub fn weighted(mut self, weights: &[f64]) -> Self {
        for (deviation, weight) in self.deviation.iter_mut().zip(weights) {
            *deviation /= weight;
        }
        self
    }

    /// (x − mean)/deviation.
    pub fn standardised(&self, rows: &[f64]) -> Vec<f32> {
        let columns = self.mean.iter().zip(&self.deviation).cycle();
        let rows = rows.iter().zip(columns);
        rows.map(|(value, (mean, deviation))| ((value - mean) / deviation) as f32)
            .collect()
    }

    /// The inverse transformation.
    pub fn restored(&self, rows: &[f32]) -> Vec<f64> {
        let columns = self.mean.iter().zip(&self.deviation).cycle();
        let rows = rows.iter().zip(columns);
        rows.map(|(value, (mean, deviation))| f64::from(*value) * deviation + mean)
            .collect()
    }
}

/// Least and largest number of each column.
pub fn range_of(rows: &[f64], width: usize) -> Vec<[f64; 2]> {
    let mut range = vec![[f64::INFINITY, f64::NEG_INFINITY]; width];
    for row in rows.chunks_exact(width) {
        for (range, value) in range.iter_mut().zip(row) {
            *range = [range[0].min(*value), range[1].max(*value)];
        }
    }
    range
}
