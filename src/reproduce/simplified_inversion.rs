//! Figures 3.10 and 3.11: inversion points of the simplified knot and of the full simulation.

use super::ReproduceError;
use super::cases::Case;
use super::figure_3_9::SPINS;
use super::inversion::Inversion;
use super::page::{Page, PageFigure, number};
use super::table::rows_of;
use rodlab_files::figure::{Curve, LinePlot, Look, line_plots};
use rodlab_planning::knot::SimplifiedKnot;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of the CSV file: inversion points l̄_k.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Row {
    unknotting_number: usize,
    radius_m: f64,
    simulated: Option<f64>,
    clamped: Option<f64>,
    free_to_spin: Option<f64>,
}

/// Over what the inversion points are drawn.
#[derive(Clone, Copy)]
pub(super) enum Factor {
    /// The radius of the rod.
    Radius,
    /// The unknotting number.
    UnknottingNumber,
}

/// Writes inversion points over the radius (3.10) or the unknotting number (3.11).
pub(super) fn write(
    page: &mut Page,
    factor: Factor,
    cases: &[Case<Inversion>],
) -> Result<(), ReproduceError> {
    let rows: Vec<Row> = cases.iter().map(row).collect();
    page.csv(&rows)?;
    let head = match factor {
        Factor::Radius => "h, mm",
        Factor::UnknottingNumber => "n",
    };
    page.text(
        "The simplified knot (φ = π/3, ε = 0.7, ends of the loop on the axis, no friction, see fig3.9) has no other \
         length than l_k, so that its l̄_k is the same for every radius. φ and ε are those of knots of n = 3 near their \
         inversion, taken for every n. A trefoil has no fold, and does not invert.",
    );
    let header = [
        head,
        "full simulation",
        "clamped",
        "its ratio",
        "free to spin",
        "its ratio",
    ];
    let ratio = |model: Option<f64>, row: &Row| model.zip(row.simulated).map(|(a, b)| a / b);
    let table: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            vec![
                format!("{}", (1e6 * factor.place(row)).round() / 1e6),
                number(row.simulated, 1),
                number(row.clamped, 1),
                number(ratio(row.clamped, row), 3),
                number(row.free_to_spin, 1),
                number(ratio(row.free_to_spin, row), 3),
            ]
        })
        .collect();
    page.table(&header, &table);
    Ok(page.figure(&figure(page.name(), factor, &rows))?)
}

/// The figure from the table alone.
pub(super) fn figures_of_table(
    name: &str,
    factor: Factor,
    table: &Path,
) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(vec![figure(name, factor, &rows_of::<Row>(table)?)])
}

fn figure(name: &str, factor: Factor, rows: &[Row]) -> PageFigure {
    let curve = |name: &str, look: Look, value: fn(&Row) -> Option<f64>| {
        let points = rows.iter().map(|row| (factor.place(row), value(row)));
        Curve::new(name, points.collect()).looking(look)
    };
    let plot = LinePlot {
        label: "l̄_{k} at the inversion".into(),
        curves: vec![
            curve("full simulation, μ = 0.1", Look::Marks, |row| {
                row.simulated
            }),
            curve(
                "simplified, ends of the loop clamped",
                factor.look(),
                |row| row.clamped,
            ),
            curve("simplified, free to spin", factor.look(), |row| {
                row.free_to_spin
            }),
        ],
    };
    let label = match factor {
        Factor::Radius => "Radius h in mm",
        Factor::UnknottingNumber => "Unknotting number n",
    };
    PageFigure::new(
        name,
        "Inversion points of the full simulation and of the simplified knot",
        line_plots([plot], label),
    )
}

impl Factor {
    /// The place of a row along the axis.
    fn place(self, row: &Row) -> f64 {
        match self {
            Self::Radius => 1e3 * row.radius_m,
            Self::UnknottingNumber => row.unknotting_number as f64,
        }
    }

    /// The model has every radius, but only whole numbers n.
    fn look(self) -> Look {
        match self {
            Self::Radius => Look::Dashed,
            Self::UnknottingNumber => Look::OpenMarks,
        }
    }
}

fn row(case: &Case<Inversion>) -> Row {
    let number = case.run.unknotting_number;
    let [clamped, free_to_spin] = SPINS.map(|(_, spin)| {
        let fold = SimplifiedKnot::of_thesis(number, spin).inversion();
        fold.map(|fold| fold.length)
    });
    Row {
        unknotting_number: number,
        radius_m: case.run.radius,
        simulated: Inversion::outcome(case).inversion_by_height,
        clamped,
        free_to_spin,
    }
}
