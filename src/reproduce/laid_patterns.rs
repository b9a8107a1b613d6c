//! Figures 5.10 and 5.11: rods laid along all patterns, with both schemes.

use super::laid_outlines::outlines_figure;
use super::laying::{FRICTIONS, Laying, RODS, Substrate};
use super::prelude::*;
use super::table_5_2::{Row, patterns, row};

pub(super) const FIGURE_5_10: Artifact = Artifact {
    name: "fig5.10",
    title: "Figure 5.10: three rods laid along patterns on fabric",
    recipe: &Free::new(Laying::of_figure_5_10, write_rods),
};

pub(super) const FIGURE_5_11: Artifact = Artifact {
    name: "fig5.11",
    title: "Figure 5.11: a rod laid along patterns on three tables",
    recipe: &Free::new(Laying::of_figure_5_11, write_tables),
};

/// Index of the green rod.
const GREEN: usize = 1;

/// Writes figure 5.10: three rods on fabric.
fn write_rods(page: &mut Page, cases: &[Case<Laying>]) -> Result<()> {
    page.text(
        "The thesis shows photographs of the three rods of Tab. 5.1 on fabric, laid along the patterns of Tab. 5.2 by \
         both schemes. Here they are simulated: Tab. 5.1 calls the friction of fabric low for the rubber rods (0.2) \
         and medium for the rope (0.4). Mean distance and standard deviation are in cm, below them the values measured \
         in the thesis; a star marks patterns that need more friction than the table has.",
    );
    let shown: Vec<(usize, usize)> = (0..RODS.len()).map(|rod| (rod, on_fabric(rod))).collect();
    write(page, cases, &shown)
}

/// Index of the friction of a rod on fabric.
fn on_fabric(rod: usize) -> usize {
    let mut substrates = RODS[rod].substrates.iter();
    let found = substrates.position(|substrate| *substrate == Substrate::Fabric);
    found.unwrap_or(0)
}

/// Writes figure 5.11: the green rod on three tables.
fn write_tables(page: &mut Page, cases: &[Case<Laying>]) -> Result<()> {
    page.text(
        "The thesis shows photographs of the green rod on fabric, steel and foam, laid along the patterns of Tab. 5.2 \
         by both schemes. Here it is simulated: Tab. 5.1 calls their friction low, medium and high, 0.2, 0.4 and 0.8. \
         Mean distance and standard deviation are in cm, below them the values measured in the thesis; a star marks \
         patterns that need more friction than the table has. On fabric the rod is the second of fig5.10.",
    );
    let tables = (0..FRICTIONS.len()).filter(|table| *table != on_fabric(GREEN));
    let shown: Vec<(usize, usize)> = tables.map(|table| (GREEN, table)).collect();
    write(page, cases, &shown)
}

fn write(page: &mut Page, cases: &[Case<Laying>], shown: &[(usize, usize)]) -> Result<()> {
    let rows: Vec<Row> = cases.iter().map(row).collect();
    page.table(patterns(&rows));
    page.csv(&rows)?;
    let name = page.name();
    for &(rod, friction) in shown {
        if let Some(figure) = outlines_figure(name, rod, friction, cases)? {
            page.figure(&figure)?;
        }
    }
    Ok(())
}
