//! Figure 3.4: the inversion of an overhand knot, and the factors that influence its inversion
//! point.

use super::inversion::Inversion;
use super::inversion_page::{Row, figure, plots, rows, runs_of, table};
use super::inversion_pictures::{Moment, pictures, side_view};
use super::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig3.4",
    title: "Figure 3.4: an overhand knot pulled until it inverts",
    recipe: &Tabled::new(
        Inversion::of_figure_3_4,
        Rows::All(|cases| rows(cases, |index, _| NAMES[index].into())),
        write,
        figures,
    ),
};

/// Names of the runs of [`Inversion::of_figure_3_4`], which state their differences.
const NAMES: [&str; 7] = [
    "n = 3, h = 1.6 mm, μ = 0.1",
    "pulled from l̄_k = 312.5",
    "601 nodes",
    "half the speed",
    "gap of h/80",
    "from l̄_k = 165: IMC",
    "from l̄_k = 165: IPC",
];

/// Writes traction and height over tightness, pictures, and the inversion points.
fn write(page: &mut Page, cases: &[Case<Inversion>], _: &[Row]) -> Result<()> {
    let pictures = pictures(&cases[0], &[Moment::Before, Moment::During, Moment::After])?;
    page.figure(&PageFigure::new(
        "fig3.4_knot",
        "The knot before its inversion, when the loop begins to fall across the braid, and after; from the side",
        side_view(pictures),
    ))?;
    page.next_figure()?;
    page.text(
        "The inversion point is l̄_k where the traction falls most steeply, and where the loop reaches the braid. H is \
         the clear height of the loop, from surface to surface, so that it ends at zero; W is the length of the braid. \
         The traction swings because the corners of the polyline slip over each other: the swings become smaller and \
         faster with shorter edges.",
    );
    table(page, "run", cases, |index, _| NAMES[index].into());
    page.text(
        "The name of each run states how it differs from the first. The last two are pulled from l̄_k = 165 at 4 mm/s.",
    );
    Ok(())
}

/// The first run, and the two contact models.
fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let all = runs_of(rows);
    let (first, short) = (all.get(..1), all.get(5..));
    vec![
        figure("fig3.4", first.unwrap_or_default()),
        PageFigure::new(
            "fig3.4_models",
            "The two contact models, IMC and IPC, on the short run",
            plots(short.unwrap_or_default()),
        ),
    ]
}
