//! The branches of a path of equilibria: displacement and energy over the parameter.

use super::PlotError;
use crate::report::branches::PARAMETER;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, line_plots};
use rodlab_files::results::{BRANCH, BranchKind, BranchRow, read_branches};
use std::path::Path;

/// A quantity plotted over the parameter.
type Column = fn(&BranchRow) -> f64;

const STABLE: &str = "stable";
const UNSTABLE: &str = "unstable";
const CRITICAL: &str = "critical";

/// The figure; `None` if no path was followed.
pub(super) fn branch_figure(directory: &Path) -> Result<Option<Figure>, PlotError> {
    if !directory.join(BRANCH).exists() {
        return Ok(None);
    }
    let plots = branch_plots(&read_branches(directory)?);
    Ok(Some(line_plots(plots, PARAMETER)))
}

fn branch_plots(rows: &[BranchRow]) -> Vec<LinePlot> {
    let columns: [(&str, Column); 2] = [
        ("RMS displacement in m", |row| row.displacement_rms_m),
        ("Energy in J", |row| row.energy_j),
    ];
    columns
        .into_iter()
        .map(|(label, column)| {
            LinePlot::new(
                label,
                [
                    curve(STABLE, rows, column, |row| row.stable).like(0),
                    curve(UNSTABLE, rows, column, |row| !row.stable)
                        .looking(Look::Dashed)
                        .like(1),
                    critical(rows, column).looking(Look::Marks).like(2),
                ]
                .into_iter()
                .filter(|curve| !curve.points.is_empty()),
            )
        })
        .collect()
}

/// The points for which `shows` returns true. The curve is broken between branches and where
/// points are left out.
fn curve(name: &str, rows: &[BranchRow], column: Column, shows: fn(&BranchRow) -> bool) -> Curve {
    let mut points: Vec<(f64, Option<f64>)> = Vec::new();
    for stretch in rows.chunk_by(|a, b| a.branch == b.branch && shows(a) == shows(b)) {
        if shows(&stretch[0]) {
            points.extend(stretch.iter().map(|row| (row.parameter, Some(column(row)))));
            points.push((stretch[stretch.len() - 1].parameter, None));
        }
    }
    Curve::new(name, points)
}

fn critical(rows: &[BranchRow], column: Column) -> Curve {
    let rows = rows.iter().filter(|row| row.kind != BranchKind::Regular);
    let points = rows.map(|row| (row.parameter, Some(column(row))));
    Curve::new(CRITICAL, points.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stable_and_unstable_stretches_of_each_branch_are_curves_of_their_own() {
        let row = |branch, parameter: f64, stable: bool, kind| BranchRow {
            branch,
            parameter,
            parameter_error: 0.0,
            displacement_rms_m: parameter,
            elastic_energy_j: 0.0,
            energy_j: 0.0,
            negative_pivots: usize::from(!stable),
            stable,
            lowest_eigenvalue_n_per_m: Some(1.0),
            growth_rate_per_s: None,
            frequency_hz: None,
            kind,
            newton_iterations: 2,
        };
        let plots = branch_plots(&[
            row(0, 0.0, true, BranchKind::Regular),
            row(0, 1.0, false, BranchKind::Bifurcation),
            row(0, 2.0, false, BranchKind::Regular),
            row(1, 1.5, true, BranchKind::Regular),
        ]);
        let curves = &plots[0].curves;
        let names: Vec<&str> = curves.iter().map(|curve| curve.name.as_str()).collect();
        assert_eq!(names, [STABLE, UNSTABLE, CRITICAL]);
        let stable = [(0.0, Some(0.0)), (0.0, None), (1.5, Some(1.5)), (1.5, None)];
        assert_eq!(curves[0].points, stable);
        assert_eq!(curves[2].points, [(1.0, Some(1.0))]);
    }
}
