//! What online correction makes up for: jitter of the gripper and errors of the gravito-bending length.

use super::ReproduceError;
use super::cases::Case;
use super::laying::{Disturbance, Laying, PATTERNS};
use super::page::{Page, PageFigure, number};
use super::table::rows_of;
use rodlab_files::figure::{Curve, LinePlot, Look, line_plots};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of the CSV file.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Row {
    pattern: String,
    jitter_mm: f64,
    seed: u64,
    length_error: f64,
    open_cm: Option<f64>,
    corrected_cm: Option<f64>,
    corrected_with_noise_cm: Option<f64>,
    corrected_sliding_cm: Option<f64>,
}

/// Writes table and figure.
pub(super) fn write(page: &mut Page, cases: &[Case<Laying>]) -> Result<(), ReproduceError> {
    let rows = rows(cases);
    page.text(
        "The green rod of thesis Tab. 5.1 on a table of friction 0.4, laid by the optimal scheme: mean distance from the pattern in cm (thesis \
         Eq. 5.11) along the path as it was planned before (open), and along one that is planned anew each 0.8 gravito-bending lengths, \
         2.6 cm, from where the rod is seen to lie (`[deployment.correction]`). The gripper moves about its path at random (root mean square in \
         each direction, periods from 1 to 5 s), or the path is planned for a gravito-bending length that is a tenth too large or too \
         small. A camera sees places of the lying rod exactly, or with an error of 0.5 mm root mean square in each direction.",
    );
    let header = [
        "pattern",
        "jitter in mm",
        "seed",
        "error of L_gb",
        "open",
        "corrected",
        "with noise of 0.5 mm",
        "slid, corrected",
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

fn rows(cases: &[Case<Laying>]) -> Vec<Row> {
    let open = cases
        .iter()
        .filter(|case| case.run.disturbance.correction.is_none());
    open.map(|case| {
        let disturbance = case.run.disturbance;
        let corrected = |is_seen: fn(f64) -> bool| {
            cases.iter().find(|other| {
                let correction = other.run.disturbance.correction;
                let without = Disturbance {
                    correction: None,
                    ..other.run.disturbance
                };
                correction.is_some_and(is_seen)
                    && other.run.pattern == case.run.pattern
                    && without == disturbance
            })
        };
        let exact = corrected(|noise| noise == 0.0);
        let sliding = exact.and_then(Case::laid);
        Row {
            pattern: PATTERNS[case.run.pattern].name.into(),
            jitter_mm: 1e3 * disturbance.jitter,
            seed: disturbance.seed,
            length_error: disturbance.length_error,
            open_cm: case.mean_error_cm(),
            corrected_cm: exact.and_then(Case::mean_error_cm),
            corrected_with_noise_cm: corrected(|noise| noise > 0.0).and_then(Case::mean_error_cm),
            corrected_sliding_cm: sliding.map(|laid| 1e2 * laid.largest_sliding_m),
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
        number(row.corrected_with_noise_cm, 3),
        number(row.corrected_sliding_cm, 3),
    ]
}

/// Means over the runs with each kind of error.
fn verdict(rows: &[Row]) -> String {
    let mean = |wanted: &dyn Fn(&&Row) -> bool, value: fn(&Row) -> Option<f64>| {
        let values: Vec<f64> = rows.iter().filter(wanted).filter_map(value).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    let of = |name: &str, wanted: &dyn Fn(&&Row) -> bool| {
        let [open, corrected] = [
            mean(wanted, |row| row.open_cm),
            mean(wanted, |row| row.corrected_cm),
        ];
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
            curve("corrected, camera with noise", |row| {
                row.corrected_with_noise_cm
            }),
        ],
    };
    PageFigure::new(
        "deployment-correction",
        "Distance from the pattern as planned before and corrected online, in the order of the table",
        line_plots([plot], "line of the table"),
    )
}
