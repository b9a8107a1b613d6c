//! Figures of a results directory.

mod branch;
mod curves;
mod custom;
mod error;
mod labels;
mod series;
mod sweep;

pub use custom::{CustomFigure, custom_figure};
pub use error::PlotError;

use crate::experiment::kind_named;
use crate::figure::{RodCurve, Snapshot, View, is_picture, line_plots, png, snapshots};
use crate::results::{
    BRANCH_FIGURE, Manifest, NODES, NodePositions, RODS_FIGURE, ResultsError, RodRecord, SERIES,
    SERIES_FIGURE, SUMMARY, SWEEP_FIGURE, Table, read_nodes, read_series, replace_own,
};
use branch::branch_figure;
use series::series_plots;
use std::path::{Path, PathBuf};
use sweep::sweep_figure;

/// Snapshots in a figure.
const SNAPSHOTS: usize = 4;

/// Draws the figures of a results directory into it, each as SVG and as PNG, and returns their paths.
///
/// `rods.svg`: the rods at up to four times, evenly spread over the run; needs `nodes.csv`.
/// `series.svg`: energies, contacts, distance and iterations over time; needs more than one output.
/// `sweep.svg`: outcomes over the swept parameters; needs a `summary.csv` in which a number is swept.
/// `branch.svg`: displacement and energy over the parameter of a path of equilibria; needs `branch.csv`.
/// Then those of its kind of experiment, see [`Kind::figures`](crate::experiment::Kind::figures).
/// Works while a run is at work, and on what an interrupted one left.
///
/// # Errors
/// [`PlotError::NotResults`], or [`PlotError::Results`] or [`PlotError::Scenario`] where files cannot be read or
/// written.
pub fn plot_results(directory: &Path) -> Result<Vec<PathBuf>, PlotError> {
    let Some(manifest) = Manifest::read(directory)? else {
        return Err(PlotError::NotResults(directory.to_owned()));
    };
    let mut written = Vec::new();
    let mut write = |name: &str, svg: String| {
        written.extend(write_figure(&directory.join(name), &svg)?);
        Ok::<(), ResultsError>(())
    };
    if directory.join(NODES).exists() {
        write(RODS_FIGURE, rods_figure(directory, &manifest.rods)?)?;
    }
    if directory.join(SERIES).exists() {
        let series = read_series(directory)?;
        if series.len() > 1 {
            let figure = line_plots(&series_plots(&series), "Time in s");
            write(SERIES_FIGURE, figure)?;
        }
    }
    let summary = directory.join(SUMMARY);
    if summary.exists()
        && let Some(figure) = sweep_figure(&Table::read(&summary)?)
    {
        write(SWEEP_FIGURE, figure)?;
    }
    if let Some(figure) = branch_figure(directory)? {
        write(BRANCH_FIGURE, figure)?;
    }
    if let Some(kind) = kind_named(&manifest.experiment) {
        for (name, figure) in kind.figures(directory)? {
            write(name, figure)?;
        }
    }
    Ok(written)
}

/// Writes a figure as SVG, and as PNG beside it; returns both paths. The ending of `path` does not matter.
///
/// # Errors
/// [`ResultsError::Io`].
pub fn write_figure(path: &Path, svg: &str) -> Result<[PathBuf; 2], ResultsError> {
    let paths = ["svg", "png"].map(|ending| path.with_extension(ending));
    replace_own(&paths[0], svg.as_bytes(), is_picture)?;
    replace_own(&paths[1], &png(svg), is_picture)?;
    Ok(paths)
}

/// The rods at up to four times, evenly spread over the run, as SVG.
///
/// # Errors
/// [`ResultsError::Io`] or [`ResultsError::Damaged`] where `nodes.csv` cannot be read.
pub(crate) fn rods_figure(directory: &Path, rods: &[RodRecord]) -> Result<String, ResultsError> {
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
    fn a_directory_without_results_is_an_error_that_names_the_manifest() {
        let directory = tempfile::tempdir().unwrap();
        let error = plot_results(directory.path()).unwrap_err();
        assert!(error.to_string().contains("manifest.json"), "{error}");
        assert_eq!(error.exit_code(), 2);
    }

    #[test]
    fn figures_are_written_twice() {
        let directory = tempfile::tempdir().unwrap();
        let svg = line_plots(&[], "x");
        let [first, second] = write_figure(&directory.path().join("own.pdf"), &svg).unwrap();
        assert!(first.ends_with("own.svg") && second.ends_with("own.png"));
        assert!(std::fs::read(second).unwrap().starts_with(b"\x89PNG"));
    }
}
