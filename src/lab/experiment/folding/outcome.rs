//! Outcome of a fold.

use rodlab_files::results::{CaseOutcome, NamedValues};
use serde::{Deserialize, Serialize};

/// Outcomes of a fold: the last columns of `summary.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FoldingOutcome {
    /// Largest displacement of the free end, m.
    pub largest_sliding_m: f64,
    /// Final displacement of the free end, along the fold, m.
    pub final_sliding_m: f64,
    /// Distance from the edge to the crease along the sheet, m; `None` if there is no fold.
    pub fold_length_m: Option<f64>,
    /// Difference from the requested length, m.
    pub fold_length_error_m: Option<f64>,
    /// Largest force of the gripper on the whole sheet, N.
    pub largest_gripper_force_n: f64,
    /// Largest speed of a node of the sheet, m/s; far above that of the gripper if the sheet
    /// snaps.
    pub largest_speed_m_s: f64,
}

impl FoldingOutcome {
    /// The outcome of a case; `None` if no sheet was folded.
    pub fn of(case: &CaseOutcome) -> Option<Self> {
        let observed = &case.observed;
        Some(Self {
            largest_sliding_m: observed.number("largest_sliding_m")?,
            final_sliding_m: observed.number("final_sliding_m")?,
            fold_length_m: observed.number("fold_length_m"),
            fold_length_error_m: observed.number("fold_length_error_m"),
            largest_gripper_force_n: observed.number("largest_gripper_force_n")?,
            largest_speed_m_s: observed.number("largest_speed_m_s")?,
        })
    }

    /// The columns of the summary.
    pub fn values(&self) -> NamedValues {
        NamedValues::from([
            ("largest_sliding_m", self.largest_sliding_m.into()),
            ("final_sliding_m", self.final_sliding_m.into()),
            ("fold_length_m", self.fold_length_m.into()),
            ("fold_length_error_m", self.fold_length_error_m.into()),
            (
                "largest_gripper_force_n",
                self.largest_gripper_force_n.into(),
            ),
            ("largest_speed_m_s", self.largest_speed_m_s.into()),
        ])
    }

    /// Main results for the user: names and texts, a line each.
    pub fn highlights(&self) -> Vec<(String, String)> {
        let fold = match (self.fold_length_m, self.fold_length_error_m) {
            (Some(length), Some(error)) => format!(
                "{:.2} mm long, {:+.2} mm from the requested length",
                1e3 * length,
                1e3 * error
            ),
            _ => "none: the edge is not down, or not on the sheet".to_owned(),
        };
        let slid = format!(
            "{:.2} mm at most, {:+.2} mm at the end",
            1e3 * self.largest_sliding_m,
            1e3 * self.final_sliding_m
        );
        vec![("fold".to_owned(), fold), ("slid".to_owned(), slid)]
    }
}
