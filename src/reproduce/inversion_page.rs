//! What the pages of inversions have in common: the series, their plot, and the table of inversion points.

use super::cases::Case;
use super::inversion::Inversion;
use super::page::{Page, number};
use crate::experiment::KnotRow;
use crate::figure::{Curve, LinePlot, line_plots};
use crate::results::ResultsError;
use serde::Serialize;

/// A row of the CSV file.
#[derive(Clone, Serialize)]
pub(super) struct Row {
    case: String,
    unknotting_number: usize,
    radius_m: f64,
    friction: f64,
    /// l̄_k.
    length_normalized: f64,
    /// F̄.
    force_normalized: f64,
    /// H̄ = H/W.
    height_normalized: Option<f64>,
    loop_height_m: Option<f64>,
    braid_width_m: Option<f64>,
    time_s: f64,
}

/// The series of a run as rows of the page.
pub(super) fn rows(case: &Case<Inversion>, name: &str) -> Result<Vec<Row>, ResultsError> {
    let row = |(time_s, knot): (f64, KnotRow)| Row {
        case: name.to_owned(),
        unknotting_number: case.run.unknotting_number,
        radius_m: case.run.radius,
        friction: case.run.friction,
        length_normalized: knot.length_normalized,
        force_normalized: knot.force_normalized,
        height_normalized: knot.height_normalized,
        loop_height_m: knot.loop_height_m,
        braid_width_m: knot.braid_width_m,
        time_s,
    };
    Ok(Inversion::pulled_rows(case)?.into_iter().map(row).collect())
}

/// F̄ and H̄ over l̄_k, a curve for each run.
pub(super) fn plots(runs: &[(String, Vec<Row>)]) -> String {
    let plot = |label: &str, value: fn(&Row) -> Option<f64>| LinePlot {
        label: label.into(),
        curves: runs
            .iter()
            .map(|(name, rows)| Curve {
                name: name.clone(),
                points: rows
                    .iter()
                    .rev()
                    .map(|row| (row.length_normalized, value(row)))
                    .collect(),
            })
            .collect(),
    };
    let plots = [
        plot("F̄ = F h²/EI", |row| Some(row.force_normalized)),
        plot("H̄ = H/W", |row| row.height_normalized),
    ];
    line_plots(&plots, "l̄_k = (L − l_c)/h")
}

/// The table of inversion points; `head` is the name of the first column, in which the names of the runs stand.
pub(super) fn table(page: &mut Page, head: &str, names: &[String], cases: &[Case<Inversion>]) {
    let header = [
        head,
        "l̄_k by force",
        "l̄_k by height",
        "difference, %",
        "kinetic over elastic energy before, at most",
        "end",
        "wall time, s",
    ];
    let row = |(name, case): (&String, &Case<Inversion>)| {
        let outcome = Inversion::outcome(case);
        vec![
            name.clone(),
            number(outcome.inversion_by_force, 2),
            number(outcome.inversion_by_height, 2),
            number(outcome.inversion_difference.map(|part| 100.0 * part), 2),
            outcome
                .kinetic_over_elastic
                .map_or("–".to_owned(), |ratio| format!("{ratio:.1e}")),
            outcome
                .knot_ending
                .map_or(case.status(), |ending| ending.in_words())
                .to_owned(),
            number(Some(case.record.wall_time), 0),
        ]
    };
    let rows: Vec<Vec<String>> = names.iter().zip(cases).map(row).collect();
    page.table(&header, &rows);
}
