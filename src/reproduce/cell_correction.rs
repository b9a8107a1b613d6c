//! What correction by the camera makes up for in the virtual cell, through drivers and pictures.

use super::ReproduceError;
use super::cases::Case;
use super::laying::{Disturbance, Laying, PATTERNS};
use super::page::{Page, PageFigure, number};
use super::table::rows_of;
use super::virtual_laying::lay_in_cell;
use rodlab_files::figure::{Curve, LinePlot, Look, line_plots};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of the CSV file; lengths in cm.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Row {
    pattern: String,
    jitter_mm: f64,
    seed: u64,
    length_error: f64,
    /// In the cell.
    open_cm: Option<f64>,
    corrected_cm: Option<f64>,
    /// In plain simulation.
    simulated_open_cm: Option<f64>,
    simulated_corrected_cm: Option<f64>,
}

/// Lays the rod with all errors, and writes table and figure.
pub(super) fn write(page: &mut Page, cases: &[Case<Laying>]) -> Result<(), ReproduceError> {
    let mut laid = Vec::new();
    for case in cases {
        let error = match lay_in_cell(case)? {
            Ok(laid) => Some(1e2 * laid.laid.score.by_arc_length.mean_m),
            Err(error) => {
                tracing::warn!("{}: {error}", case.directory.display());
                None
            }
        };
        laid.push(error);
    }
    let rows = rows(cases, &laid);
    page.text(
        "The green rod of thesis Tab. 5.1 on a table of friction 0.4, laid by the gantry of the virtual cell: mean distance from the pattern \
         in cm at equal arc lengths, in the picture of the camera, along the path as it was planned before (open), and by \
         `rodlab deploy --correct`: each 0.8 gravito-bending lengths the arm stops, the camera looks, and the rest is planned anew. The \
         hand trembles without the arm knowing (root mean square in each direction, periods from 1 to 5 s), or the rod is believed to \
         have a gravito-bending length that is a tenth too large or too small. Beside it the same in plain simulation, where places of \
         the lying rod are seen exactly.",
    );
    let header = [
        "pattern",
        "jitter in mm",
        "seed",
        "error of L_gb",
        "open",
        "corrected",
        "open, simulated",
        "corrected, simulated",
    ];
    let lines: Vec<Vec<String>> = rows.iter().map(line).collect();
    page.table(&header, &lines);
    page.text(&verdict(&rows));
    page.csv(&rows)?;
    Ok(page.figure(&figure(&rows))?)
}

/// The figure from the table alone.
pub(super) fn figures_of_table(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(vec![figure(&rows_of::<Row>(table)?)])
}

fn rows(cases: &[Case<Laying>], laid: &[Option<f64>]) -> Vec<Row> {
    let both = || cases.iter().zip(laid);
    let open = both().filter(|(case, _)| case.run.disturbance.correction.is_none());
    open.map(|(case, laid)| {
        let disturbance = case.run.disturbance;
        let corrected = both().find(|(other, _)| {
            let without = Disturbance {
                correction: None,
                ..other.run.disturbance
            };
            other.run.disturbance.correction.is_some()
                && other.run.pattern == case.run.pattern
                && without == disturbance
        });
        Row {
            pattern: PATTERNS[case.run.pattern].name.into(),
            jitter_mm: 1e3 * disturbance.jitter,
            seed: disturbance.seed,
            length_error: disturbance.length_error,
            open_cm: *laid,
            corrected_cm: corrected.and_then(|(_, laid)| *laid),
            simulated_open_cm: case.mean_error_cm(),
            simulated_corrected_cm: corrected.and_then(|(case, _)| case.mean_error_cm()),
        }
    })
    .collect()
}

fn line(row: &Row) -> Vec<String> {
    vec![
        row.pattern.clone(),
        number(Some(row.jitter_mm), 1),
        row.seed.to_string(),
        format!("{:+.0} %", 1e2 * row.length_error),
        number(row.open_cm, 3),
        number(row.corrected_cm, 3),
        number(row.simulated_open_cm, 3),
        number(row.simulated_corrected_cm, 3),
    ]
}

/// Means over the runs with each kind of error, of those that were laid both ways.
fn verdict(rows: &[Row]) -> String {
    let of = |name: &str, wanted: &dyn Fn(&Row) -> bool| {
        let wanted = rows.iter().filter(|row| wanted(row));
        let pairs: Vec<(f64, f64)> = wanted
            .filter_map(|row| row.open_cm.zip(row.corrected_cm))
            .collect();
        let count = pairs.len() as f64;
        let mean = |value: fn(&(f64, f64)) -> f64| {
            (count > 0.0).then(|| pairs.iter().map(value).sum::<f64>() / count)
        };
        let (open, corrected) = (mean(|pair| pair.0), mean(|pair| pair.1));
        let ratio = corrected
            .zip(open)
            .map(|(corrected, open)| corrected / open);
        format!(
            "{name}: {} cm open, {} cm corrected, {} of it",
            number(open, 3),
            number(corrected, 3),
            number(ratio, 2)
        )
    };
    format!(
        "On average {}; {}; {}.",
        of("with jitter", &|row| row.jitter_mm > 0.0),
        of("with a wrong L_gb", &|row| row.length_error != 0.0),
        of("without an error", &|row| row.jitter_mm == 0.0
            && row.length_error == 0.0),
    )
}

fn figure(rows: &[Row]) -> PageFigure {
    let curve = |name: &str, value: fn(&Row) -> Option<f64>| {
        let numbered = rows.iter().enumerate();
        let points = numbered.map(|(index, row)| (index as f64 + 1.0, value(row)));
        Curve::new(name, points.collect()).looking(Look::Marks)
    };
    let plot = LinePlot {
        label: "mean distance in cm".into(),
        curves: vec![
            curve("open", |row| row.open_cm),
            curve("corrected", |row| row.corrected_cm),
        ],
    };
    PageFigure::new(
        "cell-correction",
        "Distance from the pattern in the virtual cell as planned before and corrected by the camera, in the order of the table",
        line_plots([plot], "line of the table"),
    )
}
