//! The record of a knot in a results directory, for programs and people.

use super::score::{TieScore, knot_in_words};
use crate::cell::PlanReport;
use crate::task::record::{OVERLAY, Report, TaskHead, TaskRecord};
use rodlab_planning::knot::KnotInvariants;
use rodlab_planning::plan::tying::Pass;
use serde::Serialize;
use std::path::Path;

/// Contents of `manifest.json` and `report.md`.
#[derive(Clone, Debug, Serialize)]
pub struct TieRecord {
    /// Title of the cell.
    pub cell: String,
    /// Names of the arms: the one that lays the first rod, then the other one.
    pub arms: [String; 2],
    /// The patterns, as given.
    pub patterns: Vec<String>,
    /// Whether the second passes of the rods at crossings are over or under.
    pub passes: Vec<Pass>,
    /// The knot of the patterns; `null` if it depends on how the ends are joined.
    pub drawn: Option<KnotInvariants>,
    /// Number of strands that are lifted.
    pub lifts: usize,
    /// Numbers of the path of the first arm.
    pub motion: PlanReport,
    /// Duration of all motions from the first laying on, without grips, s.
    pub duration_s: f64,
    /// Least distance of both arms from each other and from anything else, m; 0.2 means 0.2
    /// or more.
    pub least_clearance_m: f64,
    /// Outcome of the knot.
    pub score: Option<TieScore>,
}

impl TaskRecord for TieRecord {
    fn report(&self, head: &TaskHead, directory: &Path) -> Report {
        let mut report = Report::new(&format!(
            "A knot tied along {}",
            self.patterns.join(" and ")
        ));
        let [first, second] = &self.arms;
        report.row("cell", self.cell.as_str());
        let [what, other] = match self.patterns.len() {
            1 => ["lays and leads", "lifts"],
            _ => ["lays the first rod", "lays the second rod"],
        };
        report.row(what, first.as_str());
        report.row(other, second.as_str());
        let passes = self.passes.iter().map(|pass| match pass {
            Pass::Over => "over",
            Pass::Under => "under",
        });
        report.row("crossings", passes.collect::<Vec<_>>().join(", "));
        report.row("knot as drawn", knot_in_words(self.drawn));
        report.head(head);
        let clearance = self.least_clearance_m.min(self.motion.least_clearance_m);
        report.motion(self.duration_s, clearance);
        report.times(head);
        if let Some(score) = &self.score {
            report.row("knot as seen", knot_in_words(score.seen));
            report.row("  that is", score.in_words());
            let lengths = score.seen_lengths_m.iter();
            let lengths = lengths.map(|length| format!("{:.1} mm", 1e3 * length));
            report.row("length as seen", lengths.collect::<Vec<_>>().join(", "));
            if !score.crossings.is_empty() {
                report.text += "\n| crossing | first place | second place | second is | confidence \
                     |\n|---|---|---|---|---|\n";
            }
            for (number, crossing) in score.crossings.iter().enumerate() {
                let [one, other] = crossing.places.map(|place| match self.patterns.len() {
                    1 => format!("{:.0} mm", 1e3 * place.at_m),
                    _ => format!("rod {} at {:.0} mm", place.rod, 1e3 * place.at_m),
                });
                let how = if crossing.over { "over" } else { "under" };
                let (number, sure) = (number + 1, crossing.confidence);
                report.text += &format!("| {number} | {one} | {other} | {how} | {sure:.2} |\n");
            }
        }
        let plan = ("plan/deployment.svg", "The plan of the laying");
        report.pictures(directory, [OVERLAY, plan]);
        report.page("Both arms in motion");
        report
    }
}
