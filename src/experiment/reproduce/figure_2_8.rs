//! Figure 2.8: traction of overhand knots of unknotting number 1 to 4.

use super::ReproduceError;
use super::cases::Case;
use super::page::{Page, number};
use super::tightening::{FRICTION_OF_FIGURE_2_8, Tightening, pulled_rows};
use crate::figure::{Curve, LinePlot, line_plots};
use crate::knot::jawed_shortening;
use serde::Serialize;

/// A row of the CSV file.
#[derive(Clone, Copy, Serialize)]
struct Row {
    unknotting_number: usize,
    /// n² F̄.
    scaled_force: f64,
    /// n² h/e.
    scaled_shortening: f64,
    /// n² h/e by Eq. 2.30.
    jawed_2015: f64,
}

/// A fall of the traction below this part of its peak is inversion; the polyline's corners that slip over each other
/// make it fluctuate less.
const INVERSION: f64 = 0.7;

/// Writes traction over shortening, both scaled with n².
pub(super) fn write(page: &mut Page, cases: &[Case<Tightening>]) -> Result<(), ReproduceError> {
    let mut all = Vec::new();
    let mut curves = Vec::new();
    let mut table = Vec::new();
    for case in cases {
        let rows = measured(case)?;
        curves.push(Curve {
            name: format!("n = {}", case.run.unknotting_number),
            points: rows
                .iter()
                .map(|row| (row.scaled_shortening, Some(row.scaled_force)))
                .collect(),
        });
        table.push(ratios(case.run.unknotting_number, &rows));
        all.extend(rows);
    }
    page.csv(&all)?;
    let largest = all.iter().map(|row| row.scaled_force).fold(0.0, f64::max);
    curves.push(Curve {
        name: "Eq. 2.30".into(),
        points: (1..=200)
            .map(|k| largest * f64::from(k) / 200.0)
            .map(|force| (jawed_shortening(force, FRICTION_OF_FIGURE_2_8), Some(force)))
            .collect(),
    });
    page.text(
        "Eq. 2.30 leaves out the elastic part of the traction, ε⁴/2 of the trefoil, which is why the trefoil is the \
         farthest from it. A knot leaves the law where it inverts.",
    );
    let header = ["n", "mean of n² h/e over Eq. 2.30", "least", "largest"];
    page.table(&header, &table);
    let plot = LinePlot {
        label: "n² F̄".into(),
        curves,
    };
    let svg = line_plots(&[plot], "n² h/e");
    page.figure("fig2.8", "Traction over shortening of overhand knots", &svg)?;
    Ok(())
}

fn measured(case: &Case<Tightening>) -> Result<Vec<Row>, ReproduceError> {
    let n = case.run.unknotting_number;
    let squared = (n * n) as f64;
    let rows = pulled_rows(case)?;
    Ok(rows
        .iter()
        .map(|knot| {
            let scaled_force = squared * knot.force_normalized;
            Row {
                unknotting_number: n,
                scaled_force,
                scaled_shortening: squared * case.run.radius / knot.shortening_m,
                jawed_2015: jawed_shortening(scaled_force.max(0.0), FRICTION_OF_FIGURE_2_8),
            }
        })
        .collect())
}

/// Mean, least and largest ratio of simulation and law before inversion.
fn ratios(unknotting_number: usize, rows: &[Row]) -> Vec<String> {
    let mut peak = 0.0;
    let before_inversion = rows.iter().take_while(|row| {
        peak = row.scaled_force.max(peak);
        row.scaled_force > INVERSION * peak
    });
    let ratios: Vec<f64> = before_inversion
        .map(|row| row.scaled_shortening / row.jawed_2015)
        .collect();
    let count = ratios.len();
    let mean = (count > 0).then(|| ratios.iter().sum::<f64>() / count as f64);
    let extreme = |pick: fn(f64, f64) -> f64| ratios.iter().copied().reduce(pick);
    vec![
        unknotting_number.to_string(),
        number(mean, 3),
        number(extreme(f64::min), 3),
        number(extreme(f64::max), 3),
    ]
}
