//! `branch.csv`: one row per point of a path of equilibria.

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
    /// Largest distance of the parameter from that of the critical point; 0 if the point is not
    /// critical.
    pub parameter_error: f64,
    /// Root mean square of the nodes' displacement from their placed positions.
    pub displacement_rms_m: f64,
    /// Energy of stretching, bending and twisting.
    pub elastic_energy_j: f64,
    /// Elastic energy with the potentials of contact and gravity; without those of other loads.
    pub energy_j: f64,
    /// Negative pivots of the Hessian: directions in which the energy decreases. Under forces
    /// without an energy, growing small motions; an oscillating one counts twice.
    pub negative_pivots: usize,
    /// Whether the equilibrium is stable, which means that `negative_pivots` is 0.
    pub stable: bool,
    /// Lowest eigenvalue of the Hessian; empty under forces without an energy.
    pub lowest_eigenvalue_n_per_m: Option<f64>,
    /// Rate at which the fastest small motion grows, under forces without an energy.
    pub growth_rate_per_s: Option<f64>,
    /// Frequency of that motion, 0 if it does not oscillate; for a stable equilibrium, the lowest
    /// frequency.
    pub frequency_hz: Option<f64>,
    /// `regular`, or the kind of critical point.
    pub kind: BranchKind,
    /// Newton iterations since the previous point.
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

/// Reads `branch.csv` of a results directory; ignores a partial last row after a crash.
///
/// # Errors
/// [`ResultsError::Io`] if there is no such file, [`ResultsError::Damaged`] if it is not such a
/// table.
pub fn read_branches(directory: &Path) -> Result<Vec<BranchRow>, ResultsError> {
    read_rows(&directory.join(BRANCH))
}
