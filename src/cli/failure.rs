//! Why the program fails, what it says and its exit code.

use super::exit_code::{ExitCode, INTERRUPTED, TIME_LIMIT};
use super::standard_error;
use crate::reproduce::ReproduceError;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_files::finite::NotFinite;
use rodlab_files::results::ResultsError;
use rodlab_lab::cluster::ClusterError;
use rodlab_lab::report::{PlotError, ViewError};
use rodlab_lab::run::{RunError, StopRequest};
use rodlab_lab::scenario::ScenarioError;
use rodlab_lab::sweep::SweepError;
use rodlab_planning::learn::TrainingError;
use rodlab_vision::VisionError;
use rodlab_workcell::virtual_cell::{RodError, ServeError};

/// Why the program fails.
#[derive(Debug)]
pub enum Failure {
    /// Scenarios are wrong.
    Scenario(Vec<ScenarioError>),
    /// An argument is wrong.
    Input(String),
    /// A run ended early, or its scene is impossible.
    Run(RunError),
    /// A sweep could not be run.
    Sweep(SweepError),
    /// Cases of a sweep failed, or were not run.
    Cases {
        /// The exit code of the worst.
        exit_code: u8,
        /// What to say.
        message: String,
    },
    /// Slurm did not do what it was asked to.
    Cluster(ClusterError),
    /// An artefact of the thesis was not made.
    Reproduce(ReproduceError),
    /// A results directory could not be read or written.
    Results(ResultsError),
    /// A figure was not drawn.
    Plot(PlotError),
    /// There is no page of rods in motion.
    View(ViewError),
    /// No equilibrium was found.
    NoEquilibrium(SimulationError),
    /// No posture of an arm, or no path of its joints, does what was asked.
    Unreachable(String),
    /// Physics checks failed.
    Checks {
        /// How many.
        failed: usize,
    },
    /// It was asked to stop, with all that is done saved.
    Stopped(StopRequest),
    /// A result has a number that is not finite, and was not written.
    NotFinite(NotFinite),
    /// The system refused something.
    System(String),
}

impl ExitCode for Failure {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Scenario(_) | Self::Input(_) => 2,
            Self::Run(error) => error.exit_code(),
            Self::Sweep(error) => error.exit_code(),
            Self::Cases { exit_code, .. } => *exit_code,
            Self::Reproduce(error) => error.exit_code(),
            Self::Results(error) => error.exit_code(),
            Self::Plot(error) => error.exit_code(),
            Self::View(error) => error.exit_code(),
            Self::NoEquilibrium(_) | Self::Unreachable(_) => 3,
            Self::Checks { .. } | Self::NotFinite(_) => 4,
            Self::Stopped(StopRequest::Interrupt) => INTERRUPTED,
            Self::Stopped(StopRequest::TimeLimit) => TIME_LIMIT,
            Self::Cluster(ClusterError::NotOneLine { .. } | ClusterError::NotOneWord { .. }) => 2,
            Self::Cluster(_) | Self::System(_) => 1,
        }
    }
}

impl From<NotFinite> for Failure {
    fn from(error: NotFinite) -> Self {
        Self::NotFinite(error)
    }
}

impl Failure {
    /// Says what is wrong on standard error.
    pub fn report(&self, colour: bool) {
        standard_error::report(&self.in_words(colour));
    }

    /// What is wrong, whole lines.
    fn in_words(&self, colour: bool) -> String {
        match self {
            Self::Scenario(errors) => errors.iter().map(|error| error.render(colour)).collect(),
            Self::Input(message)
            | Self::System(message)
            | Self::Unreachable(message)
            | Self::Cases { message, .. } => format!("error: {message}\n"),
            Self::Stopped(StopRequest::Interrupt) => {
                "interrupted; the same command goes on\n".into()
            }
            Self::Stopped(StopRequest::TimeLimit) => {
                "time limit reached; the same command goes on\n".into()
            }
            Self::Checks { failed } => format!("error: {failed} physics checks failed\n"),
            Self::Run(error) => format!("error: {error}\n"),
            Self::NotFinite(error) => format!("error: {error}: it was not written\n"),
            Self::NoEquilibrium(error) => format!("error: {error}\n"),
            Self::Sweep(error) => format!("error: {error}\n"),
            Self::Cluster(error) => format!("error: {error}\n"),
            Self::Reproduce(error) => format!("error: {error}\n"),
            Self::Results(error) => format!("error: {error}\n"),
            Self::Plot(error) => format!("error: {error}\n"),
            Self::View(error) => format!("error: {error}\n"),
        }
    }
}

impl Failure {
    /// Why nothing was trained: files of the user's that do not serve are bad input.
    pub fn of_training(error: &TrainingError) -> Self {
        match error {
            TrainingError::Results(fault) if fault.exit_code() == 1 => {
                Self::System(error.to_string())
            }
            TrainingError::System { .. } => Self::System(error.to_string()),
            error => Self::Input(error.to_string()),
        }
    }
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(vec![error])
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            // Scenarios show the lines that are at fault.
            SweepError::Scenario(error) => error.into(),
            error => Self::Sweep(error),
        }
    }
}

impl From<ClusterError> for Failure {
    fn from(error: ClusterError) -> Self {
        Self::Cluster(error)
    }
}

impl From<ReproduceError> for Failure {
    fn from(error: ReproduceError) -> Self {
        Self::Reproduce(error)
    }
}

impl From<ResultsError> for Failure {
    fn from(error: ResultsError) -> Self {
        Self::Results(error)
    }
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        Self::Plot(error)
    }
}

impl From<ViewError> for Failure {
    fn from(error: ViewError) -> Self {
        Self::View(error)
    }
}

impl From<RodError> for Failure {
    fn from(error: RodError) -> Self {
        match error {
            RodError::File(error) => (*error).into(),
            error => Self::Input(error.to_string()),
        }
    }
}

impl From<ServeError> for Failure {
    fn from(error: ServeError) -> Self {
        match error {
            ServeError::Rod(error) => Self::Cases {
                exit_code: error.exit_code(),
                message: ServeError::Rod(error).to_string(),
            },
            error => Self::Input(error.to_string()),
        }
    }
}

impl From<VisionError> for Failure {
    fn from(error: VisionError) -> Self {
        match error {
            VisionError::Unwritable { .. } => Self::System(error.to_string()),
            error => Self::Input(error.to_string()),
        }
    }
}
