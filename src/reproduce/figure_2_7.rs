//! Figure 2.7: traction of a trefoil, and its limit for a loose knot.

use super::overhand_law;
use super::prelude::*;
use super::tightening::{FRICTIONS, Tightening, density_in_words, pulled_rows};
use rodlab_files::figure::LinePlot;
use rodlab_lab::experiment::{KnotOutcome, KnotRow};
use rodlab_planning::knot::{TREFOIL_FRICTION, audoly_traction};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig2.7",
    title: "Figure 2.7: a trefoil pulled tight, traction and theory",
    recipe: &Tabled::new(
        Tightening::of_figure_2_7,
        Rows::Series(measured),
        write,
        figures,
    ),
};

/// A row of the CSV file.
#[derive(Clone, Serialize, Deserialize)]
struct Row {
    friction: f64,
    radius_m: f64,
    epsilon: f64,
    force_normalized: f64,
    contact_force_normalized: f64,
    audoly_2007: f64,
}

/// A loose knot: means over a run.
struct Loose {
    epsilon: f64,
    /// F̄ without the work of friction, divided by ε⁴/2.
    frictionless: f64,
    /// σ: contact force P h²/EI divided by ε³.
    sigma: f64,
}

/// Writes traction over tightness, and its limit for ε → 0.
fn write(page: &mut Page, cases: &[Case<Tightening>], rows: &[Row]) -> Result<()> {
    let (mut balances, mut by_law) = (Vec::new(), Vec::new());
    for case in cases.iter().take(FRICTIONS.len()) {
        let friction = case.run.friction;
        if friction > 0.0 {
            by_law.push([vec![friction.to_string()], overhand_law::line(case)?].concat());
        }
        let knot = KnotOutcome::of(&case.record.outcome);
        balances.push(vec![
            friction.to_string(),
            number(knot.and_then(|knot| knot.energy_balance), 4),
            number(slip_work(case)?, 3),
        ]);
    }
    page.text(&density_in_words());
    page.next_figure()?;
    page.text(
        "The energy balance, and the work of friction if all strands slipped by as much as the ends move:",
    );
    let header = [
        "μ",
        "gain of energy and losses over the work of the ends",
        "μ ∫ P de over the loss to friction",
    ];
    page.lines(&header, &balances);
    page.text(
        "Eq. 2.30, which assumes friction only and a braid of many turns, does not apply to a trefoil (figure 2.8): it \
         predicts nearly three times the friction, and is close to the traction only where the terms that it omits \
         happen to compensate.",
    );
    page.lines(&[["μ"].as_slice(), &overhand_law::HEADER].concat(), &by_law);
    limit(page, &loose(rows));
    Ok(())
}

fn measured(case: &Case<Tightening>) -> Result<Vec<Row>> {
    let unit = case.run.traction_unit();
    let row = |knot: &KnotRow| {
        let epsilon = knot.epsilon?;
        Some(Row {
            friction: case.run.friction,
            radius_m: case.run.radius,
            epsilon,
            force_normalized: knot.force_normalized,
            contact_force_normalized: knot.contact_force_n * unit,
            audoly_2007: audoly_traction(epsilon, case.run.friction, TREFOIL_FRICTION),
        })
    };
    Ok(pulled_rows(case)?.iter().filter_map(row).collect())
}

/// μ ∫ P de divided by the energy that is lost to friction while the ends move; `None` without
/// friction.
fn slip_work(case: &Case<Tightening>) -> Result<Option<f64>> {
    let rows = pulled_rows(case)?;
    let slip = |pair: &[KnotRow]| {
        let moved = pair[1].end_to_end_m - pair[0].end_to_end_m;
        0.5 * case.run.friction * (pair[0].contact_force_n + pair[1].contact_force_n) * moved
    };
    let loss = match (rows.first(), rows.last()) {
        (Some(first), Some(last)) => last.friction_loss_j - first.friction_loss_j,
        _ => 0.0,
    };
    let slides = case.run.friction > 0.0 && loss > 0.0;
    Ok(slides.then(|| rows.windows(2).map(slip).sum::<f64>() / loss))
}

/// The loose knots: the runs after those of [`FRICTIONS`].
fn loose(rows: &[Row]) -> Vec<Loose> {
    runs(rows).skip(FRICTIONS.len()).map(Loose::of).collect()
}

/// The rows of each run.
fn runs(rows: &[Row]) -> impl Iterator<Item = &[Row]> {
    rows.chunk_by(|a, b| (a.friction, a.radius_m) == (b.friction, b.radius_m))
}

impl Loose {
    fn of(rows: &[Row]) -> Self {
        let over = |value: fn(&Row) -> f64| mean(rows.iter().map(value)).unwrap_or(f64::NAN);
        Self {
            epsilon: over(|row| row.epsilon),
            frictionless: over(|row| {
                let elastic = row.force_normalized - row.friction * row.contact_force_normalized;
                2.0 * elastic / row.epsilon.powi(4)
            }),
            sigma: over(|row| row.contact_force_normalized / row.epsilon.powi(3)),
        }
    }
}

/// Value at `at` of the polynomial through points, by Lagrange's formula.
fn interpolated(points: &[(f64, f64)], at: f64) -> f64 {
    let weight = |own: usize| {
        let others = points.iter().enumerate().filter(|(other, _)| *other != own);
        others
            .map(|(_, (x, _))| (x - at) / (x - points[own].0))
            .product::<f64>()
    };
    points
        .iter()
        .enumerate()
        .map(|(own, (_, y))| y * weight(own))
        .sum()
}

