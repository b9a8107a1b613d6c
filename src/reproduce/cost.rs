//! What a time step costs over the number of flagella.

use super::ReproduceError;
use super::bundling::Bundling;
use super::cases::Case;
use super::page::{Page, PageFigure, number};
use super::table::rows_of;
use crate::figure::{AxisScale, Curve, LinePlot, Look, PlotStyle, styled_line_plots};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of the CSV file.
#[derive(Serialize, Deserialize)]
struct Row {
    flagella: usize,
    nodes: usize,
    status: String,
    steps: u64,
    steps_with_contact: u64,
    iterations_per_step: f64,
    cpu_time_per_step_s: Option<f64>,
    wall_time_per_step_s: f64,
}

/// Writes the table and the figure.
pub(super) fn write(page: &mut Page, cases: &[Case<Bundling>]) -> Result<(), ReproduceError> {
    let rows: Vec<Row> = cases.iter().map(row).collect();
    page.text(
        "Steps of 1 ms from rest, with the search for contacts but before the flagella meet; the table says how many \
         steps had contacts. Times are those of a whole run over its steps: processor time of all threads, the set-up \
         and the first preconditioner of the fluid included.",
    );
    let header = [
        "M",
        "Nodes",
        "Steps",
        "with contact",
        "Iterations per step",
        "Processor time per step in ms",
        "Wall time per step in ms",
    ];
    let lines: Vec<Vec<String>> = rows.iter().map(line).collect();
    page.table(&header, &lines);
    page.csv(&rows)?;
    Ok(page.figure(&figure(&rows))?)
}

/// The figure from the table alone.
pub(super) fn figures_of_table(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(vec![figure(&rows_of::<Row>(table)?)])
}

fn figure(rows: &[Row]) -> PageFigure {
    let milliseconds = |row: &Row| row.cpu_time_per_step_s.map(|time| 1e3 * time);
    let points = rows
        .iter()
        .map(|row| (row.flagella as f64, milliseconds(row)));
    let plot = LinePlot {
        label: "Processor time of a step in ms".into(),
        curves: vec![Curve::new("rodlab", points.collect()).looking(Look::Marks)],
    };
    let style = PlotStyle {
        horizontal: AxisScale::Logarithmic,
        vertical: vec![AxisScale::Logarithmic],
        ..PlotStyle::default()
    };
    let figure = styled_line_plots([plot], "Number of flagella", style);
    PageFigure::new(
        "cost",
        "Processor time of a step of 1 ms over the number of flagella",
        figure,
    )
}

fn row(case: &Case<Bundling>) -> Row {
    let outcome = &case.record.outcome;
    let steps = outcome.steps as f64;
    Row {
        flagella: case.run.flagella,
        nodes: case.manifest.rods.iter().map(|rod| rod.nodes).sum(),
        status: case.status().into(),
        steps: outcome.steps,
        steps_with_contact: outcome.steps_with_contact,
        iterations_per_step: outcome.newton_iterations as f64 / steps,
        cpu_time_per_step_s: case.record.cpu_time.map(|time| time / steps),
        wall_time_per_step_s: case.record.wall_time / steps,
    }
}

fn line(row: &Row) -> Vec<String> {
    vec![
        row.flagella.to_string(),
        row.nodes.to_string(),
        row.steps.to_string(),
        row.steps_with_contact.to_string(),
        number(Some(row.iterations_per_step), 2),
        number(row.cpu_time_per_step_s.map(|time| 1e3 * time), 2),
        number(Some(1e3 * row.wall_time_per_step_s), 2),
    ]
}
