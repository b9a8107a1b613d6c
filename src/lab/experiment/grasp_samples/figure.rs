//! Positions of grippers over the suspended length.

use super::row::Sample;
use crate::experiment::data_set::SAMPLES;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, line_plots};
use rodlab_files::results::{ResultsError, read_whole_rows};
use std::path::Path;

/// Maximum number of samples in the figure.
const MARKS: usize = 1000;
/// Upper ends of the ranges of |κ̄|, each of which has its own colour.
const BANDS: [(f64, &str); 3] = [
    (0.5, "|κ̄| up to 0.5"),
    (1.0, "up to 1"),
    (f64::INFINITY, "above 1"),
];

/// The figure of the samples in a results directory.
///
/// # Errors
/// The samples cannot be read.
pub fn samples_figure(directory: &Path) -> Result<Figure, ResultsError> {
    let rows: Vec<Sample> = read_whole_rows(&directory.join(SAMPLES))?.rows;
    Ok(figure(&rows))
}

/// The gripper's position over the suspended length.
pub fn figure(rows: &[Sample]) -> Figure {
    let drawn = || rows.iter().step_by(rows.len().div_ceil(MARKS).max(1));
    let band = |row: &Sample| {
        let curvature = row.curvature.abs();
        BANDS.iter().position(|(largest, _)| curvature <= *largest)
    };
    let plot = |label: &str, value: fn(&Sample) -> Option<f64>| {
        let curves = BANDS.iter().enumerate().map(|(index, (_, name))| {
            let rows = drawn().filter(|row| band(row) == Some(index));
            let points = rows.map(|row| (row.suspended_length, value(row)));
            Curve::new(*name, points.collect()).looking(Look::Marks)
        });
        LinePlot::new(label, curves)
    };
    let plots = [
        plot("gripper ahead, x in L_{gb}", |row| row.x),
        plot("gripper aside, y in L_{gb}", |row| row.y),
        plot("drop in L_{gb}", |row| row.drop),
    ];
    line_plots(plots, "suspended length in L_{gb}")
}
