//! Figures of an exploration: measurement against theory.

use super::row::ExplorationRow;
use rodlab_engine::mechanics::kirchhoff::{Helix, critical_distance};
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, line_plots, plot_to_scale};
use std::f64::consts::FRAC_PI_2;

/// Number of directions of the theoretical curve in the section ω = 0.
const CURVE: usize = 181;
/// Largest |ω| of a direction in the section ω = 0.
const FLAT: f64 = 1e-9;

/// Measured distances over theoretical distances, with the line of equality.
pub fn found_and_theory(rows: &[ExplorationRow]) -> Figure {
    let found = rows
        .iter()
        .filter_map(|row| Some((row.theory?, Some(row.found?))));
    let found: Vec<(f64, Option<f64>)> = found.collect();
    let ends = found.iter().map(|(theory, _)| *theory);
    let low = ends.clone().fold(f64::INFINITY, f64::min);
    let high = ends.fold(f64::NEG_INFINITY, f64::max);
    let plot = LinePlot::new(
        "Distance ‖(κ, τ, ω)‖ found by the arm",
        [
            Curve::new("found = theory", vec![(low, Some(low)), (high, Some(high))]),
            Curve::new("explored directions", found).looking(Look::Marks),
        ],
    );
    line_plots([plot], "Distance ‖(κ, τ, ω)‖ of theory")
}

/// Whether all directions lie in the section ω = 0.
pub fn is_section(rows: &[ExplorationRow]) -> bool {
    rows.iter().all(|row| row.omega.abs() < FLAT)
}

/// The section ω = 0: theoretical region of stable helices, and measurements in unit directions
/// with |ω| up to `near`.
pub fn section_figure(rows: &[ExplorationRow], near: f64) -> Figure {
    let theory = (0..CURVE).map(|k| {
        let (sine, cosine) = libm::sincos(FRAC_PI_2 * k as f64 / (CURVE - 1) as f64);
        let helix = Helix::from([sine, cosine.max(0.0), 0.0]);
        match critical_distance(&helix) {
            Some(critical) => (
                critical.distance * helix.torsion,
                Some(critical.distance * helix.curvature),
            ),
            None => (0.0, None),
        }
    });
    let flat = rows.iter().filter(|row| row.omega.abs() <= near);
    let found = flat.filter_map(|row| Some((row.found? * row.tau, Some(row.found? * row.kappa))));
    let mut curves = vec![Curve::new("theory, ω = 0", theory.collect())];
    let found: Vec<(f64, Option<f64>)> = found.collect();
    if !found.is_empty() {
        curves.push(Curve::new("found", found).looking(Look::Marks));
    }
    let plot = LinePlot::new("κL", curves);
    plot_to_scale(plot, "τL")
}
