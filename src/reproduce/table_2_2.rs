//! Table 2.2: friction.

use super::bundling::Bundling;
use super::page::count;
use super::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "tab2.2",
    title: "Table 2.2: two flagella with growing friction, convergence",
    recipe: &Tabled::new(Bundling::of_table_2_2, Rows::All(rows), write, figures),
};

/// Iterations per step with contact, their total and the simulated end in s for μ = 0.1, 0.2, ...,
/// 1.0, as printed in the thesis.
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
fn write(page: &mut Page, _: &[Case<Bundling>], rows: &[Row]) -> Result<()> {
    page.text(
        "Iterations and times are means and totals over the steps with contact, as in the thesis, whose \
         simulations end early where the flagella tangle. How often a step failed and was halved is in the CSV file \
         (`retries`). Times are processor times.",
    );
    page.table(columns! { row in rows;
        "μ" => number(row.friction, 1),
        "Iterations per step" => number(row.iterations_per_step, 2),
        "thesis" => number(row.thesis_iterations_per_step, 2),
        "Total iterations" => count(row.total_iterations as f64),
        "thesis" => count(row.thesis_total_iterations),
        "Simulated end in s" => number(row.simulated_end_s, 2),
        "thesis" => number(row.thesis_simulated_end_s, 2),
        "Status" => row.status.clone(),
        "Time per step in ms" => number(row.time_per_step_s.map(|time| 1e3 * time), 3),
        "Least distance / 2h" => number(row.min_distance_ratio, 4),
    });
    Ok(())
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let ours = curve("rodlab", rows, |row| {
        (row.friction, row.iterations_per_step)
    });
    let thesis = curve("thesis", rows, |row| {
        (row.friction, row.thesis_iterations_per_step)
    });
    let curves = [ours.looking(Look::Marks), thesis.looking(Look::OpenMarks)];
    let plot = plot("Iterations per step", curves);
    let figure = line_plots([plot], "Friction coefficient μ");
    vec![PageFigure::new(
        "tab2.2",
        "Newton iterations per step with contact",
        figure,
    )]
}

fn rows(cases: &[Case<Bundling>]) -> Result<Vec<Row>> {
    Ok(cases.iter().zip(&THESIS).map(row).collect())
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
        time_per_step_s: case.cpu_time_per_step_with_contact(),
        wall_time_s: case.record.wall_time,
        cpu_time_s: case.record.cpu_time,
        min_distance_ratio: outcome.minimum_distance_ratio,
        thesis_iterations_per_step,
        thesis_total_iterations,
        thesis_simulated_end_s,
    }
}
