//! What a deployment leaves in a results directory for programs and people.

use super::deploy::{Laid, Stage};
use super::error::TaskStage;
use super::record::{TaskHead, TaskRecord, add_pictures};
use crate::cell::PlanReport;
use rodlab_files::figure::escape_markdown;
use rodlab_lab::experiment::PassedPegs;
use rodlab_vision::{CurveError, SeenLength};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// Distances of a rod from its pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeployScore {
    /// Of points at equal parts of both lengths.
    pub by_arc_length: CurveError,
    /// To the nearest point of the rod.
    pub by_nearest_point: CurveError,
}

/// What `manifest.json` holds, and `report.md` says.
#[derive(Clone, Debug, Serialize)]
pub struct DeployRecord {
    /// What is known of any task.
    #[serde(flatten)]
    pub head: TaskHead,
    /// Title of the cell.
    pub cell: String,
    /// Name of the arm.
    pub arm: String,
    /// The pattern, as given.
    pub pattern: String,
    /// Numbers of the motion.
    pub motion: PlanReport,
    /// Time that the stages took, s.
    pub times_s: Vec<(Stage, f64)>,
    /// Length of the rod in the picture, and its own.
    pub seen_length: Option<SeenLength>,
    /// Distances from the pattern.
    pub score: Option<DeployScore>,
    /// The pegs that the rod passes as its pattern does; `None` where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pegs: Option<PassedPegs>,
}

impl DeployRecord {
    /// Takes over how the rod lies.
    pub fn take(&mut self, laid: &Laid) {
        self.score = Some(DeployScore {
            by_arc_length: laid.score.by_arc_length,
            by_nearest_point: laid.score.by_nearest_point,
        });
        self.pegs = laid.pegs;
    }
}

impl TaskRecord for DeployRecord {
    fn head(&mut self) -> &mut TaskHead {
        &mut self.head
    }

    fn report(&self, directory: &Path) -> String {
        let mut text = format!(
            "# A rod laid along {}\n\n| | |\n|---|---|\n| cell | {} |\n| arm | {} |\n",
            escape_markdown(&self.pattern),
            escape_markdown(&self.cell),
            escape_markdown(&self.arm)
        );
        let mut row = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "| {name} | {} |", escape_markdown(&value));
        };
        for (name, value) in self.head.rows() {
            row(name, value);
        }
        row("motion", format!("{:.1} s", self.motion.duration_s));
        row(
            "least distance to anything else",
            format!("{:.0} mm", 1e3 * self.motion.least_clearance_m),
        );
        for (stage, time) in &self.times_s {
            row(stage.in_words(), format!("{time:.1} s"));
        }
        if let Some(length) = &self.seen_length {
            row(
                "length as seen",
                format!(
                    "{:.1} mm of {:.1} mm",
                    1e3 * length.seen_m,
                    1e3 * length.rod_m
                ),
            );
        }
        if let Some(score) = &self.score {
            for (name, error) in [
                ("by arc length", &score.by_arc_length),
                ("by nearest point", &score.by_nearest_point),
            ] {
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
        if let Some(pegs) = &self.pegs {
            let word = if pegs.are_all() { "" } else { "not " };
            row(
                "pegs passed as the pattern does",
                format!("{} of {}: {word}placed", pegs.passed, pegs.count),
            );
        }
        let pictures = [
            ("score.svg", "The rod and its pattern"),
            ("pegs.svg", "The rod between its pegs"),
            (
                "overlay.png",
                "What the camera saw, with the rod that was found",
            ),
            ("plan/deployment.svg", "The plan"),
        ];
        add_pictures(&mut text, directory, pictures);
        text += "\n[The arm in motion](cell.html)\n";
        text
    }
}
