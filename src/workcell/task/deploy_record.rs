//! The record of a deployment in a results directory, for programs and people.

use super::record::{OVERLAY, Report, TaskHead, TaskRecord};
use crate::cell::PlanReport;
use rodlab_lab::experiment::PassedPegs;
use rodlab_planning::plan::deployment::DeployedRod;
use rodlab_vision::{CurveError, SeenLength};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The pattern in its own frame, with which the rod is compared: `x_m`, `y_m`.
pub const PATTERN: &str = "pattern.csv";

/// Folder of a stroke in the results, if there are several; strokes count from zero.
pub fn stroke_folder(stroke: usize) -> String {
    format!("stroke-{}", stroke + 1)
}

/// Distances of a rod from its pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeployScore {
    /// Distances between points at equal fractions of both lengths.
    pub by_arc_length: CurveError,
    /// Distances to the nearest point of the rod.
    pub by_nearest_point: CurveError,
}

/// Contents of `manifest.json` and `report.md`.
#[derive(Clone, Debug, Serialize)]
pub struct DeployRecord {
    /// Title of the cell.
    pub cell: String,
    /// Name of the arm.
    pub arm: String,
    /// The pattern, as given.
    pub pattern: String,
    /// The rod for which the path is planned.
    #[serde(skip)]
    pub rod: DeployedRod,
    /// Length to which the rod is cut, m, if it is one of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut_length_m: Option<f64>,
    /// Largest coefficient of friction that the path needs.
    pub largest_friction_demand: f64,
    /// Numbers of the motion.
    pub motion: PlanReport,
    /// Length of the rod in the picture, and its real length.
    pub seen_length: Option<SeenLength>,
    /// Distances from the pattern.
    pub score: Option<DeployScore>,
    /// The pegs that the rod passes on the same side as its pattern; `None` if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pegs: Option<PassedPegs>,
}

impl DeployRecord {
    /// Adds the rows of one of several strokes to a report.
    pub(super) fn rows_of_stroke(&self, number: usize, report: &mut Report) {
        report.row(
            &format!("stroke {number}"),
            format!(
                "a rod of {:.1} cm; friction needed: {:.2}; motion: {:.1} s",
                1e2 * self.rod.length,
                self.largest_friction_demand,
                self.motion.duration_s
            ),
        );
        let Some(score) = &self.score else { return };
        let near = &score.by_nearest_point;
        let [mean, deviation] = [near.mean_m, near.deviation_m].map(|metres| 1e3 * metres);
        report.row(
            &format!("distance of stroke {number} by nearest point"),
            format!("{mean:.2} ± {deviation:.2} mm"),
        );
    }
}

impl TaskRecord for DeployRecord {
    fn report(&self, head: &TaskHead, directory: &Path) -> Report {
        let mut report = Report::new(&format!("A rod laid along {}", self.pattern));
        report.row("cell", self.cell.as_str());
        report.row("arm", self.arm.as_str());
        report.head(head);
        let [unit, length] =
            [self.rod.gravito_bending_length, self.rod.length].map(|metres| 1e2 * metres);
        report.row(
            "rod, as planned",
            format!("{length:.1} cm long, gravito-bending length {unit:.2} cm"),
        );
        report.row(
            "friction needed",
            format!(
                "{:.2}; with less, the rod slides",
                self.largest_friction_demand
            ),
        );
        report.motion(self.motion.duration_s, self.motion.least_clearance_m);
        report.row(
            "joint velocities",
            format!(
                "{:.0} % of their limits at most",
                1e2 * self.motion.velocity_used
            ),
        );
        report.times(head);
        if let Some(length) = &self.seen_length {
            let [seen, whole] = [length.seen_m, length.rod_m].map(|metres| 1e3 * metres);
            report.row("length as seen", format!("{seen:.1} mm of {whole:.1} mm"));
        }
        if let Some(score) = &self.score {
            for (name, error) in [
                ("by arc length", &score.by_arc_length),
                ("by nearest point", &score.by_nearest_point),
            ] {
                let [mean, deviation, largest] =
                    [error.mean_m, error.deviation_m, error.largest_m].map(|metres| 1e3 * metres);
                report.row(
                    &format!("distance from the pattern {name}"),
                    format!("{mean:.2} ± {deviation:.2} mm, largest {largest:.2} mm"),
                );
            }
        }
        if let Some(pegs) = &self.pegs {
            let word = if pegs.are_all() { "" } else { "not " };
            let count = format!("{} of {}: {word}placed", pegs.passed, pegs.count);
            report.row("pegs passed on the side of the pattern", count);
        }
        let pictures = [
            ("score.svg", "The rod and its pattern"),
            ("pegs.svg", "The rod between its pegs"),
            OVERLAY,
            ("plan/deployment.svg", "The plan"),
        ];
        report.pictures(directory, pictures);
        report.page("The arm in motion");
        report
    }
}
