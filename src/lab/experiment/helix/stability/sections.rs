//! Sections of the boundary, with marks of the discrete rod on curves of theory.

use super::files::SECTION_FIGURES;
use super::row::{BoundaryRow, Part, read_boundary};
use rodlab_engine::mechanics::kirchhoff::{Helix, critical_distance};
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, Paper, plot_to_scale};
use rodlab_files::results::{ResultsError, write_whole};
use std::path::Path;

/// The sections: part, names of the axes, and their indices in (κ, τ, ω).
const SECTIONS: [(Part, [&str; 2], [usize; 2]); 3] = [
    (Part::KappaTau, ["τL", "κL"], [1, 0]),
    (Part::KappaOmega, ["ωL/EI", "κL"], [2, 0]),
    (Part::TauOmega, ["τL", "ωL/EI"], [1, 2]),
];

/// Maximum number of marks of the discrete rod in a figure.
const MARKS: usize = 91;
/// Distance of adjacent points of theory, in multiples of the median distance, above which they
/// are joined only after directions between them are computed: a straight line would cut a corner.
const FAR: f64 = 3.0;
/// Maximum number of times that the angle between two directions is halved. Points that are still
/// far apart are a jump.
const HALVINGS: usize = 10;

/// Writes the existing sections as SVG.
///
/// # Errors
/// [`ResultsError::Io`] if a figure cannot be written.
pub fn draw_sections(rows: &[BoundaryRow], directory: &Path) -> Result<(), ResultsError> {
    for (name, figure) in sections_of(rows) {
        let svg = figure.svg(&Paper::default());
        write_whole(&directory.join(name), svg.as_bytes())?;
    }
    Ok(())
}

/// The sections of the boundary in a results directory, with their file names.
///
/// # Errors
/// `boundary.csv` cannot be read.
pub fn section_figures(directory: &Path) -> Result<Vec<(&'static str, Figure)>, ResultsError> {
    Ok(sections_of(&read_boundary(directory)?))
}

/// The sections among rows of a boundary, with their file names.
pub fn sections_of(rows: &[BoundaryRow]) -> Vec<(&'static str, Figure)> {
    let sections = SECTIONS.iter().zip(SECTION_FIGURES);
    let figure = |((part, labels, axes), name): (&(Part, [&str; 2], [usize; 2]), _)| {
        let rows: Vec<&BoundaryRow> = rows.iter().filter(|row| row.part == *part).collect();
        (!rows.is_empty()).then(|| (name, section_figure(&rows, labels, axes)))
    };
    sections.filter_map(figure).collect()
}

/// The boundary in a plane. The curve is broken where there is no boundary, and at jumps.
fn section_figure(rows: &[&BoundaryRow], labels: &[&str; 2], axes: &[usize; 2]) -> Figure {
    let place = |at: &Option<Place>| match at {
        Some(at) => (
            at.distance * at.direction[axes[0]],
            Some(at.distance * at.direction[axes[1]]),
        ),
        None => (0.0, None),
    };
    let rod = rows.iter().step_by(rows.len().div_ceil(MARKS)).map(|row| {
        Some(Place {
            direction: [row.kappa, row.tau, row.omega],
            distance: row.critical?,
        })
    });
    let theory = theory(rows);
    let plot = LinePlot::new(
        labels[1],
        [
            Curve::new("theory", theory.iter().map(place).collect()),
            Curve::new("discrete rod", rod.map(|at| place(&at)).collect()).looking(Look::Marks),
        ],
    );
    plot_to_scale(plot, labels[0])
}

/// A point of the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    direction: [f64; 3],
    distance: f64,
}

impl Place {
    fn distance_to(&self, other: &Self) -> f64 {
        let part = |axis: usize| {
            self.distance * self.direction[axis] - other.distance * other.direction[axis]
        };
        (0..3).map(|axis| part(axis).powi(2)).sum::<f64>().sqrt()
    }
}

/// The boundary by theory where the discrete rod also has one: theory may lie far beyond the end
/// of the search, and would dominate the axes. `None` breaks the curve.
fn theory(rows: &[&BoundaryRow]) -> Vec<Option<Place>> {
    let sampled: Vec<Option<Place>> = rows
        .iter()
        .map(|row| {
            Some(Place {
                direction: [row.kappa, row.tau, row.omega],
                distance: row.critical.and(row.theory)?,
            })
        })
        .collect();
    let pairs = sampled.windows(2);
    let mut gaps: Vec<f64> = pairs
        .filter_map(|pair| Some(pair[0]?.distance_to(&pair[1]?)))
        .collect();
    gaps.sort_by(f64::total_cmp);
    let far = FAR * gaps.get(gaps.len() / 2).copied().unwrap_or_default();
    let mut curve = Vec::with_capacity(sampled.len());
    for (index, place) in sampled.iter().enumerate() {
        let before = index.checked_sub(1).and_then(|before| sampled[before]);
        if let (Some(before), Some(place)) = (before, place) {
            join(&mut curve, before, *place, far, HALVINGS);
        }
        curve.push(*place);
    }
    curve
}

/// Adds the points between two points of theory: nothing if they are near each other, a break at a
/// jump.
fn join(curve: &mut Vec<Option<Place>>, from: Place, to: Place, far: f64, halvings: usize) {
    if from.distance_to(&to) <= far {
        return;
    }
    let sum = [0, 1, 2].map(|axis| from.direction[axis] + to.direction[axis]);
    let norm = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
    let direction = sum.map(|part| part / norm);
    let [curvature, torsion, twisting_moment] = direction;
    let found = critical_distance(&Helix {
        curvature,
        torsion,
        twisting_moment,
    });
    match found.map(|critical| critical.distance) {
        Some(distance) if halvings > 0 => {
            let middle = Place {
                direction,
                distance,
            };
            join(curve, from, middle, far, halvings - 1);
            curve.push(Some(middle));
            join(curve, middle, to, far, halvings - 1);
        }
        _ => curve.push(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(angle: f64) -> Place {
        let (sine, cosine) = angle.to_radians().sin_cos();
        let direction = [sine, 0.0, cosine];
        let [curvature, torsion, twisting_moment] = direction;
        let helix = Helix {
            curvature,
            torsion,
            twisting_moment,
        };
        let distance = critical_distance(&helix).expect("a boundary").distance;
        Place {
            direction,
            distance,
        }
    }

    #[test]
    fn the_section_at_no_torsion_cuts_no_corners_of_theory() {
        // Coarse directions from the axis of ω to that of κ: between them the boundary runs almost
        // straight outwards.
        let (far, step) = (0.5, 3.0);
        let mut curve = vec![Some(place(1.0))];
        for k in 1..30 {
            let [from, to] = [k - 1, k].map(|k| place(1.0 + step * f64::from(k)));
            join(&mut curve, from, to, far, HALVINGS);
            curve.push(Some(to));
        }
        let joined = curve
            .windows(2)
            .filter_map(|pair| Some((pair[0]?, pair[1]?)));
        for (from, to) in joined {
            assert!(from.distance_to(&to) <= far, "{from:?} {to:?}");
        }
        let breaks = curve.iter().filter(|place| place.is_none()).count();
        assert_eq!(breaks, 0);
        assert!(curve.len() > 40);
    }
}
