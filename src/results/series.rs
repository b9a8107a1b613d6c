//! `series.csv`: a row per output time.

use super::ResultsError;
use super::directory::SERIES;
use super::stream::read_rows;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `series.csv`; the fields are the columns.
///
/// Means are over the steps since the row before; they are empty in the first row, and where no step was taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SeriesRow {
    /// Simulated time.
    pub time_s: f64,
    /// Size of the last step.
    pub step_s: Option<f64>,
    /// Steps since the row before.
    pub steps: u64,
    /// Mean number of Newton iterations per step, retries included.
    pub newton_iterations: Option<f64>,
    /// Mean number of Krylov iterations of the fluid solves per step.
    pub fluid_iterations: Option<f64>,
    /// Contacts that bear force at the end of the last step.
    pub contacts: Option<usize>,
    /// Smallest distance between centrelines that may touch; empty where none is near.
    pub min_distance_m: Option<f64>,
    /// Kinetic energy.
    pub kinetic_energy_j: f64,
    /// Elastic energy of stretching.
    pub stretching_energy_j: f64,
    /// Elastic energy of bending.
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

/// What `series.csv` has beside the columns of [`SeriesRow`] when a knot is pulled tight. Work and losses read as zero
/// from a series that an older version wrote without them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KnotRow {
    /// Distance of the ends; with two rods of those on the left from those on the right.
    pub end_to_end_m: f64,
    /// Length of a rod less the distance of the ends.
    pub shortening_m: f64,
    /// Force with which the first end is pulled outwards.
    pub traction_start_n: f64,
    /// Force with which the last end is pulled outwards.
    pub traction_end_n: f64,
    /// Radius R of the circle fitted to the loop, the part that is out of contact; empty without contact.
    pub loop_radius_m: Option<f64>,
    /// F̄ = F h²/EI with the mean F of the tractions of all ends.
    pub force_normalized: f64,
    /// ε = √(h/R).
    pub epsilon: Option<f64>,
    /// l̄_k = (L − l_c)/h: the shortening over the radius of the rod (thesis Eq. 3.4).
    pub length_normalized: f64,
    /// Clear height H of the loop of an overhand knot: from its middle to the braid, surface to surface; empty without
    /// contact.
    pub loop_height_m: Option<f64>,
    /// Width W of the knot: from end to end of the braid.
    pub braid_width_m: Option<f64>,
    /// H̄ = H/W.
    pub height_normalized: Option<f64>,
    /// Sum of all normal forces between the strands.
    pub contact_force_n: f64,
    /// Work of the clamps at the ends since the start.
    #[serde(default)]
    pub work_of_ends_j: f64,
    /// Energy lost to friction since the start.
    #[serde(default)]
    pub friction_loss_j: f64,
    /// Energy lost to drag since the start.
    #[serde(default)]
    pub drag_loss_j: f64,
    /// Determinant of the knot; empty where it cannot be told.
    pub knot_determinant: Option<u64>,
    /// Force with which the first end of the second rod is pulled outwards; empty where one rod is tied.
    pub second_traction_start_n: Option<f64>,
    /// Force with which its last end is pulled outwards.
    pub second_traction_end_n: Option<f64>,
}

/// Reads `series.csv` of a results directory; a last row that a crash left in part is left out.
///
/// # Errors
/// [`ResultsError::Io`] where there is no such file, [`ResultsError::Damaged`] where it is no such table.
pub fn read_series(directory: &Path) -> Result<Vec<SeriesRow>, ResultsError> {
    read_rows(&directory.join(SERIES))
}

/// Reads the columns of a knot from `series.csv`, each with its row.
///
/// # Errors
/// As [`read_series`]; [`ResultsError::Damaged`] also where no knot was observed.
pub fn read_knot_series(directory: &Path) -> Result<Vec<(SeriesRow, KnotRow)>, ResultsError> {
    let rows = read_series(directory)?;
    Ok(rows
        .into_iter()
        .zip(read_rows(&directory.join(SERIES))?)
        .collect())
}
