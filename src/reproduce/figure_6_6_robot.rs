//! Figure 6.6 with a robot: the boundary of the stable helices, explored by the arm of a virtual
//! cell.

use super::explored_helices::{DIRECTIONS, Explored, SEARCH};
use super::prelude::*;
use rodlab_workcell::task::{
    ExplorationRow, ExplorationSummary, found_and_theory, read_exploration, section_figure,
};
use std::collections::BTreeMap;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig6.6-robot",
    title: "Figure 6.6: the boundary of the stable helices, explored by the arm of a virtual cell",
    recipe: &Tabled::new(
        |quick| vec![Explored::of_the_thesis(quick)],
        Rows::Series(|case| Ok(read_exploration(&case.directory)?)),
        write,
        figures,
    ),
};

/// Errors of the experiment in the thesis: mean, standard deviation and largest error.
const MEASURED: [f64; 3] = [0.0272, 0.0238, 0.1298];
/// Largest |ω| of a unit direction that is drawn in the section ω = 0.
const NEAR: f64 = 0.15;

/// Writes the results, compared with theory and with the measurements of the thesis.
fn write(page: &mut Page, _: &[Case<Explored>], rows: &[ExplorationRow]) -> Result<()> {
    page.text(&format!(
        "A nitinol wire of 50 cm (E = 67.5 GPa, ν = 0.33, 6,450 kg/m³, diameter 1.5875 mm, that of \
         the thesis) is clamped between the chuck of a stepper and the hand of a gantry, both \
         simulated, behind the drivers of real ones, with the wire's weight and inertia, the arm's \
         latency and lag, and a camera with noise. `rodlab explore` moves the clamps along each \
         direction of (κ, τ, ω), locates 15 markers every {} of ‖(κ, τ, ω)‖, considers the helix \
         lost where their mean distance from their places is {} % of the wire's length, returns to \
         the straight wire, which the hand grasps again, and locates the boundary by steps of {}. \
         Theory is that of the smooth wire without weight (conjugate points).",
        SEARCH.step,
        1e2 * SEARCH.deviation,
        SEARCH.precision
    ));
    page.text(&format!(
        "The thesis explores {DIRECTIONS} directions with τ > 0 and does not list them; these are {DIRECTIONS} evenly \
         spread over κ > 0, τ > 0, of which {} were explored here. Where the wire touches itself, or the arm, the hand \
         or the chuck is in the way, before stability is lost, no boundary can be found, as in the thesis, which lists \
         the directions with a result.",
        rows.len()
    ));
    comparison(page, rows);
    limits(page, rows);
    Ok(())
}

fn comparison(page: &mut Page, rows: &[ExplorationRow]) {
    let summary = ExplorationSummary::of(rows);
    let percent = |part: Option<f64>| number(part.map(|part| 1e2 * part), 2);
    let [mean, deviation, largest] = MEASURED.map(Some);
    let none = String::new();
    let lines = [
        (
            "directions explored",
            summary.directions.to_string(),
            none.clone(),
        ),
        (
            "stability lost in",
            summary.buckled.to_string(),
            DIRECTIONS.to_string(),
        ),
        (
            "lost by theory within reach, not detected",
            summary.missed.to_string(),
            none,
        ),
        (
            "mean error, %",
            percent(summary.mean_relative_error),
            percent(mean),
        ),
        (
            "standard deviation, %",
            percent(summary.deviation_of_relative_error),
            percent(deviation),
        ),
        (
            "largest, %",
            percent(summary.largest_relative_error),
            percent(largest),
        ),
    ];
    page.table(columns! { (what, found, measured) in lines;
        "" => what,
        "here" => found,
        "thesis, measured" => measured,
    });
}

/// Reasons why directions have no result.
fn limits(page: &mut Page, rows: &[ExplorationRow]) {
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.found.is_none()) {
        let reason = match row.limit.as_str() {
            "" => "a helix up to the farthest distance",
            limit => limit,
        };
        *reasons.entry(reason).or_default() += 1;
    }
    if !reasons.is_empty() {
        page.table(columns! { (reason, count) in reasons;
            "why no boundary was found" => reason,
            "directions" => count.to_string(),
        });
    }
}

/// The section near ω = 0, and the accuracy of all measured distances.
fn figures(rows: &[ExplorationRow]) -> Vec<PageFigure> {
    let mut figures = vec![PageFigure::new(
        "fig6.6-robot",
        "Directions near ω = 0, in its plane: line, the boundary of the stable helices by theory; marks, where the arm \
         found the helix lost, for |ω| below 0.15 of the direction",
        section_figure(rows, NEAR),
    )];
    let errors = || {
        let errors = rows.iter();
        errors.filter_map(|row| Some((row.theory?, 1e2 * row.relative_difference?)))
    };
    if errors().next().is_none() {
        return figures;
    }
    let later = curve("found later", errors(), |(theory, error)| (theory, error));
    let earlier = curve("found earlier", errors(), |(theory, error)| {
        (theory, -error)
    });
    let plot = plot(
        "Difference from theory in %",
        [later.looking(Look::Marks), earlier.looking(Look::OpenMarks)],
    );
    let style = PlotStyle {
        vertical: vec![AxisScale::Logarithmic],
        ..PlotStyle::default()
    };
    figures.push(PageFigure::new(
        "fig6.6-robot_found",
        "Distances found over those of theory, all directions",
        found_and_theory(rows),
    ));
    figures.push(PageFigure::new(
        "fig6.6-robot_difference",
        "Difference from theory over the critical distance of theory",
        styled_line_plots([plot], "Distance ‖(κ, τ, ω)‖ of theory", style),
    ));
    figures
}
