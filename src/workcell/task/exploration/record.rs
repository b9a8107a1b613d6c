//! The record of an exploration in its directory, for programs and people: a manifest and a page.

use super::figure::{found_and_theory, is_section, section_figure};
use super::row::{ExplorationRow, ExplorationSummary};
use super::walk::SearchSteps;
use crate::task::record::{Report, TaskHead, TaskRecord};
use rodlab_files::figure::{Figure, Paper};
use rodlab_files::results::{ResultsError, write_whole};
use serde::Serialize;
use std::path::Path;

/// Plan of an exploration; a task resumes an exploration only if both plans are equal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExplorationPlan {
    /// Title of the cell.
    pub cell: String,
    /// Name of the arm.
    pub arm: String,
    /// Name of the rod, its length, m, and its radius, m.
    pub rod: (String, f64, f64),
    /// Unit vectors (κ, τ, ω).
    pub directions: Vec<[f64; 3]>,
    /// Distance at which a search ends.
    pub farthest: f64,
    /// Least distance of arm and rod to anything else, m.
    pub margin_m: f64,
    /// Steps of the search.
    pub search: SearchSteps,
}

/// Contents of `manifest.json`.
#[derive(Clone, Debug, Serialize)]
pub struct ExplorationRecord {
    /// Whether a rod is clamped between chuck and hand.
    pub is_clamped: bool,
    /// Plan of the exploration.
    pub plan: ExplorationPlan,
    /// Comparison of the results with theory.
    pub summary: ExplorationSummary,
    /// The rows of the directions that were explored.
    #[serde(skip)]
    pub rows: Vec<ExplorationRow>,
}

/// Measured over theoretical distance of instability, and the section ω = 0 if all directions lie in it.
const FIGURES: [(&str, &str); 2] = [
    (
        "found.svg",
        "Measured distance of instability over that of theory",
    ),
    ("section.svg", "The section ω = 0 of the stable helices"),
];

impl ExplorationRecord {
    /// Replaces the rows and the summary.
    pub fn take(&mut self, rows: Vec<ExplorationRow>) {
        self.summary = ExplorationSummary::of(&rows);
        self.rows = rows;
    }

    /// Writes the figures.
    ///
    /// # Errors
    /// A figure cannot be written.
    pub fn write_figures(&self, directory: &Path) -> Result<(), ResultsError> {
        if self.summary.buckled == 0 {
            return Ok(());
        }
        let write = |(name, _): (&str, &str), figure: Figure| {
            let picture = figure.svg(&Paper::default());
            write_whole(&directory.join(name), picture.as_bytes())
        };
        write(FIGURES[0], found_and_theory(&self.rows))?;
        match is_section(&self.rows) {
            true => write(FIGURES[1], section_figure(&self.rows, 0.0)),
            false => Ok(()),
        }
    }
}

impl TaskRecord for ExplorationRecord {
    fn answer(&self) -> Option<serde_json::Value> {
        serde_json::to_value(self.summary).ok()
    }

    fn report(&self, head: &TaskHead, directory: &Path) -> Report {
        let plan = &self.plan;
        let mut report = Report::new("The stability of a helical rod, explored");
        report.row("cell", plan.cell.as_str());
        report.row("arm", plan.arm.as_str());
        report.row("rod", plan.rod.0.as_str());
        report.head(head);
        let summary = &self.summary;
        let explored = format!("{} of {}", summary.directions, plan.directions.len());
        let percent =
            |part: Option<f64>| part.map_or("–".into(), |part| format!("{:.2} %", 1e2 * part));
        for (name, value) in [
            ("directions", explored),
            ("the rod buckled in", summary.buckled.to_string()),
            (
                "no buckling, although theory predicts it within reach, in",
                summary.missed.to_string(),
            ),
            (
                "mean relative error against theory",
                percent(summary.mean_relative_error),
            ),
            (
                "standard deviation",
                percent(summary.deviation_of_relative_error),
            ),
            ("largest", percent(summary.largest_relative_error)),
        ] {
            report.row(name, value);
        }
        report.pictures(directory, FIGURES);
        report.text += "\nDistances are ‖(κ, τ, ω)‖ in units of the rod's length and bending stiffness. Stability is lost between the last picture in \
                 which the rod was the helix and the next one. Theory: conjugate points of the smooth rod without weight.\n\n\
                 | direction | κ, τ, ω | found | theory | difference | led to |\n|---|---|---|---|---|---|\n";
        for row in &self.rows {
            let number =
                |value: Option<f64>| value.map_or("–".into(), |value| format!("{value:.3}"));
            let difference = row
                .relative_difference
                .map(|part| format!("{:+.2} %", 1e2 * part));
            let difference = difference.unwrap_or_else(|| "–".into());
            let led = match (row.found, row.limit.as_str()) {
                (Some(_), _) => String::new(),
                (None, "") => format!("{:.2}", row.reach),
                (None, limit) => format!("{:.2}: {limit}", row.reach),
            };
            let [found, theory]: [String; 2] = [row.found, row.theory].map(number);
            let ExplorationRow {
                direction,
                kappa,
                tau,
                omega,
                ..
            } = row;
            report.text += &format!(
                "| {direction} | {kappa:.3}, {tau:.3}, {omega:.3} | {found} | {theory} | {difference} | {led} |\n"
            );
        }
        if directory.join("cell.html").is_file() {
            report.page("The arm along the first direction");
        }
        report
    }
}
