//! Effect of errors of gripper, rod and camera on a laid rod.

use super::laying::{Disturbance, Laying, PATTERNS};
use super::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "deployment-errors",
    title: "Laid rods: jitter of the gripper and errors of the gravito-bending length",
    recipe: &Tabled::new(Laying::of_errors, Rows::Row(row), write, figures),
};

/// A row of the CSV file.
#[derive(Serialize, Deserialize)]
struct Row {
    pattern: String,
    jitter_mm: f64,
    seed: u64,
    length_error: f64,
    status: String,
    mean_cm: Option<f64>,
    deviation_cm: Option<f64>,
    largest_sliding_cm: Option<f64>,
}

/// Writes table and figures.
fn write(page: &mut Page, _: &[Case<Laying>], rows: &[Row]) -> Result<()> {
    page.text(
        "The green rod of thesis Tab. 5.1 on a table of friction 0.4, laid by the optimal scheme: mean distance from the pattern \
         where the gripper deviates from its path at random (root mean square in each direction, periods from 1 to 5 s), and \
         where the path is planned for a gravito-bending length that is too large or too small.",
    );
    page.table(columns! { row in rows;
        "pattern" => row.pattern.clone(),
        "jitter in mm" => number(row.jitter_mm, 1),
        "seed" => row.seed.to_string(),
        "error of L_gb" => format!("{:+.0} %", 1e2 * row.length_error),
        "distance in cm" => format!(
        "{} ± {}",
        number(row.mean_cm, 3),
        number(row.deviation_cm, 3)
        ),
        "slid in cm" => number(row.largest_sliding_cm, 3),
    });
    Ok(())
}

fn row(case: &Case<Laying>) -> Row {
    let run = &case.run;
    let outcome = case.laid();
    let Disturbance {
        jitter,
        seed,
        length_error,
        ..
    } = run.disturbance;
    Row {
        pattern: PATTERNS[run.pattern].name.into(),
        jitter_mm: 1e3 * jitter,
        seed,
        length_error,
        status: case.status().into(),
        mean_cm: outcome.and_then(|laid| laid.mean_error_m).map(|m| 1e2 * m),
        deviation_cm: outcome
            .and_then(|laid| laid.error_deviation_m)
            .map(|m| 1e2 * m),
        largest_sliding_cm: outcome.map(|laid| 1e2 * laid.largest_sliding_m),
    }
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let of = |wanted: fn(&&Row) -> bool, place: fn(&Row) -> f64| {
        let curves = PATTERNS.iter().map(|pattern| {
            let chosen = rows.iter().filter(|row| row.pattern == pattern.name);
            let chosen = chosen.filter(wanted);
            curve(pattern.name, chosen, |row| (place(row), row.mean_cm)).looking(Look::Marks)
        });
        plot(
            "mean distance in cm",
            curves.filter(|curve| !curve.points.is_empty()),
        )
    };
    let jitter = of(|row| row.length_error == 0.0, |row| row.jitter_mm);
    let length = of(|row| row.jitter_mm == 0.0, |row| 1e2 * row.length_error);
    vec![
        PageFigure::new(
            "deployment-errors_jitter",
            "Distance from the pattern over the jitter of the gripper",
            line_plots([jitter], "Jitter in mm, root mean square"),
        ),
        PageFigure::new(
            "deployment-errors_length",
            "Distance from the pattern over the error of the gravito-bending length",
            line_plots([length], "Error of L_{gb} in %"),
        ),
    ]
}
