//! Table 2.1: IMC against IPC.

use super::ReproduceError;
use super::bundling::{Bundling, ContactModel, FLAGELLA};
use super::cases::Case;
use super::page::{Page, PageFigure, count, number};
use super::table::rows_of;
use rodlab_files::figure::{Curve, LinePlot, Look, line_plots};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What the thesis prints of a run: over the steps with contact.
struct Printed {
    iterations_per_step: f64,
    time_per_step_ms: f64,
    total_iterations: f64,
    total_run_time_h: f64,
}

/// Rows of the thesis for the numbers of [`FLAGELLA`].
const IMC: [Printed; 4] = [
    printed(3.00, 10.2, 6.01e5, 0.57),
    printed(3.01, 21.3, 6.04e5, 1.19),
    printed(3.02, 67.5, 5.39e5, 3.34),
    printed(3.12, 389.4, 6.56e5, 22.77),
];
const IPC: [Printed; 4] = [
    printed(4.00, 18.75, 7.98e5, 1.04),
    printed(4.00, 39.5, 7.93e5, 2.17),
    printed(4.01, 95.3, 7.09e5, 4.68),
    printed(4.02, 477.47, 8.45e5, 27.88),
];

const fn printed(
    iterations_per_step: f64,
    time_per_step_ms: f64,
    total_iterations: f64,
    total_run_time_h: f64,
) -> Printed {
    Printed {
        iterations_per_step,
        time_per_step_ms,
        total_iterations,
        total_run_time_h,
    }
}

/// A row of the CSV file; iterations and times are those of the steps with contact.
#[derive(Serialize, Deserialize)]
struct Row {
    model: String,
    flagella: usize,
    status: String,
    simulated_time_s: f64,
    steps: u64,
    steps_with_contact: u64,
    first_contact_s: Option<f64>,
    iterations_per_step: Option<f64>,
    time_per_step_s: Option<f64>,
    total_iterations: u64,
    total_run_time_s: f64,
    /// Run time of IPC over that of IMC.
    run_time_ratio: Option<f64>,
    wall_time_s: f64,
    cpu_time_s: Option<f64>,
    min_distance_ratio: Option<f64>,
    thesis_iterations_per_step: f64,
    thesis_time_per_step_s: f64,
    thesis_total_iterations: f64,
    thesis_total_run_time_s: f64,
    thesis_run_time_ratio: Option<f64>,
}

/// Writes table and figure; the cases are those of IMC, then those of IPC.
pub(super) fn write(page: &mut Page, cases: &[Case<Bundling>]) -> Result<(), ReproduceError> {
    let barrier = &cases[FLAGELLA.len()..];
    let thesis = IMC.iter().chain(&IPC);
    let rows: Vec<Row> = cases
        .iter()
        .zip(thesis)
        .enumerate()
        .map(|(index, (case, printed))| {
            let ratios = barrier.get(index % FLAGELLA.len()).zip(IPC.get(index));
            row(case, printed, ratios)
        })
        .collect();
    page.text(
        "Iterations and times are means and totals over the steps with contact, as in the thesis. The ratio is \
         the run time of IPC over that of IMC.",
    );
    let header = [
        "Model",
        "M",
        "Iterations per step",
        "thesis",
        "Time per step in ms",
        "thesis",
        "Total iterations",
        "thesis",
        "Total run time",
        "thesis",
        "Ratio",
        "thesis",
        "Least distance / 2h",
    ];
    let lines: Vec<Vec<String>> = rows.iter().map(line).collect();
    page.table(&header, &lines);
    for (row, case) in rows.iter().zip(cases) {
        if row.status != "finished" {
            page.text(&format!(
                "{} with M = {} ended at {} s: {}.",
                row.model,
                row.flagella,
                row.simulated_time_s,
                case.status()
            ));
        }
    }
    page.csv(&rows)?;
    Ok(page.figure(&figure(&rows))?)
}

/// The figure from the table alone.
pub(super) fn figures_of_table(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(vec![figure(&rows_of::<Row>(table)?)])
}

fn row(
    case: &Case<Bundling>,
    printed: &Printed,
    barrier: Option<(&Case<Bundling>, &Printed)>,
) -> Row {
    let outcome = &case.record.outcome;
    let run_time = case.record.wall_time_with_contact;
    let is_penalty = case.run.model == ContactModel::Imc;
    let barrier = barrier.filter(|_| is_penalty);
    Row {
        model: case.run.model.name().into(),
        flagella: case.run.flagella,
        status: case.status().into(),
        simulated_time_s: outcome.simulated_time,
        steps: outcome.steps,
        steps_with_contact: outcome.steps_with_contact,
        first_contact_s: outcome.first_contact,
        iterations_per_step: outcome.newton_iterations_mean_with_contact(),
        time_per_step_s: case.time_per_step_with_contact(),
        total_iterations: outcome.newton_iterations_with_contact,
        total_run_time_s: run_time,
        run_time_ratio: barrier
            .map(|(case, _)| case.record.wall_time_with_contact / run_time)
            .filter(|ratio| ratio.is_finite()),
        wall_time_s: case.record.wall_time,
        cpu_time_s: case.record.cpu_time,
        min_distance_ratio: outcome.minimum_distance_ratio,
        thesis_iterations_per_step: printed.iterations_per_step,
        thesis_time_per_step_s: 1e-3 * printed.time_per_step_ms,
        thesis_total_iterations: printed.total_iterations,
        thesis_total_run_time_s: 3600.0 * printed.total_run_time_h,
        thesis_run_time_ratio: barrier
            .map(|(_, barrier)| barrier.total_run_time_h / printed.total_run_time_h),
    }
}

fn line(row: &Row) -> Vec<String> {
    vec![
        row.model.clone(),
        row.flagella.to_string(),
        number(row.iterations_per_step, 2),
        number(Some(row.thesis_iterations_per_step), 2),
        number(row.time_per_step_s.map(|time| 1e3 * time), 3),
        number(Some(1e3 * row.thesis_time_per_step_s), 1),
        count(row.total_iterations as f64),
        count(row.thesis_total_iterations),
        format!("{:.1} s", row.total_run_time_s),
        format!("{:.2} h", row.thesis_total_run_time_s / 3600.0),
        number(row.run_time_ratio, 2),
        number(row.thesis_run_time_ratio, 2),
        number(row.min_distance_ratio, 4),
    ]
}

fn figure(rows: &[Row]) -> PageFigure {
    let curve = |name: String, model: &str, value: fn(&Row) -> Option<f64>| {
        let rows = rows.iter().filter(|row| row.model == model);
        Curve::new(
            name,
            rows.map(|row| (row.flagella as f64, value(row))).collect(),
        )
    };
    let models = [ContactModel::Imc, ContactModel::Ipc].map(ContactModel::name);
    let curves = models.into_iter().enumerate().flat_map(|(kin, model)| {
        let ours = curve(model.into(), model, |row| row.iterations_per_step);
        let thesis = curve(format!("{model}, thesis"), model, |row| {
            Some(row.thesis_iterations_per_step)
        });
        [ours.looking(Look::Marks), thesis.looking(Look::OpenMarks)].map(|curve| curve.like(kin))
    });
    let plot = LinePlot {
        label: "Iterations per step".into(),
        curves: curves.collect(),
    };
    let figure = line_plots([plot], "Number of flagella");
    PageFigure::new("tab2.1", "Newton iterations per step with contact", figure)
}
