//! Automatic steps over the whole simulated time of the thesis, compared with the growth of a
//! small initial difference.

use super::bundling::{Bundling, STEP_VARIANTS};
use super::difference::{Difference, curve, differences, figure, nodes_of};
use super::prelude::*;
use rodlab_files::results::{SeriesRow, read_series};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "auto-steps",
    title: "Automatic steps over 250 s, two and ten flagella",
    recipe: &Free::new(Bundling::of_auto_steps, write),
};

/// Largest difference of automatic steps, in radii.
const BOUND: f64 = 0.5;

/// Fraction of the simulated time after which the flagella have bundled. Means are computed from
/// then on.
const BUNDLED: f64 = 0.2;

/// A row of the CSV file; differences are ē of thesis Eq. 2.28.
#[derive(Serialize)]
struct Row {
    flagella: usize,
    step: String,
    helix_widening: f64,
    status: &'static str,
    steps: u64,
    retries: u64,
    iterations_per_step: f64,
    wall_time_s: f64,
    cpu_time_s: Option<f64>,
    /// Largest difference over the time that both runs reached.
    difference_radii: Option<f64>,
    /// Time at which the difference first exceeds [`BOUND`].
    bound_exceeded_s: Option<f64>,
    /// Means over the output times after the fraction [`BUNDLED`] of the simulated time.
    mean_bending_energy_j: f64,
    mean_contacts: f64,
}

/// Writes the table and ē over time.
fn write(page: &mut Page, cases: &[Case<Bundling>]) -> Result<()> {
    let (mut rows, mut curves) = (Vec::new(), Vec::new());
    for variants in cases.chunks(STEP_VARIANTS.len()) {
        let measure = nodes_of(&variants[0])?;
        let radius = variants[0].manifest.rods[0].radius;
        for (index, case) in variants.iter().enumerate() {
            let differences = match index {
                0 => Vec::new(),
                _ => differences(&measure, &nodes_of(case)?, radius),
            };
            rows.push(row(case, &differences)?);
            if index > 0 {
                curves.push(curve(name(case), &differences));
            }
        }
    }
    page.text(
        "By backward differences. ē is the mean distance of the nodes from the solution with steps of 1 ms and the \
         same number of flagella, in radii (thesis Eq. 2.28), at the output times. The last run of each number begins \
         with helices wider by 1e-8 of their radius: no method with larger errors per step can keep ē smaller for \
         long. Means are over the last four fifths of the simulated time: where ē has grown, they show whether the \
         motion is still of the same kind.",
    );
    page.table(columns! { row in &rows;
        "Flagella" => row.flagella.to_string(),
        "Step in s" => row.step.clone(),
        "Helices wider by" => if row.helix_widening == 0.0 { "0".into() } else { format!("{:e}", row.helix_widening) },
        "Steps" => row.steps.to_string(),
        "Repeated" => row.retries.to_string(),
        "Iterations per step" => number(row.iterations_per_step, 2),
        "Wall time in s" => number(row.wall_time_s, 0),
        "Processor time in s" => number(row.cpu_time_s, 0),
        "Largest ē" => number(row.difference_radii, 4),
        "ē above 0.5 from, s" => number(row.bound_exceeded_s, 1),
        "Mean bending energy in mJ" => number(1e3 * row.mean_bending_energy_j, 4),
        "Mean contacts" => number(row.mean_contacts, 1),
    });
    page.csv(&rows)?;
    figure(
        page,
        "auto-steps",
        "Mean difference ē of the nodes from steps of 1 ms with the same number of flagella",
        curves,
    )
}

fn row(case: &Case<Bundling>, differences: &[Difference]) -> Result<Row> {
    let outcome = &case.record.outcome;
    let series = read_series(&case.directory)?;
    let bundled: Vec<&SeriesRow> = (series.iter())
        .filter(|row| row.time_s >= BUNDLED * case.run.end)
        .collect();
    let mean =
        |of: fn(&SeriesRow) -> f64| mean(bundled.iter().map(|row| of(row))).unwrap_or(f64::NAN);
    let radii = differences.iter().map(|row| row.mean_difference_radii);
    Ok(Row {
        flagella: case.run.flagella,
        step: case.run.step.in_words(),
        helix_widening: case.run.widening,
        status: case.status(),
        steps: outcome.steps,
        retries: outcome.retries,
        iterations_per_step: outcome.newton_iterations as f64 / outcome.steps as f64,
        wall_time_s: case.record.wall_time,
        cpu_time_s: case.record.cpu_time,
        difference_radii: radii.reduce(f64::max),
        bound_exceeded_s: differences
            .iter()
            .find(|row| row.mean_difference_radii > BOUND)
            .map(|row| row.time_s),
        mean_bending_energy_j: mean(|row| row.bending_energy_j),
        mean_contacts: mean(|row| row.contacts.unwrap_or(0) as f64),
    })
}

/// Name of a curve.
fn name(case: &Case<Bundling>) -> String {
    let what = match case.run.widening {
        0.0 => case.run.step.in_words(),
        widening => format!("helices wider by {widening:e}"),
    };
    format!("{} flagella, {what}", case.run.flagella)
}
