//! Columns of a knot in `series.csv`.

use rodlab_files::results::{ResultsError, SeriesRow, Value, read_series, read_series_as};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Columns of `series.csv` in addition to those of [`SeriesRow`] when a knot is pulled tight. In a
/// series of an older version without work and losses, these are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KnotRow {
    /// Distance of the ends; with two rods, of the left ends from the right ends.
    pub end_to_end_m: f64,
    /// Length of a rod minus the distance of the ends.
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
    /// Clear height H of the loop of an overhand knot: from its middle to the braid, surface to
    /// surface; empty without contact.
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
    /// Determinant of the knot; empty if it cannot be identified.
    pub knot_determinant: Option<u64>,
    /// Force with which the first end of the second rod is pulled outwards; empty with a single
    /// rod.
    pub second_traction_start_n: Option<f64>,
    /// Force with which the last end of the second rod is pulled outwards; empty with a single
    /// rod.
    pub second_traction_end_n: Option<f64>,
}

impl KnotRow {
    /// Names of the columns and their values.
    pub fn cells(&self) -> [(&'static str, Value); 18] {
        [
            ("end_to_end_m", self.end_to_end_m.into()),
            ("shortening_m", self.shortening_m.into()),
            ("traction_start_n", self.traction_start_n.into()),
            ("traction_end_n", self.traction_end_n.into()),
            ("loop_radius_m", self.loop_radius_m.into()),
            ("force_normalized", self.force_normalized.into()),
            ("epsilon", self.epsilon.into()),
            ("length_normalized", self.length_normalized.into()),
            ("loop_height_m", self.loop_height_m.into()),
            ("braid_width_m", self.braid_width_m.into()),
            ("height_normalized", self.height_normalized.into()),
            ("contact_force_n", self.contact_force_n.into()),
            ("work_of_ends_j", self.work_of_ends_j.into()),
            ("friction_loss_j", self.friction_loss_j.into()),
            ("drag_loss_j", self.drag_loss_j.into()),
            ("knot_determinant", self.knot_determinant.into()),
            (
                "second_traction_start_n",
                self.second_traction_start_n.into(),
            ),
            ("second_traction_end_n", self.second_traction_end_n.into()),
        ]
    }
}

/// Reads the columns of a knot from `series.csv`, each with its row.
///
/// # Errors
/// As [`read_series`]; [`ResultsError::Damaged`] also if no knot was observed.
pub fn read_knot_series(directory: &Path) -> Result<Vec<(SeriesRow, KnotRow)>, ResultsError> {
    let knots = read_series_as::<KnotRow>(directory)?;
    Ok(read_series(directory)?.into_iter().zip(knots).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_columns_are_the_fields_in_their_order() {
        let row = KnotRow {
            end_to_end_m: 0.25,
            knot_determinant: Some(3),
            epsilon: Some(0.125),
            second_traction_end_n: Some(-1.0),
            ..KnotRow::default()
        };
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.serialize(row).unwrap();
        let fields = String::from_utf8(writer.into_inner().unwrap()).unwrap();
        let (names, cells): (Vec<&str>, Vec<Value>) = row.cells().into_iter().unzip();
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(names).unwrap();
        writer.serialize(cells).unwrap();
        let columns = String::from_utf8(writer.into_inner().unwrap()).unwrap();
        assert_eq!(columns, fields);
    }
}
