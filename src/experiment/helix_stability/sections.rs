//! Sections of the boundary, the discrete rod over theory.

use super::boundary::{BoundaryRow, Part};
use crate::figure::{Curve, LinePlot, line_plots};
use crate::results::{ResultsError, SECTION_FIGURES, write_whole};
use std::path::Path;

/// The sections: part, names of the axes, and which of (κ, τ, ω) they are.
const SECTIONS: [(Part, [&str; 2], [usize; 2]); 3] = [
    (Part::KappaTau, ["τ L", "κ L"], [1, 0]),
    (Part::KappaOmega, ["ω L/EI", "κ L"], [2, 0]),
    (Part::TauOmega, ["τ L", "ω L/EI"], [1, 2]),
];

/// Draws the sections that there are.
///
/// # Errors
/// [`ResultsError::Io`] where a figure cannot be written.
pub fn draw_sections(rows: &[BoundaryRow], directory: &Path) -> Result<(), ResultsError> {
    for (section, name) in SECTIONS.iter().zip(SECTION_FIGURES) {
        let (part, labels, axes) = section;
        let rows: Vec<&BoundaryRow> = rows.iter().filter(|row| row.part == *part).collect();
        if rows.is_empty() {
            continue;
        }
        let svg = section_figure(&rows, labels, axes);
        write_whole(&directory.join(name), svg.as_bytes())?;
    }
    Ok(())
}

/// The boundary in a plane; broken where there is none.
pub fn section_figure(rows: &[&BoundaryRow], labels: &[&str; 2], axes: &[usize; 2]) -> String {
    let curve = |name: &str, distance: fn(&BoundaryRow) -> Option<f64>| Curve {
        name: name.into(),
        points: rows
            .iter()
            .map(|row| {
                let direction = [row.kappa, row.tau, row.omega];
                let at = distance(row);
                let place = |axis: usize| at.map(|distance| distance * direction[axis]);
                (place(axes[0]).unwrap_or(0.0), place(axes[1]))
            })
            .collect(),
    };
    // Theory may lie far beyond where the search ended, and would make the axes useless.
    let plot = LinePlot {
        label: labels[1].into(),
        curves: vec![
            curve("discrete rod", |row| row.critical),
            curve("theory", |row| row.critical.and(row.theory)),
        ],
    };
    line_plots(&[plot], labels[0])
}
