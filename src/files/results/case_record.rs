//! State, outcome and cost of a case.

use super::CaseOutcome;
use super::usage::{Usage, duration};
use serde::{Deserialize, Serialize};

/// State and outcome of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseRecord {
    /// Status of the case.
    pub status: CaseStatus,
    /// Outcome of the case so far.
    pub outcome: CaseOutcome,
    /// Wall time of all calls that worked on it, s.
    pub wall_time: f64,
    /// Part of the wall time spent in steps with contact, s.
    #[serde(default)]
    pub wall_time_with_contact: f64,
    /// Processor time of all these calls, s; `None` if the system does not report it.
    #[serde(default)]
    pub cpu_time: Option<f64>,
    /// Largest resident memory of a process that worked on it, bytes; `None` if the system does not
    /// report it.
    #[serde(default)]
    pub peak_memory: Option<u64>,
    /// Why it ended early.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

impl CaseRecord {
    /// A pending case.
    pub fn new(status: CaseStatus) -> Self {
        Self {
            status,
            outcome: CaseOutcome::default(),
            wall_time: 0.0,
            wall_time_with_contact: 0.0,
            cpu_time: None,
            peak_memory: None,
            error: None,
        }
    }

    /// A case that has been worked on.
    pub fn with_usage(
        status: CaseStatus,
        outcome: CaseOutcome,
        usage: Usage,
        error: Option<String>,
    ) -> Self {
        Self {
            status,
            outcome,
            wall_time: usage.wall_time.as_secs_f64(),
            wall_time_with_contact: usage.wall_time_with_contact.as_secs_f64(),
            cpu_time: usage.cpu_time.map(|time| time.as_secs_f64()),
            peak_memory: usage.peak_memory,
            error,
        }
    }

    /// Cost of the case.
    pub fn usage(&self) -> Usage {
        Usage {
            wall_time: duration(self.wall_time),
            wall_time_with_contact: duration(self.wall_time_with_contact),
            cpu_time: self.cpu_time.map(duration),
            peak_memory: self.peak_memory,
        }
    }
}

/// Status of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CaseStatus {
    /// Not started.
    Pending,
    /// Running, or killed.
    Running,
    /// Finished.
    Finished,
    /// Stopped by Ctrl-C or SIGTERM, resumable.
    Interrupted,
    /// Stopped by the time limit, resumable.
    TimeLimit,
    /// Newton's method did not converge at the smallest step.
    NoConvergence,
    /// A physics check failed.
    Unphysical,
    /// The scenario of the case is impossible.
    Invalid,
    /// Results could not be written; running the same command again retries the case.
    Failed,
}

impl CaseStatus {
    /// Whether the case has a final outcome, which the same command would only reproduce.
    pub fn is_final(self) -> bool {
        match self {
            Self::Finished | Self::NoConvergence | Self::Unphysical | Self::Invalid => true,
            Self::Pending | Self::Running | Self::Interrupted | Self::TimeLimit | Self::Failed => {
                false
            }
        }
    }

    /// The status as text.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Pending => "not started",
            Self::Running => "running",
            Self::Finished => "finished",
            Self::Interrupted => "interrupted",
            Self::TimeLimit => "stopped by a time limit",
            Self::NoConvergence => "no convergence",
            Self::Unphysical => "a physics check failed",
            Self::Invalid => "an invalid scenario",
            Self::Failed => "results could not be written",
        }
    }
}
