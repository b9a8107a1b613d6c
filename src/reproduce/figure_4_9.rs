//! Figure 4.9: the gravito-bending length of a sheet from the drop of a hanging strip.

use super::hanging_strips::{Hanging, LENGTHS, UNIT};
use super::prelude::*;
use rodlab_engine::mechanics::kirchhoff::HangingStrip;
use rodlab_files::results::read_nodes;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig4.9",
    title: "Figure 4.9: the gravito-bending length from a strip that hangs down",
    recipe: &Tabled::new(Hanging::of_figure_4_9, Rows::Series(rows), write, figures),
};

/// Number of points of the drawn relation.
const POINTS: usize = 120;
/// Largest length of the drawn relation, L_gb.
const LONGEST: f64 = 6.5;

/// A row of the CSV file.
#[derive(Serialize, Deserialize)]
struct Row {
    length_over_unit: f64,
    drop_over_length: Option<f64>,
    theory: f64,
    measured_length_over_unit: Option<f64>,
}

/// Writes table and figure.
fn write(page: &mut Page, _: &[Case<Hanging>], rows: &[Row]) -> Result<()> {
    page.text(
        "A strip is held horizontally, and a length l of it hangs down by l_h. The drop ε = l_h/l gives the length in \
         gravito-bending lengths, l̄ = 𝓛(ε) (thesis Eq. 4.16), and with it L_gb = l/l̄. Drops of simulated strips of \
         100 edges, static equilibria of the discrete rod, beside those of the heavy cantilever; the last column is \
         the length inferred from the simulated drop. `rodlab solve hanging-plate` gives either number, `rodlab \
         measure` L_gb from a photograph.",
    );
    page.table(columns! { row in rows;
        "l/L_gb" => number(row.length_over_unit, 1),
        "ε, simulated" => number(row.drop_over_length, 5),
        "ε, in theory" => number(row.theory, 5),
        "l/L_gb of the simulated drop" => number(row.measured_length_over_unit, 4),
    });
    Ok(())
}

fn rows(case: &Case<Hanging>) -> Result<Vec<Row>> {
    let length = LENGTHS[case.run.strip];
    let outputs = read_nodes(&case.directory, case.run.nodes())?;
    let last = outputs.last().and_then(|output| output.positions.last());
    let drop = last.map(|node| -node.z / (length * UNIT));
    let theory = HangingStrip::of_length(length);
    let found = drop.and_then(|drop| HangingStrip::of_drop(drop).ok());
    Ok(vec![Row {
        length_over_unit: length,
        drop_over_length: drop,
        theory: theory.map_or(f64::NAN, |strip| strip.drop),
        measured_length_over_unit: found.map(|strip| strip.length),
    }])
}

fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let lengths = (1..=POINTS).map(|index| LONGEST * index as f64 / POINTS as f64);
    let theory = lengths.filter_map(|length| {
        let strip = HangingStrip::of_length(length).ok()?;
        Some((strip.drop, Some(length)))
    });
    let simulated = rows
        .iter()
        .filter_map(|row| Some((row.drop_over_length?, Some(row.length_over_unit))));
    let curves = [
        Curve::new("theory", theory.collect()),
        Curve::new("simulated", simulated.collect()).looking(Look::Marks),
    ];
    let plot = plot("l/L_{gb}", curves);
    vec![PageFigure::new(
        "fig4.9_drop",
        "Free length of a hanging strip over its drop",
        line_plots([plot], "l_{h}/l"),
    )]
}
