//! Figures 5.10 and 5.11: rods laid along all patterns, by both schemes.

use super::ReproduceError;
use super::cases::Case;
use super::laid_outlines::outlines_figure;
use super::laying::{FRICTIONS, Laying, PATTERNS, RODS, Substrate};
use super::page::Page;
use super::table_5_2::{Row, lines, row};

/// Index of the green rod.
const GREEN: usize = 1;

/// Writes figure 5.10: three rods on fabric.
pub(super) fn write_rods(page: &mut Page, cases: &[Case<Laying>]) -> Result<(), ReproduceError> {
    page.text(
        "The thesis shows photographs of the three rods of Tab. 5.1 on fabric, laid along the patterns of Tab. 5.2 by both schemes. Here \
         they are simulated: Tab. 5.1 calls the friction of fabric low for the rubber rods (0.2) and medium for the rope (0.4). Mean \
         distance and standard deviation are in cm, below them what the thesis measured; a star marks patterns that ask for more \
         friction than the table has.",
    );
    let shown: Vec<(usize, usize)> = (0..RODS.len())
        .map(|rod| {
            let fabric = RODS[rod].substrates.iter();
            let mut fabric = fabric.enumerate();
            let found = fabric.find(|(_, substrate)| **substrate == Substrate::Fabric);
            (rod, found.map_or(0, |(friction, _)| friction))
        })
        .collect();
    write(page, cases, &shown)
}

/// Writes figure 5.11: the green rod on three tables.
pub(super) fn write_tables(page: &mut Page, cases: &[Case<Laying>]) -> Result<(), ReproduceError> {
    page.text(
        "The thesis shows photographs of the green rod on fabric, steel and foam, laid along the patterns of Tab. 5.2 by both schemes. \
         Here it is simulated: Tab. 5.1 calls their friction low, medium and high, 0.2, 0.4 and 0.8. Mean distance and standard \
         deviation are in cm, below them what the thesis measured; a star marks patterns that ask for more friction than the table \
         has.",
    );
    let shown: Vec<(usize, usize)> = (0..FRICTIONS.len()).map(|table| (GREEN, table)).collect();
    write(page, cases, &shown)
}

fn write(
    page: &mut Page,
    cases: &[Case<Laying>],
    shown: &[(usize, usize)],
) -> Result<(), ReproduceError> {
    let names = PATTERNS.iter().map(|pattern| pattern.name);
    let header: Vec<&str> = ["rod", "table", "scheme"]
        .into_iter()
        .chain(names)
        .collect();
    let rows: Vec<Row> = cases.iter().map(row).collect();
    page.table(&header, &lines(&rows));
    page.csv(&rows)?;
    let name = page.name();
    for &(rod, friction) in shown {
        if let Some(figure) = outlines_figure(name, rod, friction, cases)? {
            page.figure(&figure)?;
        }
    }
    Ok(())
}
