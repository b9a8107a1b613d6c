//! `node_forces.csv`: velocities of the nodes and the forces on them at each output time.

use super::frame::{Frame, node_places};
use super::stream::CsvStream;
use super::{ResultsError, RodRecord};
use nalgebra::Vector3;
use serde::Serialize;

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
        })?;
    }
    stream.flush()
}

fn value_at(values: &[Vector3<f64>], index: usize) -> Vector3<f64> {
    values.get(index).copied().unwrap_or_else(Vector3::zeros)
}
