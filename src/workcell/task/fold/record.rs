//! What a fold leaves in a results directory for programs and people.

use super::score::{FoldScore, Look};
use super::stage::FoldStage;
use crate::cell::PlanReport;
use crate::task::error::TaskStage;
use crate::task::record::{TaskHead, TaskRecord, add_pictures};
use rodlab_files::figure::escape_markdown;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// What stands in the place of a length that the camera does not see.
const NOT_SEEN: &str = "not seen";

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
        let paper = escape_markdown(&self.paper);
        let mut text = format!("# {paper}, folded\n\n| | |\n|---|---|\n");
        let mut row = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "| {name} | {} |", escape_markdown(&value));
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
            let not_seen = || NOT_SEEN.to_owned();
            row(
                "the free end slid",
                score.sliding_m.map_or_else(not_seen, mm),
            );
            if score.is_end_hidden {
                let part = score.last_seen_part;
                let slid = mm(score.last_seen_sliding_m);
                row("  seen last", format!("{slid}, after part {part}"));
            }
            row("  farthest seen", mm(score.largest_sliding_m));
            let fold = score.fold_length_m.zip(score.fold_length_error_m);
            let fold = fold.map(|(length, error)| {
                format!(
                    "{} long, {:+.2} mm of what was asked for",
                    mm(length),
                    1e3 * error
                )
            });
            row("the fold", fold.unwrap_or_else(not_seen));
        }
        if !self.looks.is_empty() {
            text +=
                "\n| part | edge along, up | slid | next part planned anew |\n|---|---|---|---|\n";
        }
        for look in &self.looks {
            let [x, z] = look.edge_m;
            let slid = look.slid_m.map_or_else(|| NOT_SEEN.into(), mm);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::PlanReport;

    #[test]
    fn what_was_not_seen_is_reported_as_not_seen() {
        let look = |part: usize, x: f64, slid_m: Option<f64>| Look {
            part,
            edge_m: [x, 0.0],
            slid_m,
            is_planned_anew: false,
        };
        let looks = vec![look(1, 0.25, Some(0.028)), look(2, 0.324, None)];
        let record = FoldRecord {
            head: TaskHead::planned(Vec::new()),
            cell: "cell".into(),
            arm: "arm".into(),
            paper: "cardboard".into(),
            target_m: 0.296,
            algorithm: "optimal".into(),
            parts: 2,
            closed_loop: true,
            motion: PlanReport::default(),
            sheet_place: None,
            times_s: Vec::new(),
            score: FoldScore::of(&looks, 0.296),
            looks,
        };
        let report = record.report(Path::new("nowhere"));
        for line in [
            "| the free end slid | not seen |",
            "|   seen last | 28.00 mm, after part 1 |",
            "| the fold | not seen |",
        ] {
            assert!(report.contains(line), "{report}");
        }
        assert!(!report.contains("0.00 mm of what"), "{report}");
        let json = serde_json::to_value(&record).unwrap();
        assert!(json["score"]["fold_length_error_m"].is_null(), "{json}");
    }
}
