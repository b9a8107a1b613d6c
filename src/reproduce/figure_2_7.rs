//! Figure 2.7: traction of a trefoil, and the limit of a loose one.

use super::ReproduceError;
use super::cases::Case;
use super::overhand_law;
use super::page::{Page, PageFigure, number};
use super::table::rows_of;
use super::tightening::{FRICTIONS, Tightening, density_in_words, pulled_rows};
use rodlab_files::figure::{Curve, LinePlot, Look, line_plots};
use rodlab_lab::experiment::{KnotOutcome, KnotRow};
use rodlab_planning::knot::{TREFOIL_FRICTION, audoly_traction};
use serde::{Deserialize, Serialize};
use std::path::Path;

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
    /// F̄ less the work of friction, over ε⁴/2.
    frictionless: f64,
    /// Contact force P h²/EI over ε³: σ.
    sigma: f64,
}

/// Writes traction over tightness, and what becomes of it as ε → 0.
pub(super) fn write(page: &mut Page, cases: &[Case<Tightening>]) -> Result<(), ReproduceError> {
    let mut rows = Vec::new();
    let (mut loose, mut balances, mut by_law) = (Vec::new(), Vec::new(), Vec::new());
    for (index, case) in cases.iter().enumerate() {
        let measured = measured(case)?;
        if index < FRICTIONS.len() {
            if case.run.friction > 0.0 {
                let friction = vec![case.run.friction.to_string()];
                by_law.push([friction, overhand_law::line(case)?].concat());
            }
            let knot = KnotOutcome::of(&case.record.outcome);
            let balance = knot.and_then(|knot| knot.energy_balance);
            balances.push(vec![
                case.run.friction.to_string(),
                number(balance, 4),
                number(slip_work(case)?, 3),
            ]);
        } else {
            loose.extend(mean(&measured));
        }
        rows.extend(measured);
    }
    page.csv(&rows)?;
    page.text(&density_in_words());
    page.figure(&traction(&rows))?;
    page.text(
        "The energy balance, and the work of friction, were all strands to slip by as much as the ends move:",
    );
    let header = [
        "μ",
        "gain of energy and losses over the work of the ends",
        "μ ∫ P de over the loss to friction",
    ];
    page.table(&header, &balances);
    page.text(
        "Eq. 2.30, which has friction only and a braid of many turns, is not for a trefoil (figure 2.8): it has nearly \
         three times the friction, and comes near the traction only where what it leaves out happens to make up for it.",
    );
    page.table(&[["μ"].as_slice(), &overhand_law::HEADER].concat(), &by_law);
    limit(page, &loose)
}

