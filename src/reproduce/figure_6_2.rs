//! Figures 6.2 and 6.6: the boundary of the stable helices, its surface and its sections.

use super::ReproduceError;
use super::cases::Case;
use super::helices::Helices;
use super::page::{Page, number};
use crate::experiment::helix::stability::{
    BoundaryRow, Part, compare, read_boundary, section_figures,
};
use crate::results::{PAGE, SURFACE};

/// Writes the whole boundary: table, surface, sections, comparison with theory.
pub(super) fn write(page: &mut Page, cases: &[Case<Helices>]) -> Result<(), ReproduceError> {
    for case in cases {
        let rows = read_boundary(&case.directory)?;
        page.csv(&rows)?;
        for file in [SURFACE, PAGE] {
            page.copy(&case.directory.join(file), file)?;
        }
        page.text(
            "Distances ‖(κ, τ, ω)‖ at which a rod of length 1 and bending stiffness 1, its ends clamped to those of a \
             helix, loses stability: of a chain of edges by the first negative pivot of its Hessian, extrapolated \
             from 100 and 200 edges, and of the smooth rod by conjugate points (Borum and Bretl 2020).",
        );
        page.text(&format!(
            "`{PAGE}` shows the surface in the browser; `{SURFACE}` is for ParaView. Every row is in the CSV file, with \
             what became of the rod: most buckle, some touch themselves before, near (0, 1, 2) they stay stable."
        ));
        comparison(page, &rows);
        for (name, svg) in section_figures(&case.directory)? {
            let caption = format!("The boundary in a plane, `{name}`");
            page.figure(name.trim_end_matches(".svg"), &caption, &svg)?;
        }
    }
    Ok(())
}

/// Writes the section ω = 0.
pub(super) fn write_section(
    page: &mut Page,
    cases: &[Case<Helices>],
) -> Result<(), ReproduceError> {
    for case in cases {
        let mut rows = read_boundary(&case.directory)?;
        rows.retain(|row| row.part == Part::KappaTau);
        page.csv(&rows)?;
        page.text(
            "Helices without twisting moment, ω = 0. The thesis holds the discrete rod against a robot's experiments \
             in this plane; here it is held against the conjugate points of the smooth rod.",
        );
        comparison(page, &rows);
        if let Some((_, svg)) = section_figures(&case.directory)?.first() {
            page.figure("fig6.6", "The boundary at ω = 0", svg)?;
        }
    }
    Ok(())
}

fn comparison(page: &mut Page, rows: &[BoundaryRow]) {
    let percent = |part: Option<f64>| number(part.map(|part| 100.0 * part), 4);
    let table: Vec<Vec<String>> = compare(rows)
        .0
        .iter()
        .map(|band| {
            vec![
                band.quantity.to_owned(),
                band.to.map_or_else(
                    || format!("from {}", band.from),
                    |to| format!("{} to {to}", band.from),
                ),
                band.directions.to_string(),
                percent(band.mean_difference),
                percent(band.largest_difference),
                percent(band.within_2e_4),
                percent(band.within_1e_3),
                percent(band.within_5e_3),
            ]
        })
        .collect();
    let header = [
        "Distance",
        "in theory",
        "Directions",
        "Mean difference, %",
        "Largest, %",
        "within 0.02 %, %",
        "within 0.1 %, %",
        "within 0.5 %, %",
    ];
    page.table(&header, &table);
}
