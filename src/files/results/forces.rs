//! `node_forces.csv`: velocities, forces and twist of the nodes at each output time.

use super::files::NODE_FORCES;
use super::frame::{Frame, node_places};
use super::stream::{CsvStream, read_rows};
use super::{ResultsError, RodRecord};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `node_forces.csv`; the fields are the columns.
#[derive(Serialize)]
struct ForceRow<'a> {
    time_s: f64,
    rod: &'a str,
    node: usize,
    velocity_x_m_per_s: f64,
    velocity_y_m_per_s: f64,
    velocity_z_m_per_s: f64,
    fluid_force_x_n: f64,
    fluid_force_y_n: f64,
    fluid_force_z_n: f64,
    contact_force_x_n: f64,
    contact_force_y_n: f64,
    contact_force_z_n: f64,
    twist_rad_per_m: f64,
}

/// Writes the rows of a frame and flushes them; forces of absent models are zero.
pub(super) fn write_forces(
    stream: &mut CsvStream,
    rods: &[RodRecord],
    frame: &Frame,
) -> Result<(), ResultsError> {
    for place in node_places(rods) {
        let velocity = value_at(&frame.velocities, place.index);
        let fluid = value_at(&frame.fluid_forces, place.index);
        let contact = value_at(&frame.contact_forces, place.index);
        stream.write(&ForceRow {
            time_s: frame.time,
            rod: &place.rod.name,
            node: place.node,
            velocity_x_m_per_s: velocity.x,
            velocity_y_m_per_s: velocity.y,
            velocity_z_m_per_s: velocity.z,
            fluid_force_x_n: fluid.x,
            fluid_force_y_n: fluid.y,
            fluid_force_z_n: fluid.z,
            contact_force_x_n: contact.x,
            contact_force_y_n: contact.y,
            contact_force_z_n: contact.z,
            twist_rad_per_m: frame
                .twist_rates
                .get(place.index)
                .copied()
                .unwrap_or_default(),
        })?;
    }
    stream.flush()
}

fn value_at(values: &[Vector3<f64>], index: usize) -> Vector3<f64> {
    values.get(index).copied().unwrap_or_else(Vector3::zeros)
}

/// Velocities, contact forces and twist at one output time; arrays run over all nodes, rod after rod.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeForces {
    /// Velocities, m/s.
    pub velocities: Vec<Vector3<f64>>,
    /// Contact forces, N.
    pub contact_forces: Vec<Vector3<f64>>,
    /// Twist per length, rad/m; zero if the file does not have it.
    pub twist_rates: Vec<f64>,
}

/// The columns to be read back.
#[derive(Deserialize)]
struct ReadRow {
    velocity_x_m_per_s: f64,
    velocity_y_m_per_s: f64,
    velocity_z_m_per_s: f64,
    contact_force_x_n: f64,
    contact_force_y_n: f64,
    contact_force_z_n: f64,
    /// Absent in files of version 0.1.
    #[serde(default)]
    twist_rad_per_m: f64,
}

/// Reads `node_forces.csv` of a results directory whose rods have `nodes` nodes in total; `None`
/// if the run writes no such file.
///
/// Ignores a partial last output, which a running process or a crash may leave.
///
/// # Errors
/// [`ResultsError::Io`] if it cannot be read, [`ResultsError::Damaged`] if it is not such a table.
pub fn read_node_forces(
    directory: &Path,
    nodes: usize,
) -> Result<Option<Vec<NodeForces>>, ResultsError> {
    let path = directory.join(NODE_FORCES);
    if !path.exists() {
        return Ok(None);
    }
    let rows: Vec<ReadRow> = read_rows(&path)?;
    let output = |rows: &[ReadRow]| NodeForces {
        velocities: rows
            .iter()
            .map(|row| {
                Vector3::new(
                    row.velocity_x_m_per_s,
                    row.velocity_y_m_per_s,
                    row.velocity_z_m_per_s,
                )
            })
            .collect(),
        contact_forces: rows
            .iter()
            .map(|row| {
                Vector3::new(
                    row.contact_force_x_n,
                    row.contact_force_y_n,
                    row.contact_force_z_n,
                )
            })
            .collect(),
        twist_rates: rows.iter().map(|row| row.twist_rad_per_m).collect(),
    };
    Ok(Some(rows.chunks_exact(nodes.max(1)).map(output).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_read_back_and_absent_ones_are_zero() {
        let directory = tempfile::tempdir().unwrap();
        assert_eq!(read_node_forces(directory.path(), 2).unwrap(), None);
        let rods = [RodRecord {
            name: "rod".into(),
            nodes: 2,
            closed: false,
            radius: 1e-3,
            ..RodRecord::default()
        }];
        let velocities = vec![Vector3::new(0.1, -0.2, 1.0 / 3.0), Vector3::zeros()];
        let frame = Frame {
            positions: vec![Vector3::zeros(); 2],
            twist_rates: vec![0.0, -2.5],
            velocities: velocities.clone(),
            ..Frame::default()
        };
        let mut stream = CsvStream::create(&directory.path().join(NODE_FORCES)).unwrap();
        write_forces(&mut stream, &rods, &frame).unwrap();
        let read = read_node_forces(directory.path(), 2).unwrap().unwrap();
        assert_eq!(
            read,
            [NodeForces {
                velocities,
                contact_forces: vec![Vector3::zeros(); 2],
                twist_rates: vec![0.0, -2.5],
            }]
        );
    }
}