fn measured(case: &Case<Tightening>) -> Result<Vec<Row>, ReproduceError> {
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

/// μ ∫ P de over the energy lost to friction while the ends move; `None` without friction.
fn slip_work(case: &Case<Tightening>) -> Result<Option<f64>, ReproduceError> {
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

fn mean(rows: &[Row]) -> Option<Loose> {
    let over =
        |value: &dyn Fn(&Row) -> f64| rows.iter().map(value).sum::<f64>() / rows.len() as f64;
    (!rows.is_empty()).then(|| Loose {
        epsilon: over(&|row| row.epsilon),
        frictionless: over(&|row| {
            let elastic = row.force_normalized - row.friction * row.contact_force_normalized;
            2.0 * elastic / row.epsilon.powi(4)
        }),
        sigma: over(&|row| row.contact_force_normalized / row.epsilon.powi(3)),
    })
}

/// Value at x of the polynomial through points, by Lagrange's formula.
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

fn limit(page: &mut Page, loose: &[Loose]) -> Result<(), ReproduceError> {
    page.text(
        "Friction does the work μ P per length by which the ends move apart, P being the sum of all contact forces: \
         the strands slip on each other by just that length. So F̄ = F̄(μ → 0) + μ P h²/EI, and σ of Eq. 2.29 is \
         P h²/(EI ε³). Means over runs of ever thinner rods, R ≈ 0.11 m:",
    );
    let cells = |knot: &Loose| {
        [knot.epsilon, knot.frictionless, knot.sigma].map(|value| number(Some(value), 4))
    };
    let table: Vec<Vec<String>> = loose.iter().map(|knot| cells(knot).to_vec()).collect();
    page.table(&["ε", "(F̄ − μ P h²/EI)/(ε⁴/2)", "σ = P h²/(EI ε³)"], &table);
    if loose.len() >= 3 {
        let limit = |value: Measure| {
            let points = by_tightness(loose, value);
            let [line, parabola] = [2, 3].map(|count| interpolated(&points[..count], 0.0));
            format!("{parabola:.3} ± {:.3}", (parabola - line).abs())
        };
        page.text(&format!(
            "Extrapolated to ε = 0 by the parabola through the three thinnest, and its distance from the line through \
             the two thinnest: frictionless part {} of ε⁴/2, σ = {}; Eq. 2.29 has 1 and {TREFOIL_FRICTION}.",
            limit(|knot| knot.frictionless),
            limit(|knot| knot.sigma)
        ));
    }
    page.text(
        "Both corrections are of first order in ε with large factors, for the braid is about 15 ε R long: σ has \
         doubled near ε = 0.18. That is why Eq. 2.29 lies below simulations and experiments of usual thickness. Eq. 2.30 \
         has σ = 0.975 at n = 1 and ε → 0, twice too much, for its braid is a uniform double helix; that this is near what \
         knots of usual thickness have is chance.",
    );
    Ok(page.figure(&loose_limit(loose))?)
}

/// The figures from the table alone.
pub(super) fn figures_of_table(table: &Path) -> Result<Vec<PageFigure>, ReproduceError> {
    let rows = rows_of::<Row>(table)?;
    let runs = rows.chunk_by(|a, b| (a.friction, a.radius_m) == (b.friction, b.radius_m));
    let loose: Vec<Loose> = runs.skip(FRICTIONS.len()).filter_map(mean).collect();
    Ok(vec![traction(&rows), loose_limit(&loose)])
}

/// Traction over tightness, a plot for each friction coefficient.
fn traction(rows: &[Row]) -> PageFigure {
    let runs = rows.chunk_by(|a, b| (a.friction, a.radius_m) == (b.friction, b.radius_m));
    let plots: Vec<LinePlot> = runs
        .take(FRICTIONS.len())
        .map(|rows| {
            let points = |value: fn(&Row) -> f64| {
                let points = rows.iter().map(|row| (row.epsilon, Some(value(row))));
                points.collect()
            };
            LinePlot {
                label: format!("F̄, μ = {}", rows[0].friction),
                curves: vec![
                    Curve::new("rodlab", points(|row| row.force_normalized)),
                    Curve::new("Eq. 2.29", points(|row| row.audoly_2007)).looking(Look::Dashed),
                ],
            }
        })
        .collect();
    PageFigure::new(
        "fig2.7",
        "Traction F̄ = F h²/EI over tightness of a trefoil; dashed, the law of loose knots, Eq. 2.29",
        line_plots(plots, "ε = √(h/R)"),
    )
}

/// A number of a loose knot.
type Measure = fn(&Loose) -> f64;

/// A number of loose knots over their tightness, loose ones first.
fn by_tightness(loose: &[Loose], value: Measure) -> Vec<(f64, f64)> {
    let points = loose.iter().map(|knot| (knot.epsilon, value(knot)));
    let mut points: Vec<(f64, f64)> = points.collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// The loose limit: what was measured, the line and the parabola by which it is extrapolated, and Eq. 2.29.
fn loose_limit(loose: &[Loose]) -> PageFigure {
    let plot = |label: &str, value: Measure, theory: f64| {
        let points = by_tightness(loose, value);
        let farthest = points.last().map_or(0.0, |point| point.0);
        let drawn = |points: &[(f64, f64)]| points.iter().map(|(x, y)| (*x, Some(*y))).collect();
        let through = |count: usize| -> Vec<(f64, f64)> {
            let on = points.get(..count).unwrap_or_default();
            let places = (0..=40).map(|k| farthest * f64::from(k) / 40.0);
            let curve = places.map(|x| (x, interpolated(on, x)));
            if on.is_empty() {
                Vec::new()
            } else {
                curve.collect()
            }
        };
        LinePlot {
            label: label.into(),
            curves: vec![
                Curve::new("rodlab", drawn(&points)).looking(Look::Marks),
                Curve::new("parabola through the three thinnest", drawn(&through(3)))
                    .looking(Look::Dashed)
                    .like(0),
                Curve::new("line through the two thinnest", drawn(&through(2)))
                    .looking(Look::Dashed)
                    .like(6),
                Curve::new("Eq. 2.29", vec![(0.0, Some(theory))])
                    .looking(Look::OpenMarks)
                    .like(1),
            ],
        }
    };
    let plots = [
        plot("(F̄ − μ P h²/EI)/(ε⁴/2)", |knot| knot.frictionless, 1.0),
        plot("σ = P h²/(EI ε³)", |knot| knot.sigma, TREFOIL_FRICTION),
    ];
    PageFigure::new(
        "fig2.7_limit",
        "The loose limit of a trefoil: means over runs of ever thinner rods, how they are extrapolated to ε = 0, and \
         the limit by Eq. 2.29",
        line_plots(plots, "ε = √(h/R)"),
    )
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
