//! Figure 3.9: the simplified knot, its energy over the rotation of its ends and its equilibria.

use super::inversion::Inversion;
use super::prelude::*;
use rodlab_engine::mechanics::kirchhoff::EndSpin;
use rodlab_planning::knot::SimplifiedKnot;

/// A row of the CSV file: a knot held at a rotation, or a knot in equilibrium, for which energy
/// and moment are empty.
#[derive(Serialize, Deserialize)]
struct Row {
    end_spin: String,
    length_normalized: f64,
    rotation_rad: f64,
    energy_normalized: Option<f64>,
    moment_normalized: Option<f64>,
}

/// Clamped ends of an incompressible rod: GJ/EI = 2/3.
pub(super) const CLAMPED: EndSpin = EndSpin::Clamped {
    stiffness_ratio: 2.0 / 3.0,
};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig3.9",
    title: "Figure 3.9: energy and equilibria of the simplified knot",
    recipe: &Tabled::new(
        |quick| vec![Inversion::of_figure_3_5(quick)[0]],
        Rows::All(rows),
        write,
        figures,
    ),
};
/// The two conditions at the ends of the loop, with their names.
pub(super) const SPINS: [(&str, EndSpin); 2] =
    [("clamped", CLAMPED), ("free to spin", EndSpin::Free)];
/// Unknotting number of the figure.
const NUMBER: usize = 3;
/// Sizes l̄_k whose energies are drawn; the first is that of the thesis.
const LENGTHS: [f64; 3] = [137.5, 150.0, 175.0];
/// Largest l̄_k of the equilibria drawn.
const LARGEST_LENGTH: f64 = 250.0;

/// Difference of rotations above which equilibria belong to different pieces of the curve, rad.
const GAP: f64 = 0.3;

/// Energies and moments of held knots, and the equilibria.
fn rows(_: &[Case<Inversion>]) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (name, spin) in SPINS {
        let knot = SimplifiedKnot::of_thesis(NUMBER, spin);
        for length in LENGTHS {
            let turned = knot.over_rotation(length);
            rows.extend(turned.iter().map(|knot| Row {
                end_spin: name.into(),
                length_normalized: length,
                rotation_rad: knot.rotation,
                energy_normalized: Some(knot.energy),
                moment_normalized: Some(knot.moment),
            }));
        }
        let pieces = knot.equilibria();
        rows.extend(pieces.iter().flatten().map(|point| Row {
            end_spin: name.into(),
            length_normalized: point.length,
            rotation_rad: point.rotation,
            energy_normalized: None,
            moment_normalized: None,
        }));
    }
    Ok(rows)
}

/// Writes energies, moments, equilibria, and the effect of the conditions at the ends of the loop
/// on the fold.
fn write(page: &mut Page, cases: &[Case<Inversion>], _: &[Row]) -> Result<()> {
    page.text(
        "Braid of two helices (Eq. 3.8) and a loop between its ends, solved as a Kirchhoff rod by \
         shooting; φ = π/3, ε = 0.7, n = 3. The ends of the loop lie on the axis of the braid and \
         are either clamped, GJ/EI = 2/3, or free to spin about their tangents. In the latter case \
         the loop snaps over by itself near θ = π/2, where its curve ends.",
    );
    page.figures()?;
    let simulated = cases
        .first()
        .and_then(|case| Inversion::outcome(case).inversion_by_height);
    page.text(&format!(
        "Dependence of the inversion point on choices that section 3.6 of the thesis leaves open or fixes by observation; the \
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
    page.lines(&header, &end_conditions(simulated));
    Ok(())
}

/// Energy and moment over the rotation, and the equilibria.
fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let held = rows.chunk_by(|a, b| {
        let is_same = a.end_spin == b.end_spin && a.length_normalized == b.length_normalized;
        is_same && a.energy_normalized.is_some() == b.energy_normalized.is_some()
    });
    let held: Vec<&[Row]> = held
        .filter(|rows| rows[0].energy_normalized.is_some())
        .collect();
    let over_rotation = |label: &str, value: fn(&Row) -> Option<f64>| {
        let curve = |rows: &&[Row]| {
            let Row {
                end_spin,
                length_normalized,
                ..
            } = &rows[0];
            let name = format!("{end_spin}, l̄_{{k}} = {length_normalized}");
            curve(name, *rows, |row| (row.rotation_rad, value(row)))
        };
        plot(label, held.iter().map(curve))
    };
    let plots = [
        over_rotation("Ē", |row| row.energy_normalized),
        over_rotation("∂Ē/∂θ", |row| row.moment_normalized),
    ];
    let equilibria = SPINS.iter().map(|(name, _)| {
        let rows = rows.iter();
        let rows = rows.filter(|row| row.end_spin == *name && row.energy_normalized.is_none());
        Curve::new(*name, equilibria(&rows.collect::<Vec<_>>()))
    });
    let equilibria = plot("θ in rad", equilibria);
    vec![
        PageFigure::new(
            "fig3.9",
            "Energy of the simplified knot and its derivative over the rotation of the ends of the loop",
            line_plots(plots, "θ in rad"),
        ),
        PageFigure::new(
            "fig3.9_equilibria",
            "Rotation in equilibrium over the size of the knot: where a curve turns back, the knot inverts",
            line_plots([equilibria], "l̄_{k}"),
        ),
    ]
}

/// Points of the equilibria in the drawn range, with a gap between distant pieces.
fn equilibria(rows: &[&Row]) -> Vec<(f64, Option<f64>)> {
    let mut points = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| rows[before]);
        if before.is_some_and(|before| (before.rotation_rad - row.rotation_rad).abs() > GAP) {
            points.push((row.length_normalized, None));
        }
        let is_drawn = row.length_normalized < LARGEST_LENGTH;
        points.push((row.length_normalized, is_drawn.then_some(row.rotation_rad)));
    }
    points
}

/// A row of the table for each changed condition.
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
