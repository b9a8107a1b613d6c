//! Table 2.1: comparison of IMC and IPC.

use super::bundling::{Bundling, ContactModel, FLAGELLA};
use super::page::count;
use super::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "tab2.1",
    title: "Table 2.1: IMC and IPC, iterations and time of bundling flagella",
    recipe: &Tabled::new(Bundling::of_table_2_1, Rows::All(rows), write, figures),
};

/// Values of the thesis for the steps with contact of a run: iterations and time (ms) per step,
/// total iterations, and their time (h).
struct Printed(f64, f64, f64, f64);

/// Rows of the thesis for the numbers of [`FLAGELLA`].
const IMC: [Printed; 4] = [
    Printed(3.00, 10.2, 6.01e5, 0.57),
    Printed(3.01, 21.3, 6.04e5, 1.19),
    Printed(3.02, 67.5, 5.39e5, 3.34),
    Printed(3.12, 389.4, 6.56e5, 22.77),
];
const IPC: [Printed; 4] = [
    Printed(4.00, 18.75, 7.98e5, 1.04),
    Printed(4.00, 39.5, 7.93e5, 2.17),
    Printed(4.01, 95.3, 7.09e5, 4.68),
    Printed(4.02, 477.47, 8.45e5, 27.88),
];

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
    total_run_time_s: Option<f64>,
    /// Ratio of the run time of IPC to that of IMC.
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
fn write(page: &mut Page, cases: &[Case<Bundling>], rows: &[Row]) -> Result<()> {
    page.text(
        "Iterations and times are means and totals over the steps with contact, as in the thesis. Times are \
         processor times. The ratio is the run time of IPC over that of IMC.",
    );
    page.table(columns! { row in rows;
        "Model" => row.model.clone(),
        "M" => row.flagella.to_string(),
        "Iterations per step" => number(row.iterations_per_step, 2),
        "thesis" => number(row.thesis_iterations_per_step, 2),
        "Time per step in ms" => number(row.time_per_step_s.map(|time| 1e3 * time), 3),
        "thesis" => number(1e3 * row.thesis_time_per_step_s, 1),
        "Total iterations" => count(row.total_iterations as f64),
        "thesis" => count(row.thesis_total_iterations),
        "Total run time in s" => number(row.total_run_time_s, 1),
        "thesis" => format!("{:.2} h", row.thesis_total_run_time_s / 3600.0),
        "Ratio" => number(row.run_time_ratio, 2),
        "thesis" => number(row.thesis_run_time_ratio, 2),
        "Least distance / 2h" => number(row.min_distance_ratio, 4),
    });
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
    Ok(())
}

/// The rows of all cases: those of IMC, then those of IPC.
fn rows(cases: &[Case<Bundling>]) -> Result<Vec<Row>> {
    let barrier = &cases[FLAGELLA.len()..];
    let printed = cases.iter().zip(IMC.iter().chain(&IPC)).enumerate();
    let row = |(index, (case, thesis)): (usize, (&Case<Bundling>, &Printed))| {
        let ratios = barrier.get(index % FLAGELLA.len()).zip(IPC.get(index));
        row(case, thesis, ratios)
    };
    Ok(printed.map(row).collect())
}

fn row(
    case: &Case<Bundling>,
    thesis: &Printed,
    barrier: Option<(&Case<Bundling>, &Printed)>,
) -> Row {
    let outcome = &case.record.outcome;
    let &Printed(
        thesis_iterations_per_step,
        time_per_step_ms,
        thesis_total_iterations,
        total_run_time_h,
    ) = thesis;
    let run_time = case.cpu_time_with_contact();
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
        time_per_step_s: case.cpu_time_per_step_with_contact(),
        total_iterations: outcome.newton_iterations_with_contact,
        total_run_time_s: run_time,
        run_time_ratio: barrier
            .and_then(|(case, _)| Some(case.cpu_time_with_contact()? / run_time?))
            .filter(|ratio| ratio.is_finite()),
        wall_time_s: case.record.wall_time,
        cpu_time_s: case.record.cpu_time,
        min_distance_ratio: outcome.minimum_distance_ratio,
        thesis_iterations_per_step,
        thesis_time_per_step_s: 1e-3 * time_per_step_ms,
        thesis_total_iterations,
        thesis_total_run_time_s: 3600.0 * total_run_time_h,
        thesis_run_time_ratio: barrier.map(|(_, barrier)| barrier.3 / total_run_time_h),
    }
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let models = [ContactModel::Imc, ContactModel::Ipc].map(ContactModel::name);
    let curves = models
        .into_iter()
        .enumerate()
        .flat_map(|(style_index, model)| {
            let rows = || rows.iter().filter(|row| row.model == model);
            let ours = curve(model, rows(), |row| {
                (row.flagella as f64, row.iterations_per_step)
            });
            let thesis = curve(format!("{model}, thesis"), rows(), |row| {
                (row.flagella as f64, row.thesis_iterations_per_step)
            });
            [ours.looking(Look::Marks), thesis.looking(Look::OpenMarks)]
                .map(|curve| curve.like(style_index))
        });
    let plot = plot("Iterations per step", curves);
    let figure = line_plots([plot], "Number of flagella");
    vec![PageFigure::new(
        "tab2.1",
        "Newton iterations per step with contact",
        figure,
    )]
}
