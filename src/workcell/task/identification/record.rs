//! The record of an identification in a results directory, for programs and people.

use super::pose::HeldPose;
use crate::task::record::{Report, TaskHead, TaskRecord};
use rodlab_lab::identify::{IdentifiedKey, RESIDUALS_FIGURE};
use serde::Serialize;
use std::path::Path;

/// Contents of `manifest.json` and `report.md`.
#[derive(Clone, Debug, Serialize)]
pub struct IdentificationRecord {
    /// Title of the cell.
    pub cell: String,
    /// Name of the arm.
    pub arm: String,
    /// Name of the rod in its file.
    pub rod: String,
    /// Length of its free part, m.
    pub free_length_m: f64,
    /// Expected gravito-bending length, m.
    pub expected_m: f64,
    /// The poses.
    pub poses: Vec<HeldPose>,
    /// Results: the gravito-bending length, m, the natural curvatures about the y and the z axis
    /// of the hand, 1/m, and the shifts of the hand in each picture along the x and the y axis of
    /// the camera, m.
    pub parameters: Vec<IdentifiedKey>,
    /// Remarks on the fit, a sentence each.
    pub remarks: Vec<String>,
}

impl TaskRecord for IdentificationRecord {
    fn report(&self, head: &TaskHead, directory: &Path) -> Report {
        let mut report = Report::new(&format!("{}, held in front of the camera", self.rod));
        report.row("cell", self.cell.as_str());
        report.row("arm", self.arm.as_str());
        report.head(head);
        report.row("free length", millimetres(self.free_length_m));
        report.row(
            "expected gravito-bending length",
            millimetres(self.expected_m),
        );
        for (number, pose) in (1..).zip(&self.poses) {
            report.row(
                &format!("pose {number}"),
                format!(
                    "the rod leaves the hand {:.0}° from straight down, heading {:.0}°; expected standard error so far {:.2} %",
                    pose.angle_deg,
                    pose.heading_deg,
                    100.0 * pose.expected_error
                ),
            );
        }
        let names = [
            ("gravito-bending length", 1e3, "mm"),
            ("natural curvature about y of the hand", 1.0, "per metre"),
            ("natural curvature about z of the hand", 1.0, "per metre"),
        ];
        for ((name, factor, unit), key) in names.into_iter().zip(&self.parameters) {
            let error = match key.standard_error {
                Some(error) => format!("± {:.2}", factor * error),
                None => "not determined".to_owned(),
            };
            report.row(name, format!("{:.2} {error} {unit}", factor * key.value));
        }
        report.times(head);
        for remark in &self.remarks {
            report.text += &format!("\n{remark}.\n");
        }
        let looks = (1..=self.poses.len()).map(|number| {
            let words = format!("Pose {number}, with the fitted rod");
            (format!("overlay_{number}.png"), words)
        });
        report.pictures(directory, looks);
        report.pictures(directory, [(RESIDUALS_FIGURE, "Residuals of the fit")]);
        report.page("The arm in motion");
        report
    }
}

fn millimetres(metres: f64) -> String {
    format!("{:.1} mm", 1e3 * metres)
}
