//! `nodes.csv`: where the nodes are at each output time.

use super::frame::{Frame, node_places};
use super::stream::CsvStream;
use super::{ResultsError, RodRecord};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A row of `nodes.csv`; the fields are the columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NodeRow<'a> {
    /// Simulated time.
    pub time_s: f64,
    /// Name of the rod.
    pub rod: Cow<'a, str>,
    /// Number of the node along the rod, from zero.
    pub node: usize,
    /// Position.
    pub x_m: f64,
    /// Position.
    pub y_m: f64,
    /// Position.
    pub z_m: f64,
    /// Angle of the edge that starts at the node; empty at the last node of an open rod.
    pub theta_rad: Option<f64>,
}

/// Writes the rows of a frame and flushes them.
pub(super) fn write_nodes(
    stream: &mut CsvStream,
    rods: &[RodRecord],
    frame: &Frame,
) -> Result<(), ResultsError> {
    for place in node_places(rods) {
        let position = frame.positions[place.index];
        stream.write(&NodeRow {
            time_s: frame.time,
            rod: Cow::Borrowed(&place.rod.name),
            node: place.node,
            x_m: position.x,
            y_m: position.y,
            z_m: position.z,
            theta_rad: place.starts_edge().then(|| frame.edge_angles[place.index]),
        })?;
    }
    stream.flush()
}
