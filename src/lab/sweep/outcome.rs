//! Outcome of a sweep.

use crate::run::StopRequest;
use rodlab_files::results::CaseStatus;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Finding of one search.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Index of the combination of the other varied keys.
    pub index: usize,
    /// The value of the searched key, in the unit of the interval in the scenario; `None` if the
    /// search did not finish.
    pub value: Option<f64>,
    /// Ends of the last interval.
    pub interval: [f64; 2],
    /// Cases that it took.
    pub evaluations: usize,
    /// Why it did not finish.
    pub failure: Option<String>,
}

/// Outcome of a sweep.
#[derive(Clone, Debug)]
pub struct SweepOutcome {
    /// The results directory.
    pub directory: PathBuf,
    /// Number of cases in each state, in the sweep or in the share that was run.
    pub counts: CaseCounts,
    /// Reason of the request to stop, if there was one.
    pub interrupted: Option<StopRequest>,
    /// Findings of the searches, one for each combination of the other varied keys; empty without
    /// a search.
    pub found: Vec<Found>,
    /// Whether the tables were not updated, since the sweep was stopped and they take long to
    /// write.
    pub tables_are_old: bool,
}

/// Number of cases in each state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CaseCounts {
    /// Finished.
    pub finished: usize,
    /// Not started, running, interrupted or stopped by a time limit.
    pub unfinished: usize,
    /// Newton's method did not converge.
    pub no_convergence: usize,
    /// A physics check failed.
    pub unphysical: usize,
    /// The scenario of the case is impossible.
    pub invalid: usize,
    /// Results could not be written.
    pub failed: usize,
    /// Cases in any state that have remarks: see the column `remarks` of the summary.
    pub remarked: usize,
}

impl CaseCounts {
    /// Counts a case.
    pub fn add(&mut self, status: CaseStatus) {
        let count = match status {
            CaseStatus::Finished => &mut self.finished,
            CaseStatus::Pending
            | CaseStatus::Running
            | CaseStatus::Interrupted
            | CaseStatus::TimeLimit => &mut self.unfinished,
            CaseStatus::NoConvergence => &mut self.no_convergence,
            CaseStatus::Unphysical => &mut self.unphysical,
            CaseStatus::Invalid => &mut self.invalid,
            CaseStatus::Failed => &mut self.failed,
        };
        *count += 1;
    }

    /// All cases.
    pub fn total(&self) -> usize {
        self.finished + self.unfinished + self.not_good()
    }

    /// Cases that failed.
    pub fn not_good(&self) -> usize {
        self.no_convergence + self.unphysical + self.invalid + self.failed
    }
}

impl fmt::Display for CaseCounts {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} of {} cases finished",
            self.finished,
            self.total()
        )?;
        for (count, words) in [
            (self.unfinished, "unfinished"),
            (self.no_convergence, "without convergence"),
            (self.unphysical, "failed a physics check"),
            (self.invalid, "with an invalid scenario"),
            (self.failed, "whose results could not be written"),
        ] {
            if count > 0 {
                write!(formatter, ", {count} {words}")?;
            }
        }
        Ok(())
    }
}
