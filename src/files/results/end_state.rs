//! `end_state.csv`: positions, frames and velocities at the end of a run, from which another run may start.

use super::ResultsError;
use super::atomic::write_whole_before;
use super::files::END_STATE;
use crate::finite;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `end_state.csv`, a node; the fields are the columns. Rods and nodes are in the order of
/// the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "the columns are described in `columns::tables`"
)]
pub struct EndRow {
    pub rod: String,
    pub node: usize,
    pub x_m: f64,
    pub y_m: f64,
    pub z_m: f64,
    pub director_x: Option<f64>,
    pub director_y: Option<f64>,
    pub director_z: Option<f64>,
    pub twist_rad: f64,
    pub velocity_x_m_per_s: f64,
    pub velocity_y_m_per_s: f64,
    pub velocity_z_m_per_s: f64,
    pub spin_rad_per_s: f64,
    pub wall_tangent_x: Option<f64>,
    pub wall_tangent_y: Option<f64>,
    pub wall_tangent_z: Option<f64>,
    pub wall_director_x: Option<f64>,
    pub wall_director_y: Option<f64>,
    pub wall_director_z: Option<f64>,
    #[serde(default)]
    pub wall_spin_x_rad_per_s: Option<f64>,
    #[serde(default)]
    pub wall_spin_y_rad_per_s: Option<f64>,
    #[serde(default)]
    pub wall_spin_z_rad_per_s: Option<f64>,
}

/// Writes the final state of a run.
///
/// # Errors
/// [`ResultsError::Io`].
pub fn write_end_state(directory: &Path, rows: &[EndRow]) -> Result<(), ResultsError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).expect("plain rows go into memory");
    }
    let bytes = writer.into_inner().expect("memory takes all bytes");
    // The manifest follows.
    write_whole_before(&directory.join(END_STATE), &bytes)
}

impl EndRow {
    /// The numbers of the row, with the names of their columns.
    fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let given = [
            ("x_m", self.x_m),
            ("y_m", self.y_m),
            ("z_m", self.z_m),
            ("twist_rad", self.twist_rad),
            ("velocity_x_m_per_s", self.velocity_x_m_per_s),
            ("velocity_y_m_per_s", self.velocity_y_m_per_s),
            ("velocity_z_m_per_s", self.velocity_z_m_per_s),
            ("spin_rad_per_s", self.spin_rad_per_s),
        ];
        let optional = [
            ("director_x", self.director_x),
            ("director_y", self.director_y),
            ("director_z", self.director_z),
            ("wall_tangent_x", self.wall_tangent_x),
            ("wall_tangent_y", self.wall_tangent_y),
            ("wall_tangent_z", self.wall_tangent_z),
            ("wall_director_x", self.wall_director_x),
            ("wall_director_y", self.wall_director_y),
            ("wall_director_z", self.wall_director_z),
            ("wall_spin_x_rad_per_s", self.wall_spin_x_rad_per_s),
            ("wall_spin_y_rad_per_s", self.wall_spin_y_rad_per_s),
            ("wall_spin_z_rad_per_s", self.wall_spin_z_rad_per_s),
        ];
        let optional = optional
            .into_iter()
            .filter_map(|(name, number)| Some((name, number?)));
        given.into_iter().chain(optional)
    }
}

/// Reads the text of `end_state.csv`.
///
/// # Errors
/// The error, with its location.
pub fn read_end_state(text: &[u8]) -> Result<Vec<EndRow>, String> {
    let mut reader = csv::Reader::from_reader(text);
    let rows: Result<Vec<EndRow>, csv::Error> = reader.deserialize().collect();
    let rows = rows.map_err(|error| format!("it is not an end state of a run: {error}"))?;
    for (index, row) in rows.iter().enumerate() {
        let (names, numbers): (Vec<&str>, Vec<f64>) = row.numbers().unzip();
        let checked = finite::check(&numbers, |number| {
            // The header is line 1.
            format!("line {}: `{}`", index + 2, names[number])
        });
        checked.map_err(|error| error.to_string())?;
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_with_a_number_that_is_not_finite_is_refused_by_line_and_column() {
        let text = "rod,node,x_m,y_m,z_m,director_x,director_y,director_z,twist_rad,velocity_x_m_per_s,velocity_y_m_per_s,\
             velocity_z_m_per_s,spin_rad_per_s,wall_tangent_x,wall_tangent_y,wall_tangent_z,wall_director_x,wall_director_y,wall_director_z\n\
             a,0,0,0,0,1,0,0,0,0,0,0,0,,,,,,\na,1,0.1,0,0,,,,0,0,0,0,0,,,,,,\n";
        assert_eq!(read_end_state(text.as_bytes()).unwrap().len(), 2);
        for (good, bad, column) in [
            ("a,1,0.1", "a,1,NaN", "x_m"),
            ("a,1,0.1,0", "a,1,0.1,inf", "y_m"),
        ] {
            let words = read_end_state(text.replace(good, bad).as_bytes()).unwrap_err();
            assert_eq!(words, format!("line 3: `{column}` is not a finite number"));
        }
    }
}
