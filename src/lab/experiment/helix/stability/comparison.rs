//! The discrete rod compared with theory, in bands of distance.

use super::files::COMPARISON;
use super::row::{BoundaryRow, Outcome};
use rodlab_files::results::{ResultsError, write_whole};
use serde::Serialize;
use std::path::Path;

/// Upper ends of the bands. Beyond each, meshes resolve the rod less well.
const BANDS: [f64; 3] = [12.0, 25.0, f64::INFINITY];

/// A row of `comparison.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// The column that is compared with theory.
    pub quantity: &'static str,
    /// Least distance by theory.
    pub from: f64,
    /// Largest distance of the band by theory; empty if the band has no upper end.
    pub to: Option<f64>,
    /// Number of directions for which both values exist.
    pub directions: usize,
    /// Mean of |distance/theory − 1|.
    pub mean_difference: Option<f64>,
    /// Largest |distance/theory − 1|.
    pub largest_difference: Option<f64>,
    /// Fraction of the directions that differ by at most 0.02 %.
    pub within_2e_4: Option<f64>,
    /// Fraction of the directions that differ by at most 0.1 %.
    pub within_1e_3: Option<f64>,
    /// Fraction of the directions that differ by at most 0.5 %.
    pub within_5e_3: Option<f64>,
}

/// The bands.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison(pub Vec<Band>);

/// The relative difference of a row, if it is compared.
type Difference = fn(&BoundaryRow) -> Option<f64>;

/// Compares all rows: first with the mesh itself, then with the extrapolation.
pub fn compare(rows: &[BoundaryRow]) -> Comparison {
    let quantities: [(&str, Difference); 2] = [
        ("critical", |row| row.relative_difference),
        ("extrapolated", |row| row.relative_difference_extrapolated),
    ];
    let bands = quantities.into_iter().flat_map(|(quantity, difference)| {
        let mut from = 0.0;
        BANDS.map(|to| {
            let band = band(rows, quantity, difference, from, to);
            from = to;
            band
        })
    });
    Comparison(bands.filter(|band| band.directions > 0).collect())
}

fn band(
    rows: &[BoundaryRow],
    quantity: &'static str,
    difference: Difference,
    from: f64,
    to: f64,
) -> Band {
    let differences: Vec<f64> = rows
        .iter()
        .filter(|row| {
            row.theory
                .is_some_and(|theory| (from..to).contains(&theory))
        })
        .filter_map(|row| difference(row).map(f64::abs))
        .collect();
    Band {
        quantity,
        from,
        to: Some(to).filter(|to| to.is_finite()),
        directions: differences.len(),
        mean_difference: part_of(differences.iter().sum(), differences.len()),
        largest_difference: differences.iter().copied().reduce(f64::max),
        within_2e_4: within(&differences, 2e-4),
        within_1e_3: within(&differences, 1e-3),
        within_5e_3: within(&differences, 5e-3),
    }
}

fn within(differences: &[f64], bound: f64) -> Option<f64> {
    let within = differences
        .iter()
        .filter(|difference| **difference <= bound);
    part_of(within.count() as f64, differences.len())
}

fn part_of(sum: f64, count: usize) -> Option<f64> {
    (count > 0).then(|| sum / count as f64)
}

impl Comparison {
    /// Writes `comparison.csv`.
    ///
    /// # Errors
    /// [`ResultsError::Io`] if it cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), ResultsError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for band in &self.0 {
            writer.serialize(band).expect("plain rows go into memory");
        }
        let bytes = writer.into_inner().expect("memory takes all bytes");
        write_whole(&directory.join(COMPARISON), &bytes)
    }
}

/// The boundary in words.
pub fn remarks(rows: &[BoundaryRow], comparison: &Comparison) -> Vec<String> {
    let count = |outcome| rows.iter().filter(|row| row.outcome == outcome).count();
    let mut remarks = vec![format!(
        "{} directions: {} buckle, {} touch themselves first, {} stay stable, {} without convergence",
        rows.len(),
        count(Outcome::Buckles),
        count(Outcome::TouchesItself),
        count(Outcome::Stable),
        count(Outcome::NoConvergence)
    )];
    for band in &comparison.0 {
        if let (Some(largest), Some(mean)) = (band.largest_difference, band.mean_difference) {
            let to = band.to.map_or("beyond".to_owned(), |to| format!("to {to}"));
            remarks.push(format!(
                "{} distances from {} {to}: {} directions differ from theory by {:.4} % in the mean, {:.3} % at most",
                band.quantity,
                band.from,
                band.directions,
                100.0 * mean,
                100.0 * largest
            ));
        }
    }
    remarks
}

#[cfg(test)]
mod tests {
    use super::super::row::Part;
    use super::*;

    fn row(theory: f64, difference: f64) -> BoundaryRow {
        BoundaryRow {
            part: Part::Surface,
            kappa: 1.0,
            tau: 0.0,
            omega: 0.0,
            outcome: Outcome::Buckles,
            critical: Some(theory * (1.0 + difference)),
            theory: Some(theory),
            relative_difference: Some(difference),
            extrapolated: None,
            relative_difference_extrapolated: None,
            contact: None,
        }
    }

    #[test]
    fn differences_are_gathered_by_distance() {
        let rows = [row(5.0, 1e-4), row(7.0, -2e-3), row(20.0, 4e-3)];
        let Comparison(bands) = compare(&rows);
        let counts: Vec<usize> = bands.iter().map(|band| band.directions).collect();
        assert_eq!(counts, [2, 1]);
        assert_eq!(bands[0].largest_difference, Some(2e-3));
        assert_eq!(bands[0].within_1e_3, Some(0.5));
        assert_eq!(bands[1].within_5e_3, Some(1.0));
        assert_eq!(remarks(&rows, &compare(&rows)).len(), 3);
    }
}
