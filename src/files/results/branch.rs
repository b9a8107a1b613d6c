//! `branch.csv`: a row per point of a path of equilibria.

use super::ResultsError;
use super::files::BRANCH;
use super::stream::read_rows;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `branch.csv`; the fields are the columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BranchRow {
    /// Number of the branch; 0 is the one that begins at the start of the path.
    pub branch: usize,
    /// The path parameter.
    pub parameter: f64,
    /// Largest distance from that of the critical point; 0 if the point is not critical.
    pub parameter_error: f64,
    /// Root mean square of the nodes' displacement from where they were placed.
    pub displacement_rms_m: f64,
    /// Energy of stretching, bending and twisting.
    pub elastic_energy_j: f64,
    /// Elastic energy with the potentials of contact and gravity; without that of other loads.
    pub energy_j: f64,
    /// Negative pivots of the Hessian: directions in which the energy falls. Under forces without an energy, small motions that
    /// grow; one that oscillates counts twice.
    pub negative_pivots: usize,
    /// Whether the equilibrium is stable: it has no such directions.
    pub stable: bool,
    /// Lowest eigenvalue of the Hessian; empty under forces without an energy.
    pub lowest_eigenvalue_n_per_m: Option<f64>,
    /// Rate at which the fastest small motion grows, under forces without an energy.
    pub growth_rate_per_s: Option<f64>,
    /// Its frequency, 0 if it does not oscillate; for a stable equilibrium the lowest.
    pub frequency_hz: Option<f64>,
    /// `regular`, or the kind of critical point.
    pub kind: BranchKind,
    /// Newton iterations from the point before.
    pub newton_iterations: usize,
}

/// Kind of a point of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BranchKind {
    /// Nothing.
    Regular,
    /// The parameter turns back.
    Fold,
    /// Another branch crosses.
    Bifurcation,
    /// Oscillations begin or stop growing.
    Flutter,
}

/// Reads `branch.csv` of a results directory; a partial last row after a crash is ignored.
///
/// # Errors
/// [`ResultsError::Io`] where there is no such file, [`ResultsError::Damaged`] if it is not such a
/// table.
pub fn read_branches(directory: &Path) -> Result<Vec<BranchRow>, ResultsError> {
    read_rows(&directory.join(BRANCH))
}
