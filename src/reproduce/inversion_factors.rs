//! Figures 3.5 to 3.7: what the inversion point depends on: radius, unknotting number, friction.

use super::ReproduceError;
use super::cases::Case;
use super::inversion::Inversion;
use super::inversion_page::{Row, figure, rows, runs_of, table};
use super::inversion_pictures::{Moment, pictures, side_view};
use super::page::{Page, PageFigure};
use super::table::rows_of;
use std::path::Path;

/// What is varied in a figure.
pub(super) struct Factor {
    /// Its name and unit.
    head: &'static str,
    /// Its value in a run.
    value: fn(&Inversion) -> String,
    /// What the thesis says.
    statement: &'static str,
}

pub(super) static RADIUS: Factor = Factor {
    head: "h",
    value: |run| format!("h = {} mm", (1e6 * run.radius).round() / 1e3),
    statement: "The thesis: the inversion point in l̄_k does not depend on the radius.",
};
pub(super) static NUMBER: Factor = Factor {
    head: "n",
    value: |run| format!("n = {}", run.unknotting_number),
    statement: "The thesis: l̄_k grows with the unknotting number, and a trefoil (n = 1) does not invert.",
};
pub(super) static FRICTION: Factor = Factor {
    head: "μ",
    value: |run| format!("μ = {}", run.friction),
    statement: "The thesis: the larger the friction, the earlier, at larger l̄_k, the knot inverts. Its rod is 3.4 mm thick; \
            here it has 1.6 mm, so that knots can be pulled from l̄_k = 312.5: strong friction remembers a start nearby.",
};

/// Writes traction and height over tightness, pictures before and after, and the inversion points.
pub(super) fn write(
    page: &mut Page,
    factor: &Factor,
    cases: &[Case<Inversion>],
) -> Result<(), ReproduceError> {
    let names: Vec<String> = cases.iter().map(|case| (factor.value)(&case.run)).collect();
    let mut all = Vec::new();
    let mut shown = Vec::new();
    for (name, case) in names.iter().zip(cases) {
        all.push((name.clone(), rows(case, name)?));
        for mut picture in pictures(case, &[Moment::Before, Moment::After])? {
            picture.title = format!("{name}, {}", picture.title);
            shown.push(picture);
        }
    }
    let flat: Vec<_> = all.iter().flat_map(|(_, rows)| rows.clone()).collect();
    page.csv(&flat)?;
    page.figure(&figure(page.name(), &all))?;
    page.text(factor.statement);
    table(page, factor.head, &names, cases);
    page.text(&spread(cases));
    let name = format!("{}_knots", page.name());
    let caption =
        "Each knot before its inversion (left) and after it (right), on one scale; from the side";
    Ok(page.figure(&PageFigure::new(&name, caption, side_view(shown)))?)
}

/// The curves from the table alone; pictures of the knots stay as they are.
pub(super) fn figures_of_table(
    name: &str,
    table: &Path,
) -> Result<Vec<PageFigure>, ReproduceError> {
    Ok(vec![figure(name, &runs_of(&rows_of::<Row>(table)?))])
}

/// The range of the inversion points over their mean, in words.
fn spread(cases: &[Case<Inversion>]) -> String {
    let points: Vec<f64> = cases
        .iter()
        .filter_map(|case| Inversion::outcome(case).inversion_by_height)
        .collect();
    if points.is_empty() {
        return "No knot inverted.".to_owned();
    }
    let mean = points.iter().sum::<f64>() / points.len() as f64;
    let largest = points.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = points.iter().copied().fold(f64::INFINITY, f64::min);
    format!(
        "{} of {} knots inverted, at l̄_k from {smallest:.1} to {largest:.1} by height: a range of {:.1} % of the mean.",
        points.len(),
        cases.len(),
        100.0 * (largest - smallest) / mean
    )
}
