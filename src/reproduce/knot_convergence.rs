//! Effect of mesh, pull speed and contact tolerance on the traction of tightened overhand knots.

use super::inversion_page::TIGHTNESS;
use super::overhand_law::force_by_law;
use super::prelude::*;
use super::tightening::{
    Stretch, Tightening, VARIANTS, fluctuation, pulled_rows, range_before_inversion, stretches,
};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "knot-convergence",
    title: "Overhand knots pulled tight: mesh, pull speed and contact tolerance",
    recipe: &Free::new(Tightening::of_convergence, write),
};

/// Number of intervals for the averages of the figure.
const PARTS: usize = 20;

/// A row of the CSV file.
#[derive(Serialize)]
struct Row {
    unknotting_number: usize,
    variant: &'static str,
    /// l̄_k.
    length_normalized: f64,
    /// F̄.
    force_normalized: f64,
}

/// Writes tractions over tightnessin one plot for each unknotting number, and their means over the
/// whole range.
fn write(page: &mut Page, cases: &[Case<Tightening>]) -> Result<()> {
    let mut rows = Vec::new();
    let mut plots = Vec::new();
    let (mut means, mut swings) = (Vec::new(), Vec::new());
    for knots in cases.chunks(VARIANTS.len()) {
        let unknotting_number = knots[0].run.unknotting_number;
        let range = common_range(knots)?;
        let mut curves = Vec::new();
        let mut forces = Vec::new();
        let mut swing = vec![unknotting_number.to_string()];
        for (case, (variant, _)) in knots.iter().zip(VARIANTS) {
            rows.extend(pulled_rows(case)?.iter().map(|knot| Row {
                unknotting_number,
                variant,
                length_normalized: knot.length_normalized,
                force_normalized: knot.force_normalized,
            }));
            let over_law = |part: &Stretch| part.force / force_by_law(&case.run, part.length);
            let parts = stretches(case, range, PARTS)?;
            let points = parts.iter().map(|part| (part.length, Some(over_law(part))));
            curves.push(Curve::new(variant, points.collect()));
            forces.push(stretches(case, range, 1)?.first().map(|whole| whole.force));
            let part = fluctuation(case, range, PARTS)?;
            swing.push(number(part.map(|part| 100.0 * part), 1));
        }
        plots.push(plot(
            format!("F̄ over Eq. 2.30, n = {unknotting_number}"),
            curves,
        ));
        means.push(differences(unknotting_number, range, &forces));
        swings.push(swing);
    }
    page.csv(&rows)?;
    page.text(
        "Overhand knots of figure 2.8 (h = 1.6 mm, L = 1 m, μ = 0.07; 301 nodes, 3 mm/s, contact from a gap of h/80), \
         and the same with one choice at a time changed. Mean traction over the range of l̄_k before any of them \
         inverts, and the effect of the change, in %:",
    );
    let variants = VARIANTS.map(|(variant, _)| variant);
    page.lines(
        &[["n", "l̄_k", "F̄"].as_slice(), &variants[1..]].concat(),
        &means,
    );
    page.text(
        "The corners of the polyline slip over each other, so that the traction swings about that mean. Root mean \
         square of F̄ about its mean over a twentieth of the range, in %:",
    );
    page.lines(&[["n"].as_slice(), &variants].concat(), &swings);
    Ok(page.figure(&PageFigure::new(
        "knot-convergence",
        "Means of the traction over a twentieth of the range each, over the law of Jawed et al. 2015",
        line_plots(plots, TIGHTNESS),
    ))?)
}

/// The range of l̄_k through which all knots pass before any of them inverts; may be empty.
fn common_range(knots: &[Case<Tightening>]) -> Result<[f64; 2]> {
    let mut range: Option<[f64; 2]> = None;
    for knot in knots {
        let Some([tight, loose]) = range_before_inversion(knot)? else {
            return Ok([0.0; 2]);
        };
        let [tightest, loosest] = range.unwrap_or([tight, loose]);
        range = Some([tightest.max(tight), loosest.min(loose)]);
    }
    Ok(range.unwrap_or_default())
}

/// A line of the table: the force of the first knot, and the differences of the others from it.
fn differences(
    unknotting_number: usize,
    [tight, loose]: [f64; 2],
    forces: &[Option<f64>],
) -> Vec<String> {
    let base = forces[0];
    let difference = |force: &Option<f64>| Some(100.0 * (force.as_ref()? / base? - 1.0));
    let mut line = vec![
        unknotting_number.to_string(),
        format!("{loose:.0} to {tight:.0}"),
        base.map_or("–".to_owned(), |force| format!("{force:.3e}")),
    ];
    line.extend(forces[1..].iter().map(|force| {
        difference(force).map_or("–".to_owned(), |percent| format!("{percent:+.2}"))
    }));
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_in_per_cent_of_the_first() {
        let line = differences(2, [100.0, 400.0], &[Some(2e-3), Some(2.02e-3), None]);
        assert_eq!(line, ["2", "400 to 100", "2.000e-3", "+1.00", "–"]);
    }
}
