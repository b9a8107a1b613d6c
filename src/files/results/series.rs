//! `series.csv`: one row per output time.

use super::ResultsError;
use super::files::SERIES;
use super::stream::{header_of, read_rows};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `series.csv`; the fields are the columns.
///
/// Means are over the steps since the previous row; they are empty in the first row, and if no
/// step was taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SeriesRow {
    /// Simulated time.
    pub time_s: f64,
    /// Size of the last step.
    pub step_s: Option<f64>,
    /// Number of steps since the previous row.
    pub steps: u64,
    /// Mean number of Newton iterations per step, retries included.
    pub newton_iterations: Option<f64>,
    /// Mean number of Krylov iterations of the fluid solves per step.
    pub fluid_iterations: Option<f64>,
    /// Number of contacts with a force at the end of the last step.
    pub contacts: Option<usize>,
    /// Distance between the two bodies, including planes, that are nearest to contact; empty if
    /// none are near.
    pub min_distance_m: Option<f64>,
    /// Kinetic energy.
    pub kinetic_energy_j: f64,
    /// Elastic energy of stretching, including that of springs between nodes.
    pub stretching_energy_j: f64,
    /// Elastic energy of bending, including that of springs about hinges.
    pub bending_energy_j: f64,
    /// Elastic energy of twisting.
    pub twisting_energy_j: f64,
    /// Potential of the contact forces.
    pub contact_energy_j: f64,
    /// Potential of gravity.
    pub gravitational_energy_j: f64,
}

impl SeriesRow {
    /// Elastic energy, J.
    pub fn elastic_energy(&self) -> f64 {
        self.stretching_energy_j + self.bending_energy_j + self.twisting_energy_j
    }

    /// All energy, J.
    pub fn energy(&self) -> f64 {
        self.elastic_energy()
            + self.kinetic_energy_j
            + self.contact_energy_j
            + self.gravitational_energy_j
    }
}

/// Names of the columns of [`SeriesRow`].
pub fn series_columns() -> Vec<String> {
    header_of(&SeriesRow::default())
}

/// Reads `series.csv` of a results directory; ignores a partial last row after a crash.
///
/// # Errors
/// [`ResultsError::Io`] if there is no such file, [`ResultsError::Damaged`] if it is not such a
/// table.
pub fn read_series(directory: &Path) -> Result<Vec<SeriesRow>, ResultsError> {
    read_series_as(directory)
}

/// Reads `series.csv` as rows of another type, for columns of an observer or a selection of
/// columns. Fields are matched with the names of the columns.
///
/// # Errors
/// As [`read_series`]; [`ResultsError::Damaged`] also if a column is missing.
pub fn read_series_as<Row: DeserializeOwned>(directory: &Path) -> Result<Vec<Row>, ResultsError> {
    read_rows(&directory.join(SERIES))
}
