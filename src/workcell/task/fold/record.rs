//! The record of a fold in a results directory, for programs and people.

use super::score::{FoldScore, Look};
use crate::cell::PlanReport;
use crate::task::record::{Report, TaskHead, TaskRecord};
use serde::Serialize;
use std::path::Path;

/// Contents of `manifest.json` and `report.md`.
#[derive(Clone, Debug, Serialize)]
pub struct FoldRecord {
    /// Title of the cell.
    pub cell: String,
    /// Name of the arm.
    pub arm: String,
    /// Title of the sheet.
    pub paper: String,
    /// Distance by which its edge moves, m.
    pub target_m: f64,
    /// Algorithm of its path.
    pub algorithm: String,
    /// Number of parts of the path; the camera takes a picture after each.
    pub parts: usize,
    /// Whether the parts are replanned if the sheet has slid.
    pub closed_loop: bool,
    /// Numbers of the motion that was planned before anything moved.
    pub motion: PlanReport,
    /// Measured middle of the edge of the sheet, x and y in the cell, m, and direction of the x
    /// axis of the sheet, degrees.
    pub sheet_place: Option<[f64; 3]>,
    /// Measurement by the camera after each part.
    pub looks: Vec<Look>,
    /// Score of the fold.
    pub score: Option<FoldScore>,
}

impl TaskRecord for FoldRecord {
    fn report(&self, head: &TaskHead, directory: &Path) -> Report {
        let mut report = Report::new(&format!("{}, folded", self.paper));
        let mm = |metres: f64| format!("{:.2} mm", 1e3 * metres);
        let or_not_seen = |words: Option<String>| words.unwrap_or_else(|| "not seen".to_owned());
        report.row("cell", self.cell.as_str());
        report.row("arm", self.arm.as_str());
        report.row("its edge moves by", mm(self.target_m));
        let how = if self.closed_loop {
            "replanned where the sheet has slid"
        } else {
            "as planned before"
        };
        let plan = format!("{}, in {} parts, {how}", self.algorithm, self.parts);
        report.row("plan", plan);
        report.head(head);
        report.duration("motion as planned", self.motion.duration_s);
        report.times(head);
        if let Some(score) = &self.score {
            report.row("the free end slid", or_not_seen(score.sliding_m.map(mm)));
            if score.is_end_hidden {
                let part = score.last_seen_part;
                let slid = mm(score.last_seen_sliding_m);
                report.row("  seen last", format!("{slid}, after part {part}"));
            }
            report.row("  farthest seen", mm(score.largest_sliding_m));
            let fold = score.fold_length_m.zip(score.fold_length_error_m);
            let fold = fold.map(|(length, error)| {
                let (length, error) = (mm(length), 1e3 * error);
                format!("{length} long, {error:+.2} mm from the requested length")
            });
            report.row("the fold", or_not_seen(fold));
        }
        if !self.looks.is_empty() {
            report.text +=
                "\n| part | edge along, up | slid | next part replanned |\n|---|---|---|---|\n";
        }
        for look in &self.looks {
            let [along, up] = look.edge_m.map(mm);
            let slid = or_not_seen(look.slid_m.map(mm));
            let replanned = if look.is_replanned { "yes" } else { "no" };
            report.text += &format!("| {} | {along}, {up} | {slid} | {replanned} |\n", look.part);
        }
        let parts = (1..=self.parts).map(|part| {
            let words = format!("After part {part}, with the free end that was found");
            (format!("overlay_{part}.png"), words)
        });
        let first = ("overlay_0.png".into(), "The sheet before".into());
        let last = ("left.png".into(), "After the release".into());
        let pictures = std::iter::once(first).chain(parts).chain([last]);
        report.pictures(directory, pictures);
        report.page("The arm in motion");
        report
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::fold::score::look;

    #[test]
    fn missing_measurements_are_reported_as_not_seen() {
        let looks = vec![look(1, 0.25, Some(0.028)), look(2, 0.324, None)];
        let record = FoldRecord {
            cell: "cell".into(),
            arm: "arm".into(),
            paper: "cardboard".into(),
            target_m: 0.296,
            algorithm: "optimal".into(),
            parts: 2,
            closed_loop: true,
            motion: PlanReport::default(),
            sheet_place: None,
            score: FoldScore::of(&looks, 0.296),
            looks,
        };
        let report = record.report(&TaskHead::planned(Vec::new()), Path::new("nowhere"));
        let report = report.markdown();
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
