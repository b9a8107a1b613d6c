//! What errors of gripper, rod and camera do to a laid rod.

use super::ReproduceError;
use super::cases::Case;
use super::laying::{Disturbance, Laying, PATTERNS};
use super::page::{Page, PageFigure, number};
use super::table::rows_of;
use rodlab_files::figure::{Curve, LinePlot, Look, line_plots};
use serde::{Deserialize, Serialize};
use std::path::Path;

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
pub(super) fn write(page: &mut Page, cases: &[Case<Laying>]) -> Result<(), ReproduceError> {
    let rows: Vec<Row> = cases.iter().map(row).collect();
    page.text(
        "The green rod of thesis Tab. 5.1 on a table of friction 0.4, laid by the optimal scheme: mean distance from the pattern \
         where the gripper moves about its path at random (root mean square in each direction, periods from 1 to 5 s), and \
         where the path is planned for a gravito-bending length that is too large or too small.",
    );
    let header = [
        "pattern",
        "jitter in mm",
        "seed",
        "error of L_gb",
        "distance in cm",
        "slid in cm",
    ];
    let lines: Vec<Vec<String>> = rows.iter().map(line).collect();
    page.table(&header, &lines);
    page.csv(&rows)?;
    for figure in figures(&rows) {
        page.figure(&figure)?;
    }
    Ok(())
}

/// The figures from the table alone.
pub(super) fn figures_of_table(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(figures(&rows_of::<Row>(table)?))
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

fn line(row: &Row) -> Vec<String> {
    vec![
        row.pattern.clone(),
        number(Some(row.jitter_mm), 1),
        row.seed.to_string(),
        format!("{:+.0} %", 1e2 * row.length_error),
        format!(
            "{} ± {}",
            number(row.mean_cm, 3),
            number(row.deviation_cm, 3)
        ),
        number(row.largest_sliding_cm, 3),
    ]
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let of = |wanted: &dyn Fn(&Row) -> bool, place: &dyn Fn(&Row) -> f64| -> LinePlot {
        let curves = PATTERNS.iter().filter_map(|pattern| {
            let chosen = rows.iter().filter(|row| row.pattern == pattern.name);
            let points: Vec<(f64, Option<f64>)> = chosen
                .filter(|row| wanted(row))
                .map(|row| (place(row), row.mean_cm))
                .collect();
            let has_any = !points.is_empty();
            has_any.then(|| Curve::new(pattern.name, points).looking(Look::Marks))
        });
        LinePlot {
            label: "mean distance in cm".into(),
            curves: curves.collect(),
        }
    };
    let jitter = of(&|row| row.length_error == 0.0, &|row| row.jitter_mm);
    let length = of(&|row| row.jitter_mm == 0.0, &|row| 1e2 * row.length_error);
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
