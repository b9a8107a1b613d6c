//! Figures of a results directory.

use crate::figure::{Curve, LinePlot, RodCurve, Snapshot, View, line_plots, snapshots};
use crate::results::{
    MANIFEST, Manifest, NODES, NodePositions, RODS_FIGURE, ResultsError, RodRecord, SERIES_FIGURE,
    SeriesRow, read_nodes, read_series, write_whole,
};
use std::io;
use std::path::{Path, PathBuf};

/// Snapshots in a figure.
const SNAPSHOTS: usize = 4;

/// Draws the figures of a results directory into it and returns their paths.
///
/// `rods.svg`: the rods at up to four times, evenly spread over the run; needs `nodes.csv`.
/// `series.svg`: energies, contacts, distance and iterations over time; needs more than one output.
/// Works while a run is at work, and on what an interrupted one left.
///
/// # Errors
/// [`ResultsError::Io`] where `directory` holds no results or cannot be written, [`ResultsError::Damaged`].
pub fn plot_results(directory: &Path) -> Result<Vec<PathBuf>, ResultsError> {
    let manifest = Manifest::read(directory)?.ok_or_else(|| ResultsError::Io {
        action: "read",
        path: directory.join(MANIFEST),
        source: io::ErrorKind::NotFound.into(),
    })?;
    let mut written = Vec::new();
    let mut write = |name: &str, svg: String| {
        let path = directory.join(name);
        write_whole(&path, svg.as_bytes())?;
        written.push(path);
        Ok::<(), ResultsError>(())
    };
    if directory.join(NODES).exists() {
        write(RODS_FIGURE, rods_figure(directory, &manifest.rods)?)?;
    }
    let series = read_series(directory)?;
    if series.len() > 1 {
        write(
            SERIES_FIGURE,
            line_plots(&series_plots(&series), "Time in s"),
        )?;
    }
    Ok(written)
}

/// The rods at up to four times, evenly spread over the run, as SVG.
///
/// # Errors
/// [`ResultsError::Io`] or [`ResultsError::Damaged`] where `nodes.csv` cannot be read.
pub(super) fn rods_figure(directory: &Path, rods: &[RodRecord]) -> Result<String, ResultsError> {
    let outputs = read_nodes(directory, rods.iter().map(|rod| rod.nodes).sum())?;
    let pictures: Vec<Snapshot> = evenly_spread(&outputs, SNAPSHOTS)
        .map(|output| snapshot(output, rods, outputs.len() > 1))
        .collect();
    let points = pictures
        .iter()
        .flat_map(|picture| &picture.rods)
        .flat_map(|rod| &rod.points);
    let view = View::fitting(points);
    Ok(snapshots(&pictures, &view))
}

/// Up to `count` of the items, from the first to the last.
fn evenly_spread<T>(items: &[T], count: usize) -> impl Iterator<Item = &T> {
    let count = count.min(items.len());
    let last = items.len().saturating_sub(1);
    (0..count).map(move |k| {
        &items[if count > 1 {
            k * last / (count - 1)
        } else {
            last
        }]
    })
}

fn snapshot(output: &NodePositions, rods: &[RodRecord], timed: bool) -> Snapshot {
    let mut rest = output.positions.as_slice();
    let curve = |rod: &RodRecord| {
        let (points, after) = rest.split_at(rod.nodes);
        rest = after;
        RodCurve {
            points: points.to_vec(),
            closed: rod.closed,
            radius: rod.radius,
        }
    };
    let curves = rods.iter().map(curve).collect();
    let title = if timed {
        format!("t = {} s", (output.time * 1e3).round() / 1e3)
    } else {
        String::new()
    };
    Snapshot {
        title,
        rods: curves,
    }
}

/// A column of the series.
type Column = fn(&SeriesRow) -> Option<f64>;

fn series_plots(series: &[SeriesRow]) -> Vec<LinePlot> {
    let energies: [(&str, Column); 6] = [
        ("kinetic", |row| Some(row.kinetic_energy_j)),
        ("stretching", |row| Some(row.stretching_energy_j)),
        ("bending", |row| Some(row.bending_energy_j)),
        ("twisting", |row| Some(row.twisting_energy_j)),
        ("contact", |row| Some(row.contact_energy_j)),
        ("gravitational", |row| Some(row.gravitational_energy_j)),
    ];
    let others: [(&str, Column); 3] = [
        ("Contacts", |row| {
            row.contacts.map(|contacts| contacts as f64)
        }),
        ("Smallest distance in mm", |row| {
            row.min_distance_m.map(|distance| 1e3 * distance)
        }),
        ("Newton iterations", |row| row.newton_iterations),
    ];
    let curve = |name: &str, column: Column| Curve {
        name: name.into(),
        points: series.iter().map(|row| (row.time_s, column(row))).collect(),
    };
    let energies: Vec<Curve> = energies
        .into_iter()
        .map(|(name, column)| curve(name, column))
        .filter(|curve| curve.points.iter().any(|(_, energy)| *energy != Some(0.0)))
        .collect();
    let energy = LinePlot {
        label: "Energy in J".into(),
        curves: energies,
    };
    let others = others.into_iter().map(|(label, column)| LinePlot {
        label: label.into(),
        curves: vec![curve(label, column)],
    });
    let plots = std::iter::once(energy).chain(others);
    let has_values = |curve: &Curve| curve.points.iter().any(|(_, y)| y.is_some());
    plots
        .filter(|plot| plot.curves.iter().any(has_values))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_items_hold_both_ends() {
        let items: Vec<usize> = (0..=30).collect();
        let spread = |count, length| {
            evenly_spread(&items[..length], count)
                .copied()
                .collect::<Vec<_>>()
        };
        assert_eq!(spread(4, 31), [0, 10, 20, 30]);
        assert_eq!(spread(4, 2), [0, 1]);
        assert_eq!(spread(1, 31), [30]);
        assert!(spread(4, 0).is_empty());
    }

    #[test]
    fn energies_that_are_always_zero_and_empty_columns_are_not_plotted() {
        let row = |time_s| SeriesRow {
            time_s,
            contacts: Some(3),
            bending_energy_j: 1e-3 * time_s,
            ..SeriesRow::default()
        };
        let plots = series_plots(&[row(0.0), row(1.0)]);
        let labels: Vec<&str> = plots.iter().map(|plot| plot.label.as_str()).collect();
        assert_eq!(labels, ["Energy in J", "Contacts"]);
        assert_eq!(plots[0].curves.len(), 1);
        assert_eq!(
            plots[0].curves[0].points,
            [(0.0, Some(0.0)), (1.0, Some(1e-3))]
        );
    }

    #[test]
    fn a_directory_without_results_is_an_error_that_names_the_manifest() {
        let directory = tempfile::tempdir().unwrap();
        let error = plot_results(directory.path()).unwrap_err();
        assert!(error.to_string().contains(MANIFEST), "{error}");
    }
}
