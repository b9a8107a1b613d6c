//! A row of `boundary.csv`.

use super::files::BOUNDARY;
use rodlab_files::results::{ResultsError, read_whole_rows};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Part of the boundary to which a direction belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// The surface.
    Surface,
    /// Section ω = 0 of the boundary.
    KappaTau,
    /// Section τ = 0 of the boundary.
    KappaOmega,
    /// Section κ = 0 of the boundary: straight rods.
    TauOmega,
}

/// Outcome of the rod along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The rod loses stability.
    Buckles,
    /// The rod touches itself before it loses stability.
    TouchesItself,
    /// The rod is stable up to the largest distance.
    Stable,
    /// No equilibrium was found next to the helix.
    NoConvergence,
}

/// A row of `boundary.csv`. Distances are norms ‖(κ, τ, ω)‖ for a rod of length 1 and bending stiffness 1.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct BoundaryRow {
    /// Part of the boundary.
    pub part: Part,
    /// Unit direction: curvature.
    pub kappa: f64,
    /// Unit direction: torsion.
    pub tau: f64,
    /// Unit direction: twisting moment.
    pub omega: f64,
    /// Outcome of the rod.
    pub outcome: Outcome,
    /// Distance at which the discrete rod loses stability; empty if it does not.
    pub critical: Option<f64>,
    /// Critical distance in the limit of a fine mesh, since the error falls with the square of the
    /// edge length; empty if it is not requested, or if the rod with half as many edges does not
    /// lose stability.
    pub extrapolated: Option<f64>,
    /// Critical distance by the conjugate points of the smooth rod; empty if there are none up to
    /// 100.
    pub theory: Option<f64>,
    /// critical/theory − 1.
    pub relative_difference: Option<f64>,
    /// extrapolated/theory − 1.
    pub relative_difference_extrapolated: Option<f64>,
    /// Distance at which the rod first touches itself; empty if it does not do so before it loses
    /// stability.
    pub contact: Option<f64>,
}

/// The rows in a results directory.
///
/// # Errors
/// `boundary.csv` cannot be read.
pub fn read_boundary(directory: &Path) -> Result<Vec<BoundaryRow>, ResultsError> {
    Ok(read_whole_rows(&directory.join(BOUNDARY))?.rows)
}
