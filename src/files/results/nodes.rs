//! `nodes.csv`: positions of the nodes at each output time.

use super::files::NODES;
use super::frame::{Frame, node_places};
use super::stream::{CsvStream, read_rows};
use super::{ResultsError, RodRecord};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `nodes.csv`; the fields are the columns.
#[derive(Serialize)]
struct NodeRow<'a> {
    time_s: f64,
    rod: &'a str,
    node: usize,
    x_m: f64,
    y_m: f64,
    z_m: f64,
    /// Angle of the edge that starts at the node; empty at the last node of an open rod.
    theta_rad: Option<f64>,
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
            rod: &place.rod.name,
            node: place.node,
            x_m: position.x,
            y_m: position.y,
            z_m: position.z,
            theta_rad: place.starts_edge().then(|| frame.edge_angles[place.index]),
        })?;
    }
    stream.flush()
}

/// Node positions at one output time.
#[derive(Clone, Debug, PartialEq)]
pub struct NodePositions {
    /// Time, s.
    pub time: f64,
    /// Positions of all nodes, rod after rod, m.
    pub positions: Vec<Vector3<f64>>,
}

/// The columns to be read back.
#[derive(Deserialize)]
struct PositionRow {
    time_s: f64,
    x_m: f64,
    y_m: f64,
    z_m: f64,
}

/// Reads `nodes.csv` of a results directory whose rods have `nodes` nodes in total.
///
/// Ignores a partial last output, which a running process or a crash may leave.
///
/// # Errors
/// [`ResultsError::Io`] if there is no such file, [`ResultsError::Damaged`] if it is not such a
/// table.
pub fn read_nodes(directory: &Path, nodes: usize) -> Result<Vec<NodePositions>, ResultsError> {
    let rows: Vec<PositionRow> = read_rows(&directory.join(NODES))?;
    let outputs = rows.chunks_exact(nodes.max(1));
    Ok(outputs
        .map(|rows| NodePositions {
            time: rows[0].time_s,
            positions: rows
                .iter()
                .map(|row| Vector3::new(row.x_m, row.y_m, row.z_m))
                .collect(),
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn positions_read_back_and_a_torn_output_is_left_out() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(NODES);
        let rod = |name: &str| RodRecord {
            name: name.into(),
            nodes: 2,
            closed: false,
            radius: 1e-3,
            ..RodRecord::default()
        };
        let rods = [rod("one"), rod("two")];
        let frame = |time: f64| Frame {
            time,
            positions: (0..4)
                .map(|k| Vector3::new(time / 3.0, f64::from(k), -0.0))
                .collect(),
            edge_angles: vec![0.0; 4],
            ..Frame::default()
        };
        let mut stream = CsvStream::create(&path).unwrap();
        for time in [0.0, 0.1, 0.2] {
            write_nodes(&mut stream, &rods, &frame(time)).unwrap();
        }
        let whole = fs::read_to_string(&path).unwrap();
        for (lost, outputs) in [(0, 3), (3, 2), (30, 2)] {
            fs::write(&path, &whole[..whole.len() - lost]).unwrap();
            let read = read_nodes(directory.path(), 4).unwrap();
            assert_eq!(read.len(), outputs);
            for (output, time) in read.iter().zip([0.0, 0.1, 0.2]) {
                assert_eq!(
                    (output.time, &output.positions),
                    (time, &frame(time).positions)
                );
            }
        }
    }

    #[test]
    fn invalid_node_tables_are_rejected() {
        let directory = tempfile::tempdir().unwrap();
        assert!(matches!(
            read_nodes(directory.path(), 4),
            Err(ResultsError::Io { .. })
        ));
        for text in [
            "time_s,x_m\n0.0,1.0\n",
            "time_s,x_m,y_m,z_m\n0.0,1.0,one,2.0\n",
        ] {
            fs::write(directory.path().join(NODES), text).unwrap();
            let error = read_nodes(directory.path(), 4).unwrap_err();
            assert!(matches!(error, ResultsError::Damaged { .. }), "{error}");
        }
    }
}
