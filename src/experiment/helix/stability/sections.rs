//! Sections of the boundary, the discrete rod over theory.

use super::row::{BoundaryRow, Part, read_boundary};
use crate::figure::{Curve, LinePlot, PlotStyle, styled_line_plots};
use crate::results::{ResultsError, SECTION_FIGURES, write_whole};
use std::path::Path;

/// The sections: part, names of the axes, and which of (κ, τ, ω) they are.
const SECTIONS: [(Part, [&str; 2], [usize; 2]); 3] = [
    (Part::KappaTau, ["τ L", "κ L"], [1, 0]),
    (Part::KappaOmega, ["ω L/EI", "κ L"], [2, 0]),
    (Part::TauOmega, ["τ L", "ω L/EI"], [1, 2]),
];

/// Most marks of the discrete rod in a figure.
const MARKS: usize = 91;
/// Height of a figure, pixels.
const HEIGHT: u32 = 420;

/// Writes the sections that there are as SVG.
///
/// # Errors
/// [`ResultsError::Io`] where a figure cannot be written.
pub fn draw_sections(rows: &[BoundaryRow], directory: &Path) -> Result<(), ResultsError> {
    for (name, svg) in figures(rows) {
        write_whole(&directory.join(name), svg.as_bytes())?;
    }
    Ok(())
}

/// The sections of the boundary in a results directory, by the names of their files.
///
/// # Errors
/// Where `boundary.csv` cannot be read.
pub fn section_figures(directory: &Path) -> Result<Vec<(&'static str, String)>, ResultsError> {
    Ok(figures(&read_boundary(directory)?).collect())
}

fn figures(rows: &[BoundaryRow]) -> impl Iterator<Item = (&'static str, String)> {
    let sections = SECTIONS.iter().zip(SECTION_FIGURES);
    sections.filter_map(|((part, labels, axes), name)| {
        let rows: Vec<&BoundaryRow> = rows.iter().filter(|row| row.part == *part).collect();
        (!rows.is_empty()).then(|| (name, section_figure(&rows, labels, axes)))
    })
}

/// The boundary in a plane; broken where there is none.
fn section_figure(rows: &[&BoundaryRow], labels: &[&str; 2], axes: &[usize; 2]) -> String {
    let curve = |name: &str, every: usize, distance: fn(&BoundaryRow) -> Option<f64>| Curve {
        name: name.into(),
        points: rows
            .iter()
            .step_by(every)
            .map(|row| {
                let direction = [row.kappa, row.tau, row.omega];
                let at = distance(row);
                let place = |axis: usize| at.map(|distance| distance * direction[axis]);
                (place(axes[0]).unwrap_or(0.0), place(axes[1]))
            })
            .collect(),
    };
    let rod = "discrete rod".to_owned();
    let plot = LinePlot {
        label: labels[1].into(),
        curves: vec![
            // Theory may lie far beyond where the search ended, and would make the axes useless.
            curve("theory", 1, |row| row.critical.and(row.theory)),
            curve(&rod, rows.len().div_ceil(MARKS), |row| row.critical),
        ],
    };
    let style = PlotStyle {
        unjoined: vec![rod],
        height: HEIGHT,
        ..PlotStyle::default()
    };
    styled_line_plots(&[plot], labels[0], &style)
}
