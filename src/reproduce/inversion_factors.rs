//! Figures 3.5 to 3.7: dependence of the inversion point on radius, unknotting number and friction.

use super::artifact::Recipe;
use super::inversion::Inversion;
use super::inversion_page::{Row, figure, rows, runs_of, table};
use super::inversion_pictures::{Moment, pictures, side_view};
use super::prelude::*;
use super::table::rows_of;
use std::path::Path;

pub(super) const FIGURE_3_5: Artifact = Artifact {
    name: "fig3.5",
    title: "Figure 3.5: inversion over the radius of the rod",
    recipe: &Factor {
        runs: Inversion::of_figure_3_5,
        name: "fig3.5",
        head: "h",
        value: |run| format!("h = {} mm", (1e6 * run.radius).round() / 1e3),
        statement: "In the thesis, the inversion point in l̄_k does not depend on the radius.",
    },
};

pub(super) const FIGURE_3_6: Artifact = Artifact {
    name: "fig3.6",
    title: "Figure 3.6: inversion over the unknotting number",
    recipe: &Factor {
        runs: Inversion::of_figure_3_6,
        name: "fig3.6",
        head: "n",
        value: |run| format!("n = {}", run.unknotting_number),
        statement: "In the thesis, l̄_k grows with the unknotting number, and a trefoil (n = 1) \
            does not invert.",
    },
};

pub(super) const FIGURE_3_7: Artifact = Artifact {
    name: "fig3.7",
    title: "Figure 3.7: inversion over friction",
    recipe: &Factor {
        runs: Inversion::of_figure_3_7,
        name: "fig3.7",
        head: "μ",
        value: |run| format!("μ = {}", run.friction),
        statement: "In the thesis, larger friction makes the knot invert earlier, at larger l̄_k. \
                    Its rod is 3.4 mm thick; here it has 1.6 mm, so that knots can be pulled from \
                    l̄_k = 312.5: with strong friction, the result depends on a start nearby.",
    },
};

/// The varied parameter of a figure.
struct Factor {
    /// Runs of the factor.
    runs: fn(quick: bool) -> Vec<Inversion>,
    /// Name of the figure.
    name: &'static str,
    /// Name of the parameter, with its unit.
    head: &'static str,
    /// Value of the parameter in a run.
    value: fn(&Inversion) -> String,
    /// Statement of the thesis.
    statement: &'static str,
}

impl Recipe for Factor {
    type Run = Inversion;

    fn runs(&self, quick: bool) -> Vec<Inversion> {
        (self.runs)(quick)
    }

    /// Writes traction and height over tightness, pictures before and after, and the inversion points.
    fn write(&self, page: &mut Page, cases: &[Case<Inversion>]) -> Result<()> {
        let name = |_: usize, run: &Inversion| (self.value)(run);
        let rows = rows(cases, name)?;
        page.csv(&rows)?;
        page.figure(&figure(self.name, &runs_of(&rows)))?;
        page.text(self.statement);
        table(page, self.head, cases, name);
        page.text(&spread(cases));
        let mut shown = Vec::new();
        for case in cases {
            for mut picture in pictures(case, &[Moment::Before, Moment::After])? {
                picture.title = format!("{}, {}", (self.value)(&case.run), picture.title);
                shown.push(picture);
            }
        }
        let figure = PageFigure::new(
            &format!("{}_knots", self.name),
            "Each knot before its inversion (left) and after it (right), on one scale; from the side",
            side_view(shown),
        );
        Ok(page.figure(&figure)?)
    }

    /// Draws the curves; the pictures of the knots stay unchanged.
    fn figures_of_table(&self, table: &Path) -> Option<Result<Vec<PageFigure>>> {
        let rows = rows_of::<Row>(table);
        Some(rows.map(|rows| vec![figure(self.name, &runs_of(&rows))]))
    }
}

/// The range of the inversion points relative to their mean, as text.
fn spread(cases: &[Case<Inversion>]) -> String {
    let points: Vec<f64> = cases
        .iter()
        .filter_map(|case| Inversion::outcome(case).inversion_by_height)
        .collect();
    let Some(mean) = mean(points.iter().copied()) else {
        return "No knot inverted.".to_owned();
    };
    let largest = largest(points.iter().copied());
    let smallest = points.iter().copied().fold(f64::INFINITY, f64::min);
    format!(
        "{} of {} knots inverted, at l̄_k from {smallest:.1} to {largest:.1} by height: a range of {:.1} % of the mean.",
        points.len(),
        cases.len(),
        100.0 * (largest - smallest) / mean
    )
}
