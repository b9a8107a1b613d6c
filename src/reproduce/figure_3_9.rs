//! Figure 3.9: the simplified knot, its energy over the rotation of its ends and its equilibria.

use super::ReproduceError;
use super::cases::Case;
use super::inversion::Inversion;
use super::page::{Page, number};
use crate::figure::{Curve, LinePlot, line_plots};
use crate::knot::{Equilibrium, SimplifiedKnot};
use crate::mechanics::kirchhoff::EndSpin;
use serde::Serialize;

/// A row of the CSV file: a knot held at a rotation, or one in equilibrium, which has no columns for energy and moment.
#[derive(Serialize)]
struct Row {
    end_spin: &'static str,
    length_normalized: f64,
    rotation_rad: f64,
    energy_normalized: Option<f64>,
    moment_normalized: Option<f64>,
}

/// Poisson's ratio of the rod, incompressible: GJ/EI = 2/3.
pub(super) const CLAMPED: EndSpin = EndSpin::Clamped {
    stiffness_ratio: 2.0 / 3.0,
};
/// The two ways to hold the loop's ends, and their names.
pub(super) const SPINS: [(&str, EndSpin); 2] =
    [("clamped", CLAMPED), ("free to spin", EndSpin::Free)];
/// Unknotting number of the figure.
const NUMBER: usize = 3;
/// Sizes l̄_k whose energies are drawn; the first is that of the thesis.
const LENGTHS: [f64; 3] = [137.5, 150.0, 175.0];
/// Largest l̄_k of the equilibria drawn.
const LARGEST_LENGTH: f64 = 250.0;

/// Writes energies, moments, equilibria, and how the fold moves with the conditions at the ends of the loop.
pub(super) fn write(page: &mut Page, cases: &[Case<Inversion>]) -> Result<(), ReproduceError> {
    let mut rows = Vec::new();
    let [mut energies, mut moments, mut equilibria] = [const { Vec::new() }; 3];
    for (name, spin) in SPINS {
        let knot = SimplifiedKnot::of_thesis(NUMBER, spin);
        for length in LENGTHS {
            let turned = knot.over_rotation(length);
            let curve = |value: fn(&crate::knot::RotatedKnot) -> f64| Curve {
                name: format!("{name}, l̄_k = {length}"),
                points: turned
                    .iter()
                    .map(|knot| (knot.rotation, Some(value(knot))))
                    .collect(),
            };
            energies.push(curve(|knot| knot.energy));
            moments.push(curve(|knot| knot.moment));
            rows.extend(turned.iter().map(|knot| Row {
                end_spin: name,
                length_normalized: length,
                rotation_rad: knot.rotation,
                energy_normalized: Some(knot.energy),
                moment_normalized: Some(knot.moment),
            }));
        }
        let pieces = knot.equilibria();
        rows.extend(pieces.iter().flatten().map(|point| Row {
            end_spin: name,
            length_normalized: point.length,
            rotation_rad: point.rotation,
            energy_normalized: None,
            moment_normalized: None,
        }));
        equilibria.push(Curve {
            name: name.into(),
            points: drawn(&pieces),
        });
    }
    page.csv(&rows)?;
    page.text(
        "Braid of two helices (Eq. 3.8) and a loop between its ends, solved as a Kirchhoff rod by shooting; φ = π/3, \
         ε = 0.7, n = 3. The ends of the loop lie on the axis of the braid and are either clamped, GJ/EI = 2/3, or free \
         to spin about their tangents; then the loop snaps over by itself near θ = π/2, where its curve ends.",
    );
    let plot = |label: &str, curves| LinePlot {
        label: label.into(),
        curves,
    };
    let svg = line_plots(&[plot("Ē", energies), plot("∂Ē/∂θ", moments)], "θ, rad");
    page.figure(
        "fig3.9",
        "Energy of the simplified knot over the rotation",
        &svg,
    )?;
    let svg = line_plots(&[plot("θ, rad", equilibria)], "l̄_k");
    page.figure(
        "fig3.9_equilibria",
        "Rotation in equilibrium over l̄_k: where a curve turns back, the knot inverts",
        &svg,
    )?;
    let simulated = cases
        .first()
        .and_then(|case| Inversion::outcome(case).inversion_by_height);
    page.text(&format!(
        "How the inversion point moves with what section 3.6 of the thesis leaves open or fixes by observation; the \
         full simulation with μ = 0.1 inverts at l̄_k = {}:",
        number(simulated, 1)
    ));
    let header = [
        "ends of the loop",
        "changed",
        "l̄_k of the fold",
        "θ, rad",
        "over the simulation",
    ];
    page.table(&header, &end_conditions(simulated));
    Ok(())
}

/// Points of the equilibria in the range drawn, with a gap between pieces.
fn drawn(pieces: &[Vec<Equilibrium>]) -> Vec<(f64, Option<f64>)> {
    let mut points = Vec::new();
    for piece in pieces {
        let inside = piece.iter().filter(|point| point.length < LARGEST_LENGTH);
        points.extend(inside.map(|point| (point.length, Some(point.rotation))));
        points.push((LARGEST_LENGTH, None));
    }
    points
}

/// A row of the table for each condition changed.
fn end_conditions(simulated: Option<f64>) -> Vec<Vec<String>> {
    let mut table = Vec::new();
    for (name, spin) in SPINS {
        let base = SimplifiedKnot::of_thesis(NUMBER, spin);
        let tilted = |degrees: f64| SimplifiedKnot {
            tilt: degrees.to_radians(),
            ..base
        };
        let mut knots = vec![
            ("nothing", base),
            (
                "ends on a right-handed strand",
                SimplifiedKnot {
                    offset: 1.0,
                    ..base
                },
            ),
            (
                "ends on a left-handed strand",
                SimplifiedKnot {
                    offset: -1.0,
                    ..base
                },
            ),
            ("φ = 50°", tilted(50.0)),
            ("φ = 70°", tilted(70.0)),
            ("ε = 0.6", SimplifiedKnot { ratio: 0.6, ..base }),
            ("ε = 0.8", SimplifiedKnot { ratio: 0.8, ..base }),
            (
                "braid of 2n + 1 half turns",
                SimplifiedKnot {
                    turns: base.turns + 0.5,
                    ..base
                },
            ),
        ];
        if spin == CLAMPED {
            let spin = EndSpin::Clamped {
                stiffness_ratio: 1.0,
            };
            knots.push(("GJ/EI = 1", SimplifiedKnot { spin, ..base }));
        }
        table.extend(knots.iter().map(|(changed, knot)| {
            let fold = knot.inversion();
            let length = fold.map(|fold| fold.length);
            vec![
                name.to_owned(),
                (*changed).to_owned(),
                number(length, 1),
                number(fold.map(|fold| fold.rotation), 2),
                number(length.zip(simulated).map(|(model, full)| model / full), 3),
            ]
        }));
    }
    table
}
