//! `contacts.csv`: the places at which surfaces press on each other at each output time.

use super::ResultsError;
use super::files::CONTACTS;
use super::frame::Frame;
use super::stream::{CsvStream, read_rows};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `contacts.csv`; the fields are the columns.
#[derive(Serialize)]
struct ContactRow<'a> {
    time_s: f64,
    first: &'a str,
    first_node: Option<usize>,
    second: &'a str,
    second_node: Option<usize>,
    x_m: f64,
    y_m: f64,
    z_m: f64,
    normal_x: f64,
    normal_y: f64,
    normal_z: f64,
    gap_m: f64,
    normal_force_n: f64,
    friction_x_n: f64,
    friction_y_n: f64,
    friction_z_n: f64,
}

/// Writes the rows of a frame and flushes them; none without contact.
pub(super) fn write_contacts(stream: &mut CsvStream, frame: &Frame) -> Result<(), ResultsError> {
    for one in &frame.contacts {
        let ([first, second], [first_node, second_node]) = (&one.names, one.nodes);
        stream.write(&ContactRow {
            time_s: frame.time,
            first,
            first_node,
            second,
            second_node,
            x_m: one.place.x,
            y_m: one.place.y,
            z_m: one.place.z,
            normal_x: one.normal.x,
            normal_y: one.normal.y,
            normal_z: one.normal.z,
            gap_m: one.gap,
            normal_force_n: one.normal_force,
            friction_x_n: one.friction.x,
            friction_y_n: one.friction.y,
            friction_z_n: one.friction.z,
        })?;
    }
    stream.flush()
}

/// A normal force on a node of a rod at one output time.
#[derive(Clone, Debug, PartialEq)]
pub struct PressedNode {
    /// Time, s.
    pub time: f64,
    /// Name of the rod.
    pub rod: String,
    /// The node.
    pub node: usize,
    /// N.
    pub normal_force: f64,
}

/// The columns to be read back.
#[derive(Deserialize)]
struct ReadRow {
    time_s: f64,
    first: String,
    first_node: Option<usize>,
    second: String,
    second_node: Option<usize>,
    normal_force_n: f64,
}

/// Reads the normal forces on the nodes of rods from `contacts.csv` of a results directory, on both
/// sides of each contact; `None` if the run writes no such file.
///
/// # Errors
/// [`ResultsError::Io`] if it cannot be read, [`ResultsError::Damaged`] if it is not such a table.
pub fn read_pressed_nodes(directory: &Path) -> Result<Option<Vec<PressedNode>>, ResultsError> {
    let path = directory.join(CONTACTS);
    if !path.exists() {
        return Ok(None);
    }
    let rows: Vec<ReadRow> = read_rows(&path)?;
    let sides = rows.into_iter().flat_map(|row| {
        let sides = [(row.first, row.first_node), (row.second, row.second_node)];
        sides.into_iter().filter_map(move |(rod, node)| {
            Some(PressedNode {
                time: row.time_s,
                rod,
                node: node?,
                normal_force: row.normal_force_n,
            })
        })
    });
    Ok(Some(sides.collect()))
}
