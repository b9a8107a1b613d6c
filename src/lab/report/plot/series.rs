//! The series of a run over time.

use crate::report::branches::Branches;
use rodlab_files::figure::{Curve, LinePlot};
use rodlab_files::results::SeriesRow;

/// A column of the series.
type Column = fn(&SeriesRow) -> Option<f64>;

/// Energies in one plot, then contacts, distance and iterations. Columns that are always zero or
/// empty are left out. Curves of a path of equilibria are broken between branches.
pub(super) fn series_plots(series: &[SeriesRow], branches: Option<&Branches>) -> Vec<LinePlot> {
    let energies: [(&str, Column); 6] = [
        ("kinetic", |row| Some(row.kinetic_energy_j)),
        ("stretching", |row| Some(row.stretching_energy_j)),
        ("bending", |row| Some(row.bending_energy_j)),
        ("twisting", |row| Some(row.twisting_energy_j)),
        ("contact", |row| Some(row.contact_energy_j)),
        ("gravitational", |row| Some(row.gravitational_energy_j)),
    ];
    let others: [(&str, Column); 3] = [
        ("Contacts", |row| {
            row.contacts.map(|contacts| contacts as f64)
        }),
        ("Smallest distance in mm", |row| {
            row.min_distance_m.map(|distance| 1e3 * distance)
        }),
        ("Newton iterations", |row| row.newton_iterations),
    ];
    let curve = |name: &str, column: Column| {
        let points = series.iter().map(|row| (row.time_s, column(row))).collect();
        let points = match branches {
            Some(branches) => branches.broken(points),
            None => points,
        };
        Curve::new(name, points)
    };
    let energies: Vec<Curve> = energies
        .into_iter()
        .map(|(name, column)| curve(name, column))
        .filter(|curve| {
            let mut energies = curve.points.iter().filter_map(|(_, energy)| *energy);
            energies.any(|energy| energy != 0.0)
        })
        .collect();
    let energy = LinePlot::new("Energy in J", energies);
    let others = others
        .into_iter()
        .map(|(label, column)| LinePlot::new(label, [curve(label, column)]));
    let plots = std::iter::once(energy).chain(others);
    // A column that is always zero carries no information, such as the contacts of a single rod.
    let has_values = |curve: &Curve| {
        let mut values = curve.points.iter().filter_map(|(_, y)| *y);
        values.any(|value| value != 0.0)
    };
    plots
        .filter(|plot| plot.curves.iter().any(has_values))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_that_are_always_zero_and_empty_columns_are_not_plotted() {
        let row = |time_s| SeriesRow {
            time_s,
            contacts: Some(3),
            bending_energy_j: 1e-3 * time_s,
            ..SeriesRow::default()
        };
        let plots = series_plots(&[row(0.0), row(1.0)], None);
        let labels: Vec<&str> = plots.iter().map(|plot| plot.label.as_str()).collect();
        assert_eq!(labels, ["Energy in J", "Contacts"]);
        assert_eq!(plots[0].curves.len(), 1);
        assert_eq!(
            plots[0].curves[0].points,
            [(0.0, Some(0.0)), (1.0, Some(1e-3))]
        );
    }
}
