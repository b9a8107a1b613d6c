//! Side views of a knot before, during and after its inversion.

use super::cases::Case;
use super::inversion::Inversion;
use nalgebra::Rotation3;
use rodlab_engine::mechanics::Vector3;
use rodlab_files::figure::{Figure, RodCurve, Snapshot, View, snapshots};
use rodlab_files::results::{NodePositions, ResultsError, read_nodes};
use rodlab_lab::experiment::KnotRow;

/// A stage of an inversion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    /// The loop is upright, shortly before it falls.
    Before,
    /// The loop is falling.
    During,
    /// The loop is on the braid, and the traction has grown again.
    After,
}

/// Ratio of l̄_k shortly before the inversion to that of the inversion. There the traction is near
/// its peak, and the loop is upright.
const SHORTLY_BEFORE: f64 = 1.03;
/// Ratio of l̄_k at the start of the search for the fall to that of the inversion.
const FALL_BEGINS: f64 = 1.01;
/// Fraction of the initial height below which the loop has fallen. The loop loses most of its
/// height between two outputs, of which the first is shown.
const FALLEN: f64 = 0.5;

/// Width of the picture relative to that of the braid.
const WIDTH: f64 = 1.6;

/// Least distance of drawn points, in radii. Finer curves look the same but give large files.
const SPACING: f64 = 1.5;

/// View along z: the knot is around the x axis, and its loop is above it.
pub(super) fn side_view(pictures: Vec<Snapshot>) -> Figure {
    snapshots(pictures, View::from(Vector3::z()))
}

/// The knot of a run at the given stages. The knot is rotated about its axis so that the loop is
/// upright before the inversion, and its tails are cut off next to the braid. Empty if the knot did
/// not invert.
pub(super) fn pictures(
    case: &Case<Inversion>,
    moments: &[Moment],
) -> Result<Vec<Snapshot>, ResultsError> {
    let rows = Inversion::pulled_rows(case)?;
    let Some(inversion) = Inversion::outcome(case).inversion_by_height else {
        return Ok(Vec::new());
    };
    let outputs = read_nodes(&case.directory, case.run.nodes)?;
    let output_of = |time: f64| outputs.iter().find(|output| output.time == time);
    let Some((time, upright)) = row_at(&rows, Moment::Before, inversion) else {
        return Ok(Vec::new());
    };
    let (Some(before), Some(width)) = (output_of(*time), upright.braid_width_m) else {
        return Ok(Vec::new());
    };
    let turn = turn_to_upright(&before.positions, case.run.radius);
    let picture_at = |moment: &Moment| {
        let (time, row) = row_at(&rows, *moment, inversion)?;
        let output = output_of(*time)?;
        Some(picture(case, output, row, 0.5 * WIDTH * width, &turn))
    };
    Ok(moments.iter().filter_map(picture_at).collect())
}

/// The row of a stage of an inversion at an l̄_k.
fn row_at(rows: &[(f64, KnotRow)], moment: Moment, inversion: f64) -> Option<&(f64, KnotRow)> {
    let at = |length: f64| {
        let passed = move |(_, row): &&(f64, KnotRow)| row.length_normalized <= length;
        rows.iter().find(passed)
    };
    match moment {
        Moment::Before => at(SHORTLY_BEFORE * inversion),
        Moment::During => {
            let (begins, row) = at(FALL_BEGINS * inversion)?;
            let low = FALLEN * row.loop_height_m?;
            let lies = |row: &KnotRow| row.loop_height_m.is_some_and(|height| height < low);
            let fallen = rows
                .iter()
                .position(|(time, row)| time >= begins && lies(row))?;
            rows.get(fallen.checked_sub(1)?)
        }
        Moment::After => rows.last(),
    }
}

/// The rotation about x that turns the part of the knot away from its axis upright, along y.
fn turn_to_upright(positions: &[Vector3], radius: f64) -> Rotation3<f64> {
    let away = |point: &&Vector3| libm::hypot(point.y, point.z) > 4.0 * radius;
    let loop_: Vector3 = positions.iter().filter(away).sum();
    let angle = libm::atan2(loop_.z, loop_.y);
    Rotation3::from_axis_angle(&Vector3::x_axis(), -angle)
}

fn picture(
    case: &Case<Inversion>,
    output: &NodePositions,
    row: &KnotRow,
    reach: f64,
    turn: &Rotation3<f64>,
) -> Snapshot {
    let positions = &output.positions;
    let middle = 0.5 * (positions[0].x + positions[positions.len() - 1].x);
    let near = |point: &Vector3| (point.x - middle).abs() < reach;
    let first = positions.iter().position(near).unwrap_or(0);
    let last = positions.iter().rposition(near).unwrap_or(0);
    let edge = (positions[1] - positions[0]).norm();
    let stride = (SPACING * case.run.radius / edge).ceil() as usize;
    // The knot is in the middle of its picture, regardless of its position along the rod.
    let shown = |point: &Vector3| turn * (point - Vector3::x() * middle);
    Snapshot {
        title: format!("l̄_{{k}} = {:.1}", row.length_normalized),
        rods: vec![RodCurve {
            points: positions[first..=last]
                .iter()
                .step_by(stride)
                .map(shown)
                .collect(),
            closed: false,
            radius: case.run.radius,
            radii: Vec::new(),
            held: false,
        }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The knot of figure 3.4. Its loop stands at H = 19 mm and falls within two outputs.
    fn rows() -> Vec<(f64, KnotRow)> {
        let heights = [
            (161.0, 21.9),
            (160.0, 21.6),
            (157.0, 21.3),
            (155.7, 15.4),
            (155.6, 12.4),
            (155.5, 0.8),
            (145.5, 0.8),
        ];
        let row = |(k, (length_normalized, height)): (usize, &(f64, f64))| {
            let row = KnotRow {
                length_normalized: *length_normalized,
                loop_height_m: Some(1e-3 * height),
                ..KnotRow::default()
            };
            (k as f64, row)
        };
        heights.iter().enumerate().map(row).collect()
    }

    #[test]
    fn pictures_show_the_states_before_during_and_after_an_inversion() {
        let rows = rows();
        let height = |moment| {
            let (_, row) = row_at(&rows, moment, 155.5).unwrap();
            1e3 * row.loop_height_m.unwrap()
        };
        assert!((height(Moment::Before) - 21.6).abs() < 1e-9);
        assert!((height(Moment::During) - 12.4).abs() < 1e-9);
        assert!((height(Moment::After) - 0.8).abs() < 1e-9);
    }

    #[test]
    fn the_loop_is_rotated_upright() {
        let braid = (0..10).map(|k| Vector3::new(0.01 * f64::from(k), 0.0, 1e-3));
        let arch = (0..10).map(|k| Vector3::new(0.01 * f64::from(k), 0.01, -0.02));
        let positions: Vec<Vector3> = braid.chain(arch).collect();
        let turn = turn_to_upright(&positions, 1e-3);
        let top = turn * positions[15];
        assert!(top.z.abs() < 1e-12 && top.y > 0.02);
    }
}
