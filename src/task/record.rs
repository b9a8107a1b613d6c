//! What a deployment leaves in a results directory for programs and people.

use super::deploy::{Laid, Stage};
use super::error::TaskStage;
use crate::cell::PlanReport;
use crate::experiment::PassedPegs;
use crate::results::{ResultsError, write_whole};
use crate::vision::CurveError;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// How far a task has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// It was planned only.
    Planned,
    /// It goes on.
    Running,
    /// It is done.
    Finished,
    /// Something went wrong.
    Failed,
    /// Somebody asked for the end.
    Interrupted,
}

impl Status {
    /// In words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Planned => "planned, and nothing moved",
            Self::Running => "under way",
            Self::Finished => "finished",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
        }
    }
}

/// What `manifest.json` holds, and `report.md` says.
#[derive(Clone, Debug, Serialize)]
pub struct DeployRecord {
    /// Version of the program.
    pub version: &'static str,
    /// As it was called.
    pub command_line: Vec<String>,
    /// When it began.
    pub start: jiff::Timestamp,
    /// When it ended.
    pub end: Option<jiff::Timestamp>,
    /// How far it came.
    pub status: Status,
    /// Why no further.
    pub error: Option<String>,
    /// Title of the cell, name of the arm.
    pub cell: String,
    /// Name of the arm.
    pub arm: String,
    /// The pattern, as given.
    pub pattern: String,
    /// Numbers of the motion.
    pub motion: PlanReport,
    /// Time that the stages took, s.
    pub times_s: Vec<(Stage, f64)>,
    /// Distances by arc length and to the nearest point.
    pub score: Option<[CurveError; 2]>,
    /// The pegs that the rod passes as its pattern does; `None` where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pegs: Option<PassedPegs>,
}

impl DeployRecord {
    /// Takes over how the rod lies.
    pub fn take(&mut self, laid: &Laid) {
        self.score = Some([laid.score.by_arc_length, laid.score.by_nearest_point]);
        self.pegs = laid.pegs;
    }
}

/// Writes `manifest.json`.
///
/// # Errors
/// It cannot be written.
pub fn write_manifest(record: &DeployRecord, directory: &Path) -> Result<(), ResultsError> {
    let mut text = serde_json::to_vec_pretty(record).expect("names and numbers are JSON values");
    text.push(b'\n');
    write_whole(&directory.join("manifest.json"), &text)
}

/// Writes `report.md`, with the pictures that are there.
///
/// # Errors
/// It cannot be written.
pub fn write_report(record: &DeployRecord, directory: &Path) -> Result<(), ResultsError> {
    let mut text = format!(
        "# A rod laid along {}\n\n| | |\n|---|---|\n| cell | {} |\n| arm | {} |\n",
        record.pattern, record.cell, record.arm
    );
    let mut row = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {name} | {value} |");
    };
    row("status", record.status.in_words().into());
    if let Some(error) = &record.error {
        row("because", error.replace(['|', '\n'], " "));
    }
    row("motion", format!("{:.1} s", record.motion.duration_s));
    row(
        "least distance to anything else",
        format!("{:.0} mm", 1e3 * record.motion.least_clearance_m),
    );
    for (stage, time) in &record.times_s {
        row(stage.in_words(), format!("{time:.1} s"));
    }
    if let Some(errors) = &record.score {
        for (name, error) in ["by arc length", "by nearest point"].iter().zip(errors) {
            row(
                &format!("distance from the pattern {name}"),
                format!(
                    "{:.2} ± {:.2} mm, largest {:.2} mm",
                    1e3 * error.mean_m,
                    1e3 * error.deviation_m,
                    1e3 * error.largest_m
                ),
            );
        }
    }
    if let Some(pegs) = &record.pegs {
        let word = if pegs.are_all() { "" } else { "not " };
        row(
            "pegs passed as the pattern does",
            format!("{} of {}: {word}placed", pegs.passed, pegs.count),
        );
    }
    for (name, words) in [
        ("score.svg", "The rod and its pattern"),
        ("pegs.svg", "The rod between its pegs"),
        (
            "overlay.png",
            "What the camera saw, with the rod that was found",
        ),
        ("plan/deployment.svg", "The plan"),
    ] {
        if directory.join(name).is_file() {
            let _ = write!(text, "\n![{words}]({name})\n");
        }
    }
    text += "\n[The arm in motion](cell.html)\n";
    write_whole(&directory.join("report.md"), text.as_bytes())
}
