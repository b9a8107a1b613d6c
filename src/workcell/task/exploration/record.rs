//! What an exploration leaves in its directory for programs and people: a manifest and a page.

use super::figure::{found_and_theory, is_section, section_figure};
use super::row::{ExplorationRow, ExplorationSummary};
use super::walk::SearchSteps;
use crate::task::record::{TaskHead, write_manifest};
use rodlab_files::figure::escape_markdown;
use rodlab_files::figure::{Figure, Paper};
use rodlab_files::results::{ResultsError, write_whole};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// What is explored how: what continues it must ask for the same.
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

/// What `manifest.json` holds.
#[derive(Clone, Debug, Serialize)]
pub struct ExplorationRecord {
    /// What is known of any task; as it was called last.
    #[serde(flatten)]
    pub head: TaskHead,
    /// Whether a rod is clamped between chuck and hand.
    pub is_clamped: bool,
    /// What is explored.
    pub plan: ExplorationPlan,
    /// What was found.
    pub summary: ExplorationSummary,
}

impl ExplorationRecord {
    /// Writes `manifest.json`.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), ResultsError> {
        write_manifest(self, directory)
    }
}

/// Writes `report.md` and its figures.
///
/// # Errors
/// They cannot be written.
pub fn write_page(
    record: &ExplorationRecord,
    rows: &[ExplorationRow],
    directory: &Path,
) -> Result<(), ResultsError> {
    let plan = &record.plan;
    let mut text = String::from("# The stability of a helical rod, explored\n\n| | |\n|---|---|\n");
    let mut row = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {name} | {} |", escape_markdown(&value));
    };
    row("cell", plan.cell.clone());
    row("arm", plan.arm.clone());
    row("rod", plan.rod.0.clone());
    for (name, value) in record.head.rows() {
        row(name, value);
    }
    let summary = &record.summary;
    row(
        "directions",
        format!("{} of {}", summary.directions, plan.directions.len()),
    );
    row("the rod buckled in", summary.buckled.to_string());
    row(
        "theory has it buckle within reach, and it did not, in",
        summary.missed.to_string(),
    );
    let percent =
        |part: Option<f64>| part.map_or("–".to_owned(), |part| format!("{:.2} %", 1e2 * part));
    row(
        "mean relative error against theory",
        percent(summary.mean_relative_error),
    );
    row(
        "standard deviation",
        percent(summary.deviation_of_relative_error),
    );
    row("largest", percent(summary.largest_relative_error));
    if summary.buckled > 0 {
        figure(
            &mut text,
            directory,
            "found.svg",
            "Where stability was lost, over where theory has it",
            &found_and_theory(rows),
        )?;
    }
    if summary.buckled > 0 && is_section(rows) {
        figure(
            &mut text,
            directory,
            "section.svg",
            "The section ω = 0 of the stable helices",
            &section_figure(rows, 0.0),
        )?;
    }
    text += "\nDistances are ‖(κ, τ, ω)‖ in units of the rod's length and bending stiffness. Stability is lost between the last look at \
             which the rod was the helix and the next one. Theory: conjugate points of the smooth rod without weight.\n\n\
             | direction | κ, τ, ω | found | theory | difference | led to |\n|---|---|---|---|---|---|\n";
    for row in rows {
        let number =
            |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.3}"));
        let difference = row.relative_difference;
        let difference =
            difference.map_or("–".to_owned(), |part| format!("{:+.2} %", 1e2 * part));
        let led = match (row.found, row.limit.as_str()) {
            (Some(_), _) => String::new(),
            (None, "") => format!("{:.2}", row.reach),
            (None, limit) => format!("{:.2}: {limit}", row.reach),
        };
        let _ = writeln!(
            text,
            "| {} | {:.3}, {:.3}, {:.3} | {} | {} | {difference} | {led} |",
            row.direction,
            row.kappa,
            row.tau,
            row.omega,
            number(row.found),
            number(row.theory),
        );
    }
    if directory.join("cell.html").is_file() {
        text += "\n[The arm along the first direction](cell.html)\n";
    }
    write_whole(&directory.join("report.md"), text.as_bytes())
}

fn figure(
    text: &mut String,
    directory: &Path,
    name: &str,
    words: &str,
    figure: &Figure,
) -> Result<(), ResultsError> {
    let _ = write!(text, "\n![{words}]({name})\n");
    write_whole(
        &directory.join(name),
        figure.svg(&Paper::default()).as_bytes(),
    )
}
