//! What a time step costs over the number of flagella.

use super::ReproduceError;
use super::bundling::Bundling;
use super::cases::Case;
use super::page::{Page, number};
use crate::figure::{AxisScale, Curve, LinePlot, PlotStyle, styled_line_plots};
use serde::Serialize;

/// A row of the CSV file.
#[derive(Serialize)]
struct Row {
    flagella: usize,
    nodes: usize,
    status: &'static str,
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
    let milliseconds = |row: &Row| row.cpu_time_per_step_s.map(|time| 1e3 * time);
    let plot = LinePlot {
        label: "Processor time in ms".into(),
        curves: vec![Curve {
            name: "rodlab".into(),
            points: rows
                .iter()
                .map(|row| (row.flagella as f64, milliseconds(row)))
                .collect(),
        }],
    };
    let style = PlotStyle {
        horizontal: AxisScale::Logarithmic,
        vertical: vec![AxisScale::Logarithmic],
        marks: true,
        ..PlotStyle::default()
    };
    let figure = styled_line_plots(&[plot], "Number of flagella", &style);
    page.figure("cost", "Processor time of a step of 1 ms", &figure)?;
    Ok(())
}

fn row(case: &Case<Bundling>) -> Row {
    let outcome = &case.record.outcome;
    let steps = outcome.steps as f64;
    Row {
        flagella: case.run.flagella,
        nodes: case.manifest.rods.iter().map(|rod| rod.nodes).sum(),
        status: case.status(),
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
