//! What a knot leaves in a results directory for programs and people.

use super::score::{TieScore, knot_in_words};
use super::stage::TieStage;
use crate::cell::PlanReport;
use crate::task::error::TaskStage;
use crate::task::record::{TaskHead, TaskRecord, add_pictures};
use rodlab_files::figure::escape_markdown;
use rodlab_planning::knot::KnotInvariants;
use rodlab_planning::plan::tying::Pass;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// What `manifest.json` holds, and `report.md` says.
#[derive(Clone, Debug, Serialize)]
pub struct TieRecord {
    /// What is known of any task.
    #[serde(flatten)]
    pub head: TaskHead,
    /// Title of the cell.
    pub cell: String,
    /// Names of the arm that lays the first rod, and of the other one.
    pub arms: [String; 2],
    /// The patterns, as given.
    pub patterns: Vec<String>,
    /// How rods pass their crossings when they come to them again.
    pub passes: Vec<Pass>,
    /// The knot that was drawn; `null` where it depends on how ends are joined.
    pub drawn: Option<KnotInvariants>,
    /// Strands that are lifted.
    pub lifts: usize,
    /// Numbers of the path of the first arm.
    pub motion: PlanReport,
    /// Duration of all motions from the first laying on, grips left out, s.
    pub duration_s: f64,
    /// Least distance of both arms to each other and to anything else, m; 0.2 stands for that and more.
    pub least_clearance_m: f64,
    /// Time that the stages took, s.
    pub times_s: Vec<(TieStage, f64)>,
    /// What it came to.
    pub score: Option<TieScore>,
}

impl TaskRecord for TieRecord {
    fn head(&mut self) -> &mut TaskHead {
        &mut self.head
    }

    fn report(&self, directory: &Path) -> String {
        let patterns = escape_markdown(&self.patterns.join(" and "));
        let mut text = format!("# A knot tied along {patterns}\n\n| | |\n|---|---|\n");
        let mut row = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "| {name} | {} |", escape_markdown(&value));
        };
        let [first, second] = &self.arms;
        row("cell", self.cell.clone());
        if self.patterns.len() == 1 {
            row("lays and leads", first.clone());
            row("lifts", second.clone());
        } else {
            row("lays the first rod", first.clone());
            row("lays the second rod", second.clone());
        }
        let passes = self.passes.iter().map(|pass| match pass {
            Pass::Over => "over",
            Pass::Under => "under",
        });
        row("crossings", passes.collect::<Vec<_>>().join(", "));
        row("knot as drawn", knot_in_words(self.drawn));
        for (name, value) in self.head.rows() {
            row(name, value);
        }
        row("motion", format!("{:.1} s", self.duration_s));
        row(
            "least distance to anything else",
            format!(
                "{:.0} mm",
                1e3 * self.least_clearance_m.min(self.motion.least_clearance_m)
            ),
        );
        for (stage, time) in &self.times_s {
            row(stage.in_words(), format!("{time:.1} s"));
        }
        if let Some(score) = &self.score {
            row("knot as seen", knot_in_words(score.seen));
            row("  that is", score.in_words());
            let lengths = score.seen_lengths_m.iter();
            let lengths = lengths.map(|length| format!("{:.1} mm", 1e3 * length));
            row("length as seen", lengths.collect::<Vec<_>>().join(", "));
            if !score.crossings.is_empty() {
                text += "\n| crossing | of | and | which lies | sure |\n|---|---|---|---|---|\n";
            }
            for (number, crossing) in score.crossings.iter().enumerate() {
                let places = crossing.places.map(|place| match self.patterns.len() {
                    1 => format!("{:.0} mm", 1e3 * place.at_m),
                    _ => format!("rod {} at {:.0} mm", place.rod, 1e3 * place.at_m),
                });
                let how = if crossing.over { "over" } else { "under" };
                let _ = writeln!(
                    text,
                    "| {} | {} | {} | {how} | {:.2} |",
                    number + 1,
                    places[0],
                    places[1],
                    crossing.confidence
                );
            }
        }
        let pictures = [
            (
                "overlay.png",
                "What the camera saw, with the rod that was found",
            ),
            ("plan/deployment.svg", "The plan of the laying"),
        ];
        add_pictures(&mut text, directory, pictures);
        text += "\n[Both arms in motion](cell.html)\n";
        text
    }
}
