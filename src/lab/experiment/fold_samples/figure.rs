//! The workspace with its samples.

use super::keys::FoldSamples;
use super::row::Sample;
use crate::experiment::data_set::{SAMPLES, Span};
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, plot_to_scale};
use rodlab_files::results::{ResultsError, read_whole_rows};
use rodlab_planning::plan::fold::Workspace;
use std::path::Path;

/// Maximum number of samples in the figure.
const MARKS: usize = 1500;
/// Upper ends of the ranges of λ, each of which has its own colour.
const BANDS: [(f64, &str); 3] = [
    (0.1, "λ up to 0.1"),
    (0.5, "up to 0.5"),
    (f64::INFINITY, "above 0.5"),
];

/// The figure of the samples in a results directory.
///
/// # Errors
/// The samples cannot be read.
pub fn samples_figure(directory: &Path, plan: &FoldSamples) -> Result<Figure, ResultsError> {
    let rows: Vec<Sample> = read_whole_rows(&directory.join(SAMPLES))?.rows;
    Ok(figure(&rows, plan))
}

/// Positions of the gripper in ranges of λ, to scale, with the outline of the workspace and the
/// border of the penalty region.
pub fn figure(rows: &[Sample], plan: &FoldSamples) -> Figure {
    let drawn = || rows.iter().step_by(rows.len().div_ceil(MARKS).max(1));
    let band = |row: &Sample| {
        let ratio = row.lambda?;
        BANDS.iter().position(|(largest, _)| ratio <= *largest)
    };
    let curves = BANDS.iter().enumerate().map(|(index, (_, name))| {
        let rows = drawn().filter(|row| band(row) == Some(index));
        let points = rows.map(|row| (row.x, Some(row.z))).collect();
        Curve::new(*name, points).looking(Look::Marks)
    });
    let line = |name: &str, places: Vec<[f64; 2]>| {
        let points = places.into_iter().map(|[x, z]| (x, Some(z)));
        Curve::new(name, points.collect())
    };
    let Span { from, to } = plan.suspended_length;
    let outline = Workspace::new([from, to]).map(|workspace| {
        let mut places = workspace.outline().to_vec();
        places.extend(places.first().copied());
        line("workspace", places)
    });
    let least = plan.least_suspended_length;
    let penalty = (from..to)
        .contains(&least)
        .then(|| Workspace::places_of_length(least))
        .flatten()
        .map(|places| line("penalty region", places).looking(Look::Dashed));
    let plot = LinePlot::new("z/L_{gb}", curves.chain(outline).chain(penalty));
    plot_to_scale(plot, "x/L_{gb}")
}
