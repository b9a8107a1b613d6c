//! The figure of residuals: measured less predicted, for each group of numbers.

use super::identified::{Identified, Residual};
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, line_plots};

/// Maximum number of series that a plot distinguishes.
const MOST_SERIES: usize = 8;

/// Plots residuals over time, or over their index if no times were measured; one plot for each
/// group.
pub fn residuals_figure(identified: &Identified) -> Figure {
    let has_times = identified.residuals.iter().all(|row| row.time_s.is_some());
    let plots = identified.groups.iter().map(|noise| {
        let rows: Vec<&Residual> = (identified.residuals.iter())
            .filter(|row| row.group == noise.group)
            .collect();
        let mut series: Vec<&str> = Vec::new();
        for row in &rows {
            if !series.contains(&row.series.as_str()) {
                series.push(&row.series);
            }
        }
        let at = |index: usize, row: &Residual| match (has_times, row.time_s) {
            (true, Some(time)) => time,
            _ => index as f64 + 1.0,
        };
        let points = |of: &dyn Fn(&Residual) -> bool| {
            let chosen = rows.iter().filter(|row| of(row)).enumerate();
            chosen
                .map(|(index, row)| (at(index, row), Some(row.residual)))
                .collect::<Vec<_>>()
        };
        let curves: Vec<Curve> = match series.len() <= MOST_SERIES {
            true => series
                .iter()
                .map(|name| {
                    Curve::new(*name, points(&|row| row.series == *name)).looking(Look::Marks)
                })
                .collect(),
            false => vec![Curve::new("all series", points(&|_| true)).looking(Look::Marks)],
        };
        // The names of columns include their units.
        let quantity = match noise.group.rsplit(' ').next().unwrap_or_default() {
            "position" => "position in m",
            column => column,
        };
        LinePlot::new(format!("{quantity}: measured − predicted"), curves)
    });
    let label = if has_times {
        "Time in s"
    } else {
        "Number of the measurement"
    };
    line_plots(plots.collect::<Vec<_>>(), label)
}
