//! The exit code of each failure: a stable interface for scripts, defined only here.

use crate::reproduce::ReproduceError;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_files::figure::FilmError;
use rodlab_files::results::ResultsError;
use rodlab_lab::cluster::ClusterError;
use rodlab_lab::report::{ExportError, MovieError, PlotError, ViewError};
use rodlab_lab::run::{RunError, StopRequest};
use rodlab_lab::sweep::SweepOutcome;

/// Exit code of a run that reached its time limit.
pub(super) const TIME_LIMIT: u8 = 5;
/// Exit code of an interrupted run.
pub(super) const INTERRUPTED: u8 = 130;
/// Exit code of a task whose picture does not show the whole rod, so that nothing is scored.
pub(super) const NOT_SEEN_WHOLE: u8 = 4;
/// Exit code after a panic: neither invalid input nor a failure that more time could avoid.
pub(super) const PANIC: u8 = 1;

/// Errors with an exit code of the program.
pub(super) trait ExitCode {
    /// Returns the exit code.
    fn exit_code(&self) -> u8;
}

impl ExitCode for SimulationError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::BadScene(_) => 2,
            Self::NoConvergence { .. }
            | Self::NoContactForces { .. }
            | Self::NoEquilibrium { .. } => 3,
            Self::Unphysical(_) => 4,
        }
    }
}

impl ExitCode for RunError {
    fn exit_code(&self) -> u8 {
        match self {
            // Nothing was written yet. If the mechanics rejects something, the input is invalid.
            Self::Scene(_) => 2,
            Self::Simulation { source, .. } => source.exit_code(),
            Self::TimeLimit { .. } => TIME_LIMIT,
            Self::Interrupted { .. } => INTERRUPTED,
            Self::Results(error) => error.exit_code(),
        }
    }
}

impl ExitCode for ResultsError {
    /// 2 if another directory must be chosen, 1 for a failure during the run.
    fn exit_code(&self) -> u8 {
        match self {
            Self::AnotherScenario { .. }
            | Self::AnotherKind { .. }
            | Self::AnotherCommand { .. }
            | Self::NotResults { .. }
            | Self::Link { .. }
            | Self::NotOwn { .. }
            | Self::Locked { .. }
            | Self::NotWritable { .. } => 2,
            Self::Damaged { .. } | Self::Altered { .. } | Self::Io { .. } => 1,
        }
    }
}

impl ExitCode for ClusterError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::NotOneLine { .. } | Self::NotOneWord { .. } => 2,
            _ => 1,
        }
    }
}

impl ExitCode for SweepOutcome {
    /// The exit code of the worst case, or of the interruption.
    fn exit_code(&self) -> u8 {
        let count = &self.counts;
        let searches_failed = self.found.iter().any(|found| found.value.is_none());
        match self.interrupted {
            Some(StopRequest::Interrupt) => INTERRUPTED,
            _ if count.failed > 0 => 1,
            _ if count.invalid > 0 => 2,
            _ if count.unphysical > 0 => 4,
            _ if count.no_convergence > 0 => 3,
            Some(StopRequest::TimeLimit) => TIME_LIMIT,
            None if count.unfinished > 0 => TIME_LIMIT,
            None if searches_failed => 3,
            None => 0,
        }
    }
}

impl ExitCode for ReproduceError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Run(error) => error.exit_code(),
            Self::Results(error) => error.exit_code(),
            Self::WouldReplace { .. } => 2,
            Self::Threads(_) => 1,
            Self::NoTable { .. } | Self::NotRedrawn { .. } => 2,
        }
    }
}

impl ExitCode for PlotError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Results(error) => error.exit_code(),
            _ => 2,
        }
    }
}

impl ExitCode for ViewError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::NotResults(_) | Self::NoNodes(_) | Self::NoPage { .. } => 2,
            Self::Results(error) => error.exit_code(),
        }
    }
}

impl ExitCode for ExportError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Case(error) => error.exit_code(),
            Self::Exchange(_) => 2,
            Self::Results(error) => error.exit_code(),
        }
    }
}

impl ExitCode for MovieError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::View(error) => error.exit_code(),
            Self::Results(error) => error.exit_code(),
            Self::Film(FilmError::Interrupted) => INTERRUPTED,
            Self::Film(FilmError::Encoding(_)) => 1,
            _ => 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_files::results::CaseStatus;
    use rodlab_lab::sweep::CaseCounts;
    use std::path::PathBuf;

    #[test]
    fn the_exit_code_of_a_sweep_is_that_of_the_worst_case() {
        let code = |statuses: &[CaseStatus], interrupted| {
            let mut counts = CaseCounts::default();
            statuses.iter().for_each(|status| counts.add(*status));
            SweepOutcome {
                directory: PathBuf::new(),
                counts,
                interrupted,
                found: Vec::new(),
                tables_are_old: false,
            }
            .exit_code()
        };
        use CaseStatus::{Failed, Finished, Interrupted, Invalid, NoConvergence, Unphysical};
        assert_eq!(code(&[Finished, Finished], None), 0);
        assert_eq!(code(&[Finished, NoConvergence], None), 3);
        assert_eq!(code(&[Unphysical, NoConvergence], None), 4);
        assert_eq!(code(&[Invalid, Unphysical], None), 2);
        assert_eq!(code(&[Failed, Invalid], None), 1);
        assert_eq!(
            code(&[Finished, Interrupted], Some(StopRequest::TimeLimit)),
            5
        );
        assert_eq!(
            code(&[Failed, Interrupted], Some(StopRequest::Interrupt)),
            INTERRUPTED
        );
    }
}
