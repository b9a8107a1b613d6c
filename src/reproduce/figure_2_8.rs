//! Figure 2.8: traction of overhand knots of unknotting number 1 to 4.

use super::overhand_law::{HEADER, line};
use super::prelude::*;
use super::tightening::{FRICTION_OF_FIGURE_2_8, Tightening, density_in_words, pulled_rows};
use rodlab_planning::knot::jawed_shortening;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig2.8",
    title: "Figure 2.8: overhand knots pulled tight, traction and theory",
    recipe: &Tabled::new(
        Tightening::of_figure_2_8,
        Rows::Series(measured),
        write,
        figures,
    ),
};

/// A row of the CSV file.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Row {
    unknotting_number: usize,
    /// n² F̄.
    scaled_force: f64,
    /// n² h/e.
    scaled_shortening: f64,
    /// n² h/e from Eq. 2.30.
    jawed_2015: f64,
}

/// Writes traction over shortening, both scaled with n².
fn write(page: &mut Page, cases: &[Case<Tightening>], _: &[Row]) -> Result<()> {
    let mut lines = Vec::new();
    for case in cases {
        let n = case.run.unknotting_number;
        lines.push([vec![n.to_string()], line(case)?].concat());
    }
    page.text(&density_in_words());
    page.text(
        "A knot departs from the law where it inverts. Before that, over tenths of the range:",
    );
    page.lines(&[["n"].as_slice(), &HEADER].concat(), &lines);
    page.text(
        "The trefoil is the farthest from the law because Eq. 2.30 has too much friction and omits \
         everything else. Its braid is a uniform double helix of n turns, whose strands press on \
         each other from end to end; here two thirds to nine tenths of a turn carry almost no \
         pressure (last column), because the strands separate at the ends of the braid. So \
         friction is a third of that of the law at n = 1 and approaches it as n grows. The rest of \
         the traction, by which the loop gains energy (ε⁴/2 for a loose trefoil), is small against \
         friction only where ε ≪ 2 μ σ, or n is large; at n = 1 it is the larger part. Because the \
         two errors have opposite signs, the trefoil is near the law at this friction; with more \
         friction it is farther away (figure 2.7).",
    );
    Ok(())
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let knots = rows.chunk_by(|a, b| a.unknotting_number == b.unknotting_number);
    let knots = knots.map(|rows| {
        let name = format!("n = {}", rows[0].unknotting_number);
        curve(name, rows, |row| (row.scaled_shortening, row.scaled_force))
    });
    let mut curves: Vec<Curve> = knots.collect();
    let forces = rows.iter().map(|row| row.scaled_force);
    let pulled = forces.filter(|force| *force > 0.0);
    let least = pulled.clone().fold(f64::INFINITY, f64::min);
    let largest = largest(pulled);
    if least < largest {
        let forces = (0..=200).map(|k| least * libm::pow(largest / least, f64::from(k) / 200.0));
        let law = curve("Eq. 2.30", forces, |force| {
            (jawed_shortening(force, FRICTION_OF_FIGURE_2_8), force)
        });
        curves.push(law.looking(Look::Dashed).like(6));
    }
    let plot = plot("n² F̄ = n² F h²/EI", curves);
    let style = PlotStyle {
        horizontal: AxisScale::Logarithmic,
        vertical: vec![AxisScale::Logarithmic],
        height: 26.0,
        ..PlotStyle::default()
    };
    vec![PageFigure::new(
        "fig2.8",
        "Traction over shortening of overhand knots; dashed, the law of Eq. 2.30. Where a curve falls, its knot inverts",
        styled_line_plots([plot], "n² h/e", style),
    )]
}

fn measured(case: &Case<Tightening>) -> Result<Vec<Row>> {
    let n = case.run.unknotting_number;
    let squared = (n * n) as f64;
    let rows = pulled_rows(case)?;
    Ok(rows
        .iter()
        .map(|knot| {
            let scaled_force = squared * knot.force_normalized;
            Row {
                unknotting_number: n,
                scaled_force,
                scaled_shortening: squared * case.run.radius / knot.shortening_m,
                jawed_2015: jawed_shortening(scaled_force.max(0.0), FRICTION_OF_FIGURE_2_8),
            }
        })
        .collect())
}
