//! Figures 6.2 and 6.6: the boundary of the stable helices, its surface and its sections.

use super::ReproduceError;
use super::cases::Case;
use super::helices::Helices;
use super::page::{Page, PageFigure, number};
use super::table::rows_of;
use rodlab_files::figure::{Curve, LinePlot, line_plots};
use rodlab_files::results::PAGE;
use rodlab_lab::experiment::helix::stability::SURFACE;
use rodlab_lab::experiment::helix::stability::{
    BoundaryRow, Part, compare, read_boundary, sections_of,
};
use std::path::Path;

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
        for figure in sections(&rows) {
            page.figure(&figure)?;
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
        for figure in section(&rows) {
            page.figure(&figure)?;
        }
    }
    Ok(())
}

/// The figures of the whole boundary from its table alone.
pub(super) fn figures_of_table(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(sections(&rows_of(table)?))
}

/// The figure of the section ω = 0 from its table alone.
pub(super) fn figures_of_section(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(section(&rows_of(table)?))
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

/// The section ω = 0, and how far the discrete rod is from theory there.
fn section(rows: &[BoundaryRow]) -> Vec<PageFigure> {
    let Some((_, plane)) = sections_of(rows).into_iter().next() else {
        return Vec::new();
    };
    let difference = |name: &str, value: fn(&BoundaryRow) -> Option<f64>| {
        let points = rows.iter().map(|row| {
            let angle = libm::atan2(row.kappa, row.tau).to_degrees();
            (angle, value(row).map(|part| 1e6 * part))
        });
        Curve::new(name, points.collect())
    };
    let plot = LinePlot {
        label: "Difference from theory in 10^{-6}".into(),
        curves: vec![
            difference("200 edges", |row| row.relative_difference),
            difference("extrapolated from 100 and 200 edges", |row| {
                row.relative_difference_extrapolated
            }),
        ],
    };
    vec![
        PageFigure::new(
            "fig6.6",
            "The boundary in the plane ω = 0: the rod is stable on the side of the origin. Line, the smooth rod by \
             conjugate points; marks, the discrete rod",
            plane,
        ),
        PageFigure::new(
            "fig6.6_difference",
            "Distance of the boundary of the discrete rod from that of the smooth one, over it",
            line_plots([plot], "Direction arctan(κ/τ) in degrees"),
        ),
    ]
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
