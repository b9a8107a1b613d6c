//! `end_state.csv`: positions, frames and velocities at the end of a run, from which another run may start.

use super::ResultsError;
use super::atomic::write_whole_before;
use super::files::END_STATE;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `end_state.csv`, a node; the fields are the columns. Rods and nodes follow each other as in the scene.
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
}

/// Writes the state in which a run ends.
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

/// Reads the text of such a file.
///
/// # Errors
/// What is wrong with it, and where.
pub fn read_end_state(text: &[u8]) -> Result<Vec<EndRow>, String> {
    let mut reader = csv::Reader::from_reader(text);
    let rows: Result<Vec<EndRow>, csv::Error> = reader.deserialize().collect();
    rows.map_err(|error| format!("it is no end state of a run: {error}"))
}
