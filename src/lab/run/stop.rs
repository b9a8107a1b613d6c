//! Reasons why the steps of a run end early.

use super::{Reached, RunError};
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_files::results::{CaseStatus, ResultsError};
use std::path::PathBuf;

/// An external request to stop after the current step, with a checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopRequest {
    /// Interruption by the user or the system.
    Interrupt,
    /// The time limit is reached.
    TimeLimit,
}

/// Callback that returns whether to stop, called between steps and during long ones. A request
/// persists: callers query it again when they find unfinished work.
pub type StopRequests<'a> = &'a (dyn Fn() -> Option<StopRequest> + Sync);

/// Reason why the steps ended early.
pub(super) enum Stop {
    Interrupted,
    TimeLimit,
    Simulation(SimulationError),
    Results(ResultsError),
}

impl From<StopRequest> for Stop {
    fn from(request: StopRequest) -> Self {
        match request {
            StopRequest::Interrupt => Self::Interrupted,
            StopRequest::TimeLimit => Self::TimeLimit,
        }
    }
}

impl From<SimulationError> for Stop {
    fn from(error: SimulationError) -> Self {
        Self::Simulation(error)
    }
}

impl From<ResultsError> for Stop {
    fn from(error: ResultsError) -> Self {
        Self::Results(error)
    }
}

impl Stop {
    /// The resulting status of the case.
    pub fn status(&self) -> CaseStatus {
        match self {
            Self::Interrupted => CaseStatus::Interrupted,
            Self::TimeLimit => CaseStatus::TimeLimit,
            Self::Simulation(
                SimulationError::NoConvergence { .. }
                | SimulationError::NoContactForces { .. }
                | SimulationError::NoEquilibrium { .. },
            ) => CaseStatus::NoConvergence,
            Self::Simulation(SimulationError::Unphysical(_)) => CaseStatus::Unphysical,
            Self::Simulation(SimulationError::BadScene(_)) | Self::Results(_) => CaseStatus::Failed,
        }
    }

    /// The reason as text, for the record of the case.
    pub fn reason(&self) -> String {
        match self {
            Self::Interrupted => "interrupted".to_owned(),
            Self::TimeLimit => "time limit reached".to_owned(),
            Self::Simulation(error) => error.to_string(),
            Self::Results(error) => error.to_string(),
        }
    }

    /// Whether the state of the simulation is sound and may be saved.
    pub fn leaves_sound_state(&self) -> bool {
        matches!(
            self.status(),
            CaseStatus::Interrupted | CaseStatus::TimeLimit | CaseStatus::NoConvergence
        )
    }

    /// The error with which the run ends.
    pub fn into_error(self, reached: Reached, directory: PathBuf) -> RunError {
        match self {
            Self::Interrupted => RunError::Interrupted { reached, directory },
            Self::TimeLimit => RunError::TimeLimit { reached, directory },
            Self::Simulation(source) => RunError::Simulation { source, directory },
            Self::Results(error) => RunError::Results(error),
        }
    }
}
