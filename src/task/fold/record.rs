//! What a fold leaves in a results directory for programs and people.

use super::score::{FoldScore, Look};
use super::stage::FoldStage;
use crate::cell::PlanReport;
use crate::task::error::TaskStage;
use crate::task::record::{TaskHead, TaskRecord, add_pictures};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// What `manifest.json` holds, and `report.md` says.
#[derive(Clone, Debug, Serialize)]
pub struct FoldRecord {
    /// What is known of any task.
    #[serde(flatten)]
    pub head: TaskHead,
    /// Title of the cell.
    pub cell: String,
    /// Name of the arm.
    pub arm: String,
    /// Title of the sheet.
    pub paper: String,
    /// How far its edge goes, m.
    pub target_m: f64,
    /// How its way was planned.
    pub algorithm: String,
    /// Parts of the way, after each of which the camera looks.
    pub parts: usize,
    /// Whether they are planned anew where the sheet has slid.
    pub closed_loop: bool,
    /// Numbers of the motion as it was planned before.
    pub motion: PlanReport,
    /// Where the middle of the edge of the sheet was seen, x and y in the cell, m, and the direction over the sheet, degrees.
    pub sheet_place: Option<[f64; 3]>,
    /// Time that the stages took, s.
    pub times_s: Vec<(FoldStage, f64)>,
    /// What the camera saw on the way.
    pub looks: Vec<Look>,
    /// What the fold came to.
    pub score: Option<FoldScore>,
}

impl TaskRecord for FoldRecord {
    fn head(&mut self) -> &mut TaskHead {
        &mut self.head
    }

    fn report(&self, directory: &Path) -> String {
        let mut text = format!("# {}, folded\n\n| | |\n|---|---|\n", self.paper);
        let mut row = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "| {name} | {value} |");
        };
        let mm = |metres: f64| format!("{:.2} mm", 1e3 * metres);
        row("cell", self.cell.clone());
        row("arm", self.arm.clone());
        row("its edge goes", mm(self.target_m));
        let how = if self.closed_loop {
            "planned anew where the sheet has slid"
        } else {
            "as planned before"
        };
        let plan = format!("{}, in {} parts, {how}", self.algorithm, self.parts);
        row("plan", plan);
        for (name, value) in self.head.rows() {
            row(name, value);
        }
        row(
            "motion as planned",
            format!("{:.1} s", self.motion.duration_s),
        );
        for (stage, time) in &self.times_s {
            row(stage.in_words(), format!("{time:.1} s"));
        }
        if let Some(score) = &self.score {
            row("the free end slid", mm(score.sliding_m));
            row("  farthest", mm(score.largest_sliding_m));
            row(
                "the fold",
                format!(
                    "{} long, {:+.2} mm of what was asked for",
                    mm(score.fold_length_m),
                    1e3 * score.fold_length_error_m
                ),
            );
        }
        if !self.looks.is_empty() {
            text +=
                "\n| part | edge along, up | slid | next part planned anew |\n|---|---|---|---|\n";
        }
        for look in &self.looks {
            let [x, z] = look.edge_m;
            let slid = look.slid_m.map_or_else(|| "not seen".into(), mm);
            let anew = if look.is_planned_anew { "yes" } else { "no" };
            let _ = writeln!(
                text,
                "| {} | {}, {} | {slid} | {anew} |",
                look.part,
                mm(x),
                mm(z)
            );
        }
        let parts = (1..=self.parts).map(|part| {
            let words = format!("After part {part}, with the free end that was found");
            (format!("overlay_{part}.png"), words)
        });
        let first = ("overlay_0.png".into(), "The sheet before".into());
        let last = ("left.png".into(), "After it was let go".into());
        let pictures = std::iter::once(first).chain(parts).chain([last]);
        let pictures: Vec<(String, String)> = pictures.collect();
        let pictures = pictures.iter().map(|(name, words)| (&name[..], &words[..]));
        add_pictures(&mut text, directory, pictures);
        text += "\n[The arm in motion](cell.html)\n";
        text
    }
}