fn limit(page: &mut Page, loose: &[Loose]) {
    page.text(
        "When the ends move apart by a length, the strands slip on each other by the same length, \
         so that friction does the work μ P per length, where P is the sum of all contact forces. \
         Therefore F̄ = F̄(μ → 0) + μ P h²/EI, and σ of Eq. 2.29 is P h²/(EI ε³). Means over runs \
         of thinner and thinner rods, R ≈ 0.11 m:",
    );
    page.table(columns! { knot in loose;
        "ε" => number(knot.epsilon, 4),
        "(F̄ − μ P h²/EI)/(ε⁴/2)" => number(knot.frictionless, 4),
        "σ = P h²/(EI ε³)" => number(knot.sigma, 4),
    });
    if loose.len() >= 3 {
        let limit = |value: Measure| {
            let points = by_tightness(loose, value);
            let [line, parabola] = [2, 3].map(|count| interpolated(&points[..count], 0.0));
            format!("{parabola:.3} ± {:.3}", (parabola - line).abs())
        };
        page.text(&format!(
            "Extrapolation to ε = 0 by the parabola through the three thinnest rods, ± its \
             distance from the line through the two thinnest: frictionless part {} of ε⁴/2, σ = \
             {}; Eq. 2.29 has 1 and {TREFOIL_FRICTION}.",
            limit(|knot| knot.frictionless),
            limit(|knot| knot.sigma)
        ));
    }
    page.text(
        "Both corrections are of first order in ε with large factors, because the braid is about \
         15 ε R long: σ has doubled near ε = 0.18. Therefore Eq. 2.29 is below simulations and \
         experiments with rods of usual thickness. Eq. 2.30 has σ = 0.975 at n = 1 and ε → 0, \
         twice the right value, because its braid is a uniform double helix; the agreement with \
         knots of usual thickness is a coincidence.",
    );
}

/// Traction over tightness, in one plot for each friction coefficient.
fn traction(rows: &[Row]) -> PageFigure {
    let plots: Vec<LinePlot> = runs(rows)
        .take(FRICTIONS.len())
        .map(|rows| {
            let ours = curve("rodlab", rows, |row| (row.epsilon, row.force_normalized));
            let law = curve("Eq. 2.29", rows, |row| (row.epsilon, row.audoly_2007));
            let label = format!("F̄, μ = {}", rows[0].friction);
            plot(label, [ours, law.looking(Look::Dashed)])
        })
        .collect();
    PageFigure::new(
        "fig2.7",
        "Traction F̄ = F h²/EI over tightness of a trefoil; dashed, the law of loose knots, Eq. 2.29",
        line_plots(plots, "ε = √(h/R)"),
    )
}

/// A quantity of a loose knot.
type Measure = fn(&Loose) -> f64;

/// A quantity of loose knots over their tightness, the loosest knot first.
fn by_tightness(loose: &[Loose], value: Measure) -> Vec<(f64, f64)> {
    let points = loose.iter().map(|knot| (knot.epsilon, value(knot)));
    let mut points: Vec<(f64, f64)> = points.collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// The loose limit: measurements, the line and the parabola for its extrapolation, and Eq. 2.29.
fn loose_limit(loose: &[Loose]) -> PageFigure {
    let over_tightness = |label: &str, value: Measure, theory: f64| {
        let points = by_tightness(loose, value);
        let farthest = points.last().map_or(0.0, |point| point.0);
        let through = |name: &str, count: usize, style_index: usize| {
            let on = points.get(..count).unwrap_or_default();
            let places = (0..=40).map(|k| farthest * f64::from(k) / 40.0);
            let drawn = places.filter(|_| !on.is_empty());
            let extrapolated = curve(name, drawn, |x| (x, interpolated(on, x)));
            extrapolated.looking(Look::Dashed).like(style_index)
        };
        let theory = curve("Eq. 2.29", [theory], |theory| (0.0, theory));
        plot(
            label,
            [
                curve("rodlab", &points, |point| *point).looking(Look::Marks),
                through("parabola through the three thinnest", 3, 0),
                through("line through the two thinnest", 2, 6),
                theory.looking(Look::OpenMarks).like(1),
            ],
        )
    };
    let plots = [
        over_tightness("(F̄ − μ P h²/EI)/(ε⁴/2)", |knot| knot.frictionless, 1.0),
        over_tightness("σ = P h²/(EI ε³)", |knot| knot.sigma, TREFOIL_FRICTION),
    ];
    PageFigure::new(
        "fig2.7_limit",
        "The loose limit of a trefoil: means over runs of ever thinner rods, their extrapolation to ε = 0, and the \
         limit by Eq. 2.29",
        line_plots(plots, "ε = √(h/R)"),
    )
}

/// Traction, and the loose limit.
fn figures(rows: &[Row]) -> Vec<PageFigure> {
    vec![traction(rows), loose_limit(&loose(rows))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_interpolated_exactly() {
        let parabola = |x: f64| 0.5 - 2.0 * x + 3.0 * x * x;
        let points = [0.1, 0.2, 0.4].map(|x| (x, parabola(x)));
        for at in [0.0, 0.3, 1.0] {
            assert!((interpolated(&points, at) - parabola(at)).abs() < 1e-13);
        }
    }
}
