//! Table 2.2: friction.

use super::ReproduceError;
use super::bundling::Bundling;
use super::cases::Case;
use super::page::{Page, PageFigure, count, number};
use super::table::rows_of;
use rodlab_files::figure::{Curve, LinePlot, Look, line_plots};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Iterations per step with contact, their total and the simulated end in s for μ = 0.1, 0.2, ..., 1.0, as
/// the thesis prints them.
const THESIS: [(f64, f64, f64); 10] = [
    (3.01, 6.02e5, 250.0),
    (3.01, 6.04e5, 250.0),
    (3.61, 7.25e5, 250.0),
    (4.89, 9.83e5, 250.0),
    (6.67, 1.34e6, 250.0),
    (8.71, 1.76e6, 250.0),
    (14.47, 2.72e6, 235.89),
    (14.16, 1.89e6, 180.98),
    (11.1, 1.05e6, 142.72),
    (11.65, 1.02e6, 135.32),
];

/// A row of the CSV file; iterations and times are those of the steps with contact.
#[derive(Serialize, Deserialize)]
struct Row {
    friction: f64,
    status: String,
    iterations_per_step: Option<f64>,
    total_iterations: u64,
    simulated_end_s: f64,
    steps: u64,
    steps_with_contact: u64,
    retries: u64,
    first_contact_s: Option<f64>,
    time_per_step_s: Option<f64>,
    wall_time_s: f64,
    cpu_time_s: Option<f64>,
    min_distance_ratio: Option<f64>,
    thesis_iterations_per_step: f64,
    thesis_total_iterations: f64,
    thesis_simulated_end_s: f64,
}

/// Writes table and figure.
pub(super) fn write(page: &mut Page, cases: &[Case<Bundling>]) -> Result<(), ReproduceError> {
    let rows: Vec<Row> = cases.iter().zip(&THESIS).map(row).collect();
    page.text(
        "Iterations and times are means and totals over the steps with contact, as in the thesis, whose \
         simulations end early where the flagella tangle. How often a step failed and was halved is in the CSV file \
         (`retries`).",
    );
    let header = [
        "μ",
        "Iterations per step",
        "thesis",
        "Total iterations",
        "thesis",
        "Simulated end in s",
        "thesis",
        "Status",
        "Time per step in ms",
        "Least distance / 2h",
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
    let curve = |name: &str, value: fn(&Row) -> Option<f64>| {
        let points = rows.iter().map(|row| (row.friction, value(row)));
        Curve::new(name, points.collect())
    };
    let plot = LinePlot {
        label: "Iterations per step".into(),
        curves: vec![
            curve("rodlab", |row| row.iterations_per_step).looking(Look::Marks),
            curve("thesis", |row| Some(row.thesis_iterations_per_step)).looking(Look::OpenMarks),
        ],
    };
    let figure = line_plots([plot], "Friction coefficient μ");
    PageFigure::new("tab2.2", "Newton iterations per step with contact", figure)
}

fn row((case, thesis): (&Case<Bundling>, &(f64, f64, f64))) -> Row {
    let outcome = &case.record.outcome;
    let &(thesis_iterations_per_step, thesis_total_iterations, thesis_simulated_end_s) = thesis;
    Row {
        friction: case.run.friction,
        status: case.status().into(),
        iterations_per_step: outcome.newton_iterations_mean_with_contact(),
        total_iterations: outcome.newton_iterations_with_contact,
        simulated_end_s: outcome.simulated_time,
        steps: outcome.steps,
        steps_with_contact: outcome.steps_with_contact,
        retries: outcome.retries,
        first_contact_s: outcome.first_contact,
        time_per_step_s: case.time_per_step_with_contact(),
        wall_time_s: case.record.wall_time,
        cpu_time_s: case.record.cpu_time,
        min_distance_ratio: outcome.minimum_distance_ratio,
        thesis_iterations_per_step,
        thesis_total_iterations,
        thesis_simulated_end_s,
    }
}

fn line(row: &Row) -> Vec<String> {
    vec![
        number(Some(row.friction), 1),
        number(row.iterations_per_step, 2),
        number(Some(row.thesis_iterations_per_step), 2),
        count(row.total_iterations as f64),
        count(row.thesis_total_iterations),
        number(Some(row.simulated_end_s), 2),
        number(Some(row.thesis_simulated_end_s), 2),
        row.status.clone(),
        number(row.time_per_step_s.map(|time| 1e3 * time), 3),
        number(row.min_distance_ratio, 4),
    ]
}
