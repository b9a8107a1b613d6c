//! Figure 3.4: the inversion of an overhand knot, and what its inversion point depends on.

use super::ReproduceError;
use super::cases::Case;
use super::inversion::Inversion;
use super::inversion_page::{Row, figure, plots, rows, runs_of, table};
use super::inversion_pictures::{Moment, pictures, side_view};
use super::page::{Page, PageFigure};
use super::table::rows_of;
use std::path::Path;

/// What distinguishes the runs of [`Inversion::of_figure_3_4`].
const NAMES: [&str; 7] = [
    "n = 3, h = 1.6 mm, μ = 0.1",
    "pulled from l̄_k = 312.5",
    "601 nodes",
    "half the speed",
    "gap of h/80",
    "short: IMC",
    "short: IPC",
];

/// Writes traction and height over tightness, pictures, and the inversion points.
pub(super) fn write(page: &mut Page, cases: &[Case<Inversion>]) -> Result<(), ReproduceError> {
    let names = NAMES.map(str::to_owned);
    let mut all = Vec::new();
    for (name, case) in names.iter().zip(cases) {
        all.push((name.clone(), rows(case, name)?));
    }
    let flat: Vec<_> = all.iter().flat_map(|(_, rows)| rows.clone()).collect();
    page.csv(&flat)?;
    let pictures = pictures(&cases[0], &[Moment::Before, Moment::During, Moment::After])?;
    page.figure(&PageFigure::new(
        "fig3.4_knot",
        "The knot before its inversion, when the loop begins to fall across the braid, and after; from the side",
        side_view(pictures),
    ))?;
    page.figure(&figure("fig3.4", &all[..1]))?;
    page.text(
        "The inversion point is l̄_k where the traction falls most steeply, and where the loop has come to lie on the \
         braid. H is the clear height of the loop, from surface to surface, so that it ends at zero; W is the length \
         of the braid. The traction swings because the corners of the polyline slip over each other: the swings \
         become smaller and faster with shorter edges.",
    );
    table(page, "run", &names, cases);
    page.text(
        "Each run differs from the first in what is named. The last two are pulled from l̄_k = 165 at 4 mm/s.",
    );
    Ok(page.figure(&models(&all))?)
}

/// The figures from the table alone.
pub(super) fn figures_of_table(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    let all = runs_of(&rows_of::<Row>(table)?);
    let first = all.get(..1).unwrap_or_default();
    Ok(vec![figure("fig3.4", first), models(&all)])
}

fn models(all: &[(String, Vec<Row>)]) -> PageFigure {
    let caption = "The two contact models, IMC and IPC, on the short run";
    let short = all.get(5..).unwrap_or_default();
    PageFigure::new("fig3.4_models", caption, plots(short))
}
