//! Side views of a knot before, during and after its inversion.

use super::cases::Case;
use super::inversion::Inversion;
use crate::experiment::KnotRow;
use crate::figure::{RodCurve, Snapshot, View, snapshots};
use crate::mechanics::Vector3;
use crate::results::{NodePositions, ResultsError, read_nodes};

/// A moment of an inversion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    /// The traction is about to fall.
    Before,
    /// The loop has lost half of its height.
    During,
    /// The loop lies on the braid, the traction has grown again.
    After,
}

/// Width of the picture over that of the braid.
const WIDTH: f64 = 1.6;

/// Least distance of the points that are drawn, in radii: finer curves look the same and make large files.
const SPACING: f64 = 1.5;

/// Looks along z: the knot lies around the x axis and its loop beside it.
pub(super) fn side_view(pictures: &[Snapshot]) -> String {
    snapshots(pictures, &View::from(Vector3::z()))
}

/// The knot of a run at the given moments, its tails cut off beside the braid; nothing where it did not invert.
pub(super) fn pictures(
    case: &Case<Inversion>,
    moments: &[Moment],
) -> Result<Vec<Snapshot>, ResultsError> {
    let rows = Inversion::pulled_rows(case)?;
    let outcome = Inversion::outcome(case);
    let (Some(by_force), Some(by_height)) =
        (outcome.inversion_by_force, outcome.inversion_by_height)
    else {
        return Ok(Vec::new());
    };
    let at = |length: f64| rows.iter().find(|(_, row)| row.length_normalized <= length);
    let Some((_, upright)) = at(by_force) else {
        return Ok(Vec::new());
    };
    let half = upright.loop_height_m.map(|height| 0.5 * height);
    let mut fallen = rows.iter().filter(|(_, row)| {
        row.length_normalized <= by_force.min(by_height + 1.0) && row.loop_height_m < half
    });
    let outputs = read_nodes(&case.directory, case.run.nodes)?;
    let mut pictures = Vec::new();
    for moment in moments {
        let found = match moment {
            Moment::Before => at(by_force),
            Moment::During => fallen.next(),
            Moment::After => rows.last(),
        };
        let node_output = found.and_then(|(time, row)| {
            let output = outputs.iter().find(|output| output.time == *time)?;
            Some((output, row))
        });
        let reach = upright.braid_width_m.map(|width| 0.5 * WIDTH * width);
        if let (Some((output, row)), Some(reach)) = (node_output, reach) {
            pictures.push(picture(case, output, row, reach));
        }
    }
    Ok(pictures)
}

fn picture(case: &Case<Inversion>, output: &NodePositions, row: &KnotRow, reach: f64) -> Snapshot {
    let positions = &output.positions;
    let middle = 0.5 * (positions[0].x + positions[positions.len() - 1].x);
    let near = |point: &Vector3| (point.x - middle).abs() < reach;
    let first = positions.iter().position(near).unwrap_or(0);
    let last = positions.iter().rposition(near).unwrap_or(0);
    let edge = (positions[1] - positions[0]).norm();
    let stride = (SPACING * case.run.radius / edge).ceil() as usize;
    Snapshot {
        title: format!("l̄_k = {:.1}", row.length_normalized),
        rods: vec![RodCurve {
            points: positions[first..=last]
                .iter()
                .step_by(stride)
                .copied()
                .collect(),
            closed: false,
            radius: case.run.radius,
        }],
    }
}
