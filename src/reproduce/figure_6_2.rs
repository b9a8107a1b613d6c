//! Figures 6.2 and 6.6: the boundary of the stable helices, its surface and its sections.

use super::helices::Helices;
use super::prelude::*;
use rodlab_files::results::PAGE;
use rodlab_lab::experiment::helix::stability::SURFACE;
use rodlab_lab::experiment::helix::stability::{
    BoundaryRow, Part, compare, read_boundary, sections_of,
};

pub(super) const FIGURE_6_2: Artifact = Artifact {
    name: "fig6.2",
    title: "Figure 6.2: the boundary of the stable helices",
    recipe: &Tabled::new(
        |quick| vec![Helices::of_the_thesis(quick)],
        Rows::Series(|case| Ok(read_boundary(&case.directory)?)),
        write,
        sections,
    ),
};

pub(super) const FIGURE_6_6: Artifact = Artifact {
    name: "fig6.6",
    title: "Figure 6.6: the boundary of the stable helices at ω = 0",
    recipe: &Tabled::new(
        |quick| vec![Helices::of_the_thesis(quick)],
        Rows::Series(section_rows),
        write_section,
        section,
    ),
};

/// Writes the whole boundary: surface and comparison with theory.
fn write(page: &mut Page, cases: &[Case<Helices>], rows: &[BoundaryRow]) -> Result<()> {
    for file in [SURFACE, PAGE] {
        page.copy(&cases[0].directory.join(file), file)?;
    }
    page.text(
        "Distances ‖(κ, τ, ω)‖ at which a rod of length 1 and bending stiffness 1, its ends \
         clamped to those of a helix, loses stability: for a chain of edges by the first negative \
         pivot of its Hessian, extrapolated from 100 and 200 edges, and for the smooth rod by \
         conjugate points (Borum and Bretl 2020).",
    );
    page.text(&format!(
        "`{PAGE}` shows the surface in the browser; `{SURFACE}` is for ParaView. Every row is in the CSV file, with \
         the outcome: most rods buckle, some touch themselves first, and near (0, 1, 2) they stay stable."
    ));
    comparison(page, rows);
    Ok(())
}

/// Writes the page of the section ω = 0.
fn write_section(page: &mut Page, _: &[Case<Helices>], rows: &[BoundaryRow]) -> Result<()> {
    page.text(
        "Helices without twisting moment, ω = 0. The thesis compares the discrete rod with a robot's experiments in \
         this plane; here it is compared with the conjugate points of the smooth rod. The boundary itself is the first \
         section of fig6.2.",
    );
    comparison(page, rows);
    Ok(())
}

fn section_rows(case: &Case<Helices>) -> Result<Vec<BoundaryRow>> {
    let mut rows = read_boundary(&case.directory)?;
    rows.retain(|row| row.part == Part::KappaTau);
    Ok(rows)
}

fn sections(rows: &[BoundaryRow]) -> Vec<PageFigure> {
    let planes = ["ω = 0", "τ = 0", "κ = 0, straight rods"];
    let figures = sections_of(rows).into_iter().zip(planes);
    let figure = |((name, figure), plane): ((&str, _), &str)| {
        let caption = format!(
            "The boundary in the plane {plane}: the rod is stable on the side of the origin. Line, the smooth rod by \
             conjugate points; marks, the discrete rod"
        );
        PageFigure::new(name.trim_end_matches(".svg"), &caption, figure)
    };
    figures.map(figure).collect()
}

/// The difference of the discrete rod from theory in the section ω = 0, which is shown by fig6.2.
fn section(rows: &[BoundaryRow]) -> Vec<PageFigure> {
    let difference = |name: &str, value: fn(&BoundaryRow) -> Option<f64>| {
        curve(name, rows, |row| {
            let angle = libm::atan2(row.kappa, row.tau).to_degrees();
            (angle, value(row).map(|part| 1e6 * part))
        })
    };
    let plot = plot(
        "Difference from theory in 10^{-6}",
        [
            difference("200 edges", |row| row.relative_difference),
            difference("extrapolated from 100 and 200 edges", |row| {
                row.relative_difference_extrapolated
            }),
        ],
    );
    vec![PageFigure::new(
        "fig6.6_difference",
        "Distance of the boundary of the discrete rod from that of the smooth one, over it",
        line_plots([plot], "Direction arctan(κ/τ) in degrees"),
    )]
}

fn comparison(page: &mut Page, rows: &[BoundaryRow]) {
    let percent = |part: Option<f64>| number(part.map(|part| 100.0 * part), 4);
    page.table(columns! { band in compare(rows).0;
        "Distance" => band.quantity,
        "in theory" => match band.to {
            Some(to) => format!("{} to {to}", band.from),
            None => format!("from {}", band.from),
        },
        "Directions" => band.directions.to_string(),
        "Mean difference, %" => percent(band.mean_difference),
        "Largest, %" => percent(band.largest_difference),
        "within 0.02 %, %" => percent(band.within_2e_4),
        "within 0.1 %, %" => percent(band.within_1e_3),
        "within 0.5 %, %" => percent(band.within_5e_3),
    });
}
