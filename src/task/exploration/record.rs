//! What an exploration leaves in its directory: a row for each direction, a manifest, a page.

use super::figure::{found_and_theory, is_section, section_figure};
use super::walk::SearchSteps;
use crate::figure::Paper;
use crate::results::{MANIFEST, ResultsError, read_whole_rows, write_whole};
use crate::task::record::Status;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::path::Path;

/// Name of the table.
pub const TABLE: &str = "exploration.csv";

/// What became of the rod along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Found {
    /// It left the helix.
    Buckles,
    /// It was the helix as far as the arm could lead it.
    StaysHelix,
    /// Something failed; `limit` says what.
    Failed,
}

/// A row of `exploration.csv`. Distances are norms ‖(κ, τ, ω)‖ in units of the rod's length and bending stiffness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExplorationRow {
    /// Number of the direction, from 1.
    pub direction: usize,
    /// Unit direction: curvature.
    pub kappa: f64,
    /// Unit direction: torsion.
    pub tau: f64,
    /// Unit direction: twisting moment.
    pub omega: f64,
    /// What became of the rod.
    pub outcome: Found,
    /// Largest distance at which it was seen to be the helix before it was none.
    pub stable: f64,
    /// Distance at which it was the helix no longer; empty where it always was.
    pub lost: Option<f64>,
    /// The middle between both: where stability is lost.
    pub found: Option<f64>,
    /// The same by the conjugate points of the smooth rod without weight; empty where there are none up to 100.
    pub theory: Option<f64>,
    /// found/theory − 1.
    pub relative_difference: Option<f64>,
    /// Distance to which the arm can lead it.
    pub reach: f64,
    /// Why no farther; empty where it is the largest distance asked for.
    pub limit: String,
    /// Number of looks.
    pub looks: usize,
    /// Time that it took, s.
    pub wall_time_s: f64,
}

impl ExplorationRow {
    /// A row of a direction that could not be explored.
    pub fn failed([kappa, tau, omega]: [f64; 3], words: String) -> Self {
        Self {
            direction: 0,
            kappa,
            tau,
            omega,
            outcome: Found::Failed,
            stable: 0.0,
            lost: None,
            found: None,
            theory: None,
            relative_difference: None,
            reach: 0.0,
            limit: words,
            looks: 0,
            wall_time_s: 0.0,
        }
    }
}

/// The rows in a directory of an exploration.
///
/// # Errors
/// The table cannot be read.
pub fn read_rows(directory: &Path) -> Result<Vec<ExplorationRow>, ResultsError> {
    Ok(read_whole_rows(&directory.join(TABLE))?.rows)
}

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
    /// Version of the program.
    pub version: &'static str,
    /// As it was called last.
    pub command_line: Vec<String>,
    /// When that began.
    pub start: jiff::Timestamp,
    /// When it ended.
    pub end: Option<jiff::Timestamp>,
    /// How far it came.
    pub status: Status,
    /// Why no further.
    pub error: Option<String>,
    /// Whether a rod is clamped between chuck and hand.
    pub is_clamped: bool,
    /// What is explored.
    pub plan: ExplorationPlan,
    /// What was found.
    pub summary: ExplorationSummary,
}

/// What was found, against theory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ExplorationSummary {
    /// Directions explored.
    pub directions: usize,
    /// Those in which the rod buckled.
    pub buckled: usize,
    /// Those in which theory has it lose stability within reach, and it was not seen to.
    pub missed: usize,
    /// Mean of |found/theory − 1| over those that buckled; empty without any.
    pub mean_relative_error: Option<f64>,
    /// Their standard deviation.
    pub deviation_of_relative_error: Option<f64>,
    /// The largest.
    pub largest_relative_error: Option<f64>,
}

impl ExplorationSummary {
    /// That of rows.
    pub fn of(rows: &[ExplorationRow]) -> Self {
        let errors = rows.iter().filter_map(|row| row.relative_difference);
        let errors: Vec<f64> = errors.map(f64::abs).collect();
        let count = errors.len() as f64;
        let mean = (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / count);
        let deviation = mean.map(|mean| {
            let squares = errors.iter().map(|error| (error - mean).powi(2));
            (squares.sum::<f64>() / count).sqrt()
        });
        let is_missed = |row: &&ExplorationRow| {
            row.found.is_none() && row.theory.is_some_and(|theory| theory < row.reach)
        };
        Self {
            directions: rows.len(),
            buckled: rows.iter().filter(|row| row.found.is_some()).count(),
            missed: rows.iter().filter(is_missed).count(),
            mean_relative_error: mean,
            deviation_of_relative_error: deviation,
            largest_relative_error: mean.map(|_| errors.iter().copied().fold(0.0, f64::max)),
        }
    }
}

impl ExplorationRecord {
    /// Writes `manifest.json`.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), ResultsError> {
        let mut text = serde_json::to_vec_pretty(self).expect("names and numbers are JSON values");
        text.push(b'\n');
        write_whole(&directory.join(MANIFEST), &text)
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
        let _ = writeln!(text, "| {name} | {} |", value.replace(['|', '\n'], " "));
    };
    row("cell", plan.cell.clone());
    row("arm", plan.arm.clone());
    row("rod", plan.rod.0.clone());
    row("status", record.status.in_words().into());
    if let Some(error) = &record.error {
        row("because", error.clone());
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
    figure: &crate::figure::Figure,
) -> Result<(), ResultsError> {
    let _ = write!(text, "\n![{words}]({name})\n");
    write_whole(
        &directory.join(name),
        figure.svg(&Paper::default()).as_bytes(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(found: Option<f64>, theory: Option<f64>, reach: f64) -> ExplorationRow {
        ExplorationRow {
            direction: 1,
            kappa: 1.0,
            tau: 0.0,
            omega: 0.0,
            outcome: found.map_or(Found::StaysHelix, |_| Found::Buckles),
            stable: reach,
            lost: found,
            found,
            theory,
            relative_difference: found
                .zip(theory)
                .map(|(found, theory)| found / theory - 1.0),
            reach,
            limit: String::new(),
            looks: 3,
            wall_time_s: 1.0,
        }
    }

    #[test]
    fn a_summary_counts_what_was_found_and_what_was_missed() {
        let rows = [
            row(Some(10.1), Some(10.0), 12.0),
            row(Some(7.76), Some(8.0), 12.0),
            row(None, Some(9.0), 12.0),
            row(None, Some(13.0), 12.0),
            row(None, None, 12.0),
        ];
        let summary = ExplorationSummary::of(&rows);
        assert_eq!(
            (summary.directions, summary.buckled, summary.missed),
            (5, 2, 1)
        );
        assert!((summary.mean_relative_error.unwrap() - 0.02).abs() < 1e-12);
        assert!((summary.deviation_of_relative_error.unwrap() - 0.01).abs() < 1e-12);
        assert!((summary.largest_relative_error.unwrap() - 0.03).abs() < 1e-12);
        assert_eq!(ExplorationSummary::of(&rows[2..]).mean_relative_error, None);
    }
}
