//! Figures of a results directory.

mod branch;
mod close_up;
mod contacts;
mod curves;
mod custom;
mod error;
mod series;
mod sweep;

pub use custom::{CustomFigure, custom_figure};
pub use error::PlotError;

use super::branches::{Branches, PARAMETER};
use super::carried_bodies::carried_bodies;
use super::free_bodies::free_bodies;
use super::obstacles::{bodies_at, obstacles_of, surfaces};
use super::threads::threads;
use crate::experiment::{from_text, kind_named};
use crate::scenario::Scenario;
use branch::branch_figure;
use close_up::cut_straight_ends;
use contacts::contact_map;
use rodlab_files::figure::{
    Figure, FigureOptions, Format, Plane, RodCurve, RodsFigure, Snapshot, View, is_picture,
    line_plots,
};
use rodlab_files::results::{
    BRANCH_FIGURE, CONTACTS_FIGURE, Manifest, NODES, NodePositions, RODS_FIGURE, ResultsError,
    RodRecord, SERIES, SERIES_FIGURE, SUMMARY, SWEEP_FIGURE, Table, read_nodes, read_pressed_nodes,
    read_series, replace_own,
};
use series::series_plots;
use std::path::{Path, PathBuf};
use sweep::sweep_figure;

/// Snapshots in a figure.
const SNAPSHOTS: usize = 4;
/// Maximum number of rods in a legend.
const NAMED_RODS: usize = 12;

