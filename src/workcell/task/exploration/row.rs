//! One row for each explored direction, and a summary of all.

use rodlab_files::results::{ResultsError, read_whole_rows};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the table.
pub const TABLE: &str = "exploration.csv";

/// Outcome of a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Found {
    /// The rod left the helix.
    Buckles,
    /// The rod stayed a helix as far as the arm could move it.
    StaysHelix,
    /// Failure; `limit` holds the reason.
    Failed,
}

/// A row of `exploration.csv`. Distances are norms ‖(κ, τ, ω)‖ in units of the rod's length and bending stiffness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExplorationRow {
    /// Number of the direction, from 1.
    pub direction: usize,
    /// Unit direction: curvature.
    pub kappa: f64,
    /// Unit direction: torsion.
    pub tau: f64,
    /// Unit direction: twisting moment.
    pub omega: f64,
    /// Outcome.
    pub outcome: Found,
    /// Largest distance before the instability at which the measured rod was the helix.
    pub stable: f64,
    /// Distance at which the rod was no longer the helix; empty if it always was.
    pub lost: Option<f64>,
    /// Measured distance of the instability: the middle between `stable` and `lost`.
    pub found: Option<f64>,
    /// Distance of the instability from the conjugate points of the smooth rod without weight;
    /// empty if there are none up to 100.
    pub theory: Option<f64>,
    /// found/theory − 1.
    pub relative_difference: Option<f64>,
    /// Distance to which the arm can move the clamps.
    pub reach: f64,
    /// Reason for the limit `reach`; empty if it is the largest distance of the request.
    pub limit: String,
    /// Number of pictures that were measured.
    pub looks: usize,
    /// Wall time of the search, s.
    pub wall_time_s: f64,
}

impl ExplorationRow {
    /// A row of a direction that could not be explored.
    pub fn failed([kappa, tau, omega]: [f64; 3], words: String) -> Self {
        Self {
            direction: 0,
            kappa,
            tau,
            omega,
            outcome: Found::Failed,
            stable: 0.0,
            lost: None,
            found: None,
            theory: None,
            relative_difference: None,
            reach: 0.0,
            limit: words,
            looks: 0,
            wall_time_s: 0.0,
        }
    }
}

/// The rows in a directory of an exploration.
///
/// # Errors
/// The table cannot be read.
pub fn read_rows(directory: &Path) -> Result<Vec<ExplorationRow>, ResultsError> {
    Ok(read_whole_rows(&directory.join(TABLE))?.rows)
}

/// Comparison of the results with theory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ExplorationSummary {
    /// Number of directions explored.
    pub directions: usize,
    /// Number of directions in which the rod buckled.
    pub buckled: usize,
    /// Number of directions in which theory predicts an instability within reach, but none was
    /// observed.
    pub missed: usize,
    /// Mean of |found/theory − 1| over the directions in which the rod buckled; empty if there are
    /// none.
    pub mean_relative_error: Option<f64>,
    /// Standard deviation of |found/theory − 1|.
    pub deviation_of_relative_error: Option<f64>,
    /// The largest.
    pub largest_relative_error: Option<f64>,
}

impl ExplorationSummary {
    /// Summarizes rows.
    pub fn of(rows: &[ExplorationRow]) -> Self {
        let errors = rows.iter().filter_map(|row| row.relative_difference);
        let errors: Vec<f64> = errors.map(f64::abs).collect();
        let count = errors.len() as f64;
        let mean = (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / count);
        let deviation = mean.map(|mean| {
            let squares = errors.iter().map(|error| (error - mean).powi(2));
            (squares.sum::<f64>() / count).sqrt()
        });
        let is_missed = |row: &&ExplorationRow| {
            row.found.is_none() && row.theory.is_some_and(|theory| theory < row.reach)
        };
        Self {
            directions: rows.len(),
            buckled: rows.iter().filter(|row| row.found.is_some()).count(),
            missed: rows.iter().filter(is_missed).count(),
            mean_relative_error: mean,
            deviation_of_relative_error: deviation,
            largest_relative_error: mean.map(|_| errors.iter().copied().fold(0.0, f64::max)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(found: Option<f64>, theory: Option<f64>, reach: f64) -> ExplorationRow {
        let both = found.zip(theory);
        ExplorationRow {
            found,
            theory,
            relative_difference: both.map(|(found, theory)| found / theory - 1.0),
            reach,
            ..ExplorationRow::failed([1.0, 0.0, 0.0], String::new())
        }
    }

    #[test]
    fn a_summary_counts_what_was_found_and_what_was_missed() {
        let rows = [
            row(Some(10.1), Some(10.0), 12.0),
            row(Some(7.76), Some(8.0), 12.0),
            row(None, Some(9.0), 12.0),
            row(None, Some(13.0), 12.0),
            row(None, None, 12.0),
        ];
        let summary = ExplorationSummary::of(&rows);
        assert_eq!(
            (summary.directions, summary.buckled, summary.missed),
            (5, 2, 1)
        );
        assert!((summary.mean_relative_error.unwrap() - 0.02).abs() < 1e-12);
        assert!((summary.deviation_of_relative_error.unwrap() - 0.01).abs() < 1e-12);
        assert!((summary.largest_relative_error.unwrap() - 0.03).abs() < 1e-12);
        assert_eq!(ExplorationSummary::of(&rows[2..]).mean_relative_error, None);
    }
}