/// Draws the figures of a results directory into it and returns their paths.
///
/// `rods`: the rods at up to four times, evenly spaced over the run; needs `nodes.csv`. `series`:
/// energies, contacts, distance and iterations over time; needs more than one output. `contacts`:
/// the normal forces on the nodes of rods over time; needs `contacts.csv`. `sweep`:
/// outcomes over the swept parameters; needs a `summary.csv` in which a number is swept. `branch`:
/// displacement and energy over the parameter of a path of equilibria; needs `branch.csv`. The
/// kind of experiment may add figures, see [`Kind::figures`](crate::experiment::Kind::figures).
/// The results may be those of a run that is in progress or was interrupted.
///
/// # Errors
/// [`PlotError::NotResults`], or [`PlotError::Results`] or [`PlotError::Scenario`] if files cannot
/// be read or written.
pub fn plot_results(directory: &Path, options: &FigureOptions) -> Result<Vec<PathBuf>, PlotError> {
    let Some(manifest) = Manifest::read_checked(directory)? else {
        return Err(PlotError::NotResults(directory.to_owned()));
    };
    let mut written = Vec::new();
    let mut write = |name: &str, figure: Figure| {
        written.extend(write_figure(&directory.join(name), &figure, options)?);
        Ok::<(), ResultsError>(())
    };
    if directory.join(NODES).exists() {
        write(RODS_FIGURE, rods_figure(directory, &manifest)?)?;
    }
    if directory.join(SERIES).exists() {
        let series = read_series(directory)?;
        let branches = Branches::read(directory)?;
        if series.len() > 1 {
            let plots = series_plots(&series, branches.as_ref());
            let label = if branches.is_some() {
                PARAMETER
            } else {
                "Time in s"
            };
            write(SERIES_FIGURE, line_plots(plots, label))?;
        }
    }
    if let Some(figure) = read_pressed_nodes(directory)?.and_then(|nodes| contact_map(&nodes)) {
        write(CONTACTS_FIGURE, figure)?;
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

/// Writes a figure in all requested formats, side by side; returns the paths. The suffix of `path`
/// is ignored.
///
/// # Errors
/// [`ResultsError::Io`], [`ResultsError::NotOwn`] if another kind of file has the same name.
pub fn write_figure(
    path: &Path,
    figure: &Figure,
    options: &FigureOptions,
) -> Result<Vec<PathBuf>, ResultsError> {
    write_in_formats(path, &figure.svg(&options.paper), &options.formats)
}

/// [`write_figure`] of a figure that is drawn as SVG.
///
/// # Errors
/// As [`write_figure`].
pub fn write_in_formats(
    path: &Path,
    svg: &str,
    formats: &[Format],
) -> Result<Vec<PathBuf>, ResultsError> {
    let write = |format: &Format| {
        let path = path.with_extension(format.ending());
        replace_own(&path, &format.encode(svg), is_picture)?;
        Ok(path)
    };
    formats.iter().map(write).collect()
}

/// The rods at up to four times, evenly spaced over the run, with the planes and the names of the
/// rods.
///
/// # Errors
/// [`ResultsError::Io`] or [`ResultsError::Damaged`] if `nodes.csv` or `branch.csv` cannot be
/// read.
pub fn rods_figure(directory: &Path, manifest: &Manifest) -> Result<Figure, ResultsError> {
    let records = &manifest.rods;
    let outputs = read_nodes(directory, records.iter().map(|rod| rod.nodes).sum())?;
    // Free bodies follow the rods.
    let rods = records.split(|record| record.rigid).next();
    let rods = rods.unwrap_or_default();
    let branches = Branches::read(directory)?;
    // A scenario of an older version may not be readable any more. The rods are still drawn.
    let scenario = from_text(&manifest.name, &manifest.scenario, directory, &[]);
    let scenario = scenario.ok().map(|loaded| loaded.scenario);
    let held = |rod: &RodRecord| {
        let rods = scenario
            .iter()
            .flat_map(|scenario: &Scenario| &scenario.rods);
        rods.into_iter().any(|one| one.held && one.name == rod.name)
    };
    let held: Vec<bool> = rods.iter().map(held).collect();
    let indexed: Vec<(usize, &NodePositions)> = outputs.iter().enumerate().collect();
    let mut snapshots: Vec<Snapshot> = evenly_spread(&indexed, SNAPSHOTS)
        .map(|(index, output)| Snapshot {
            title: title(output.time, *index, outputs.len(), branches.as_ref()),
            rods: curves(output, rods, &held),
        })
        .collect();
    let planes = scenario.iter().flat_map(|scenario| &scenario.planes);
    let obstacles = obstacles_of(scenario.as_ref());
    let positions = outputs.iter().flat_map(|output| &output.positions);
    let surfaces = surfaces(&obstacles, positions);
    let start = (outputs.first()).map_or(&[][..], |output| &output.positions);
    let carried = carried_bodies(scenario.as_ref(), rods, start);
    let threads = threads(scenario.as_ref(), rods, start);
    let free = free_bodies(records, start);
    let bodies = evenly_spread(&indexed, SNAPSHOTS)
        .map(|(_, output)| {
            let mut bodies = bodies_at(&obstacles, &surfaces, output.time);
            bodies.extend(carried.iter().map(|body| body.at(&output.positions)));
            bodies.extend(threads.iter().map(|thread| thread.at(&output.positions)));
            bodies.extend(free.iter().map(|body| body.at(&output.positions)));
            bodies
        })
        .collect();
    let others = [obstacles.len(), carried.len(), threads.len(), free.len()];
    let is_alone = others == [0; 4];
    let is_cut = is_alone && planes.clone().next().is_none() && cut_straight_ends(&mut snapshots);
    let points = snapshots
        .iter()
        .flat_map(|snapshot| &snapshot.rods)
        .flat_map(|rod| &rod.points);
    Ok(Figure::Rods(RodsFigure {
        view: View::fitting(points),
        note: if is_cut {
            "The straight ends are cut off".into()
        } else {
            String::new()
        },
        names: if (2..=NAMED_RODS).contains(&rods.len()) {
            let name = |(rod, held): (&RodRecord, &bool)| match held {
                true => format!("{} (held)", rod.name),
                false => rod.name.clone(),
            };
            rods.iter().zip(&held).map(name).collect()
        } else {
            Vec::new()
        },
        planes: planes
            .map(|plane| Plane {
                point: plane.point.into(),
                normal: plane.normal.into(),
            })
            .collect(),
        bodies,
        snapshots,
    }))
}

/// Label of an output: its time, or its position on a path of equilibria; empty for a single
/// output.
fn title(time: f64, output: usize, outputs: usize, branches: Option<&Branches>) -> String {
    let rounded = (time * 1e3).round() / 1e3;
    match branches {
        _ if outputs < 2 => String::new(),
        None => format!("t = {rounded} s"),
        Some(branches) if branches.are_several() => {
            format!("parameter {rounded}, branch {}", branches.of(output))
        }
        Some(_) => format!("parameter {rounded}"),
    }
}

/// Up to `count` of the items, with the first and the last.
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

fn curves(output: &NodePositions, rods: &[RodRecord], held: &[bool]) -> Vec<RodCurve> {
    let mut rest = output.positions.as_slice();
    let curve = |(rod, held): (&RodRecord, &bool)| {
        let (points, after) = rest.split_at(rod.nodes);
        rest = after;
        RodCurve {
            points: points.to_vec(),
            closed: rod.closed,
            radius: rod.radius,
            radii: rod.radii.clone(),
            held: *held,
        }
    };
    rods.iter().zip(held).map(curve).collect()
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
        let error = plot_results(directory.path(), &FigureOptions::default()).unwrap_err();
        assert!(error.to_string().contains("manifest.json"), "{error}");
        assert!(!matches!(error, PlotError::Results(_)));
    }

    #[test]
    fn figures_are_written_in_every_format_asked_for() {
        let directory = tempfile::tempdir().unwrap();
        let figure = line_plots([], "x");
        let options = FigureOptions {
            formats: vec![Format::Svg, Format::Png, Format::Pdf],
            ..FigureOptions::default()
        };
        let path = directory.path().join("own.eps");
        let written = write_figure(&path, &figure, &options).unwrap();
        let heads: [&[u8]; 3] = [b"<svg", b"\x89PNG", b"%PDF-"];
        for ((path, ending), head) in written.iter().zip(["svg", "png", "pdf"]).zip(heads) {
            assert!(path.ends_with(format!("own.{ending}")));
            assert!(std::fs::read(path).unwrap().starts_with(head));
        }
        // A second time, over its own files.
        write_figure(&path, &figure, &options).unwrap();
    }

    #[test]
    fn pictures_of_a_path_of_equilibria_have_different_names() {
        let branches = Branches::of_numbers([0, 0, 1, 1]);
        let name = |time, output| title(time, output, 4, Some(&branches));
        assert_eq!(name(6.0, 1), "parameter 6, branch 0");
        assert_eq!(name(6.0, 3), "parameter 6, branch 1");
        assert_eq!(title(6.0, 3, 4, None), "t = 6 s");
        assert_eq!(title(0.0, 0, 1, None), "");
    }
}
