//! Failures of the program: message and exit code.

use super::exit_code::{ExitCode, INTERRUPTED, TIME_LIMIT};
use super::standard_error;
use rodlab_files::finite::NotFinite;
use rodlab_lab::run::StopRequest;
use rodlab_lab::scenario::ScenarioError;
use rodlab_lab::sweep::SweepError;
use rodlab_planning::learn::TrainingError;
use rodlab_vision::VisionError;
use rodlab_workcell::virtual_cell::{RodError, ServeError};
use std::fmt::Display;

/// Failure of the program.
#[derive(Debug)]
pub enum Failure {
    /// Invalid scenarios.
    Scenario(Vec<ScenarioError>),
    /// Invalid argument.
    Input(String),
    /// No equilibrium, posture or joint path of an arm satisfies the request.
    Unreachable(String),
    /// Request to stop; all finished work is saved.
    Stopped(StopRequest),
    /// Error of the operating system.
    System(String),
    /// Other failure with its own exit code.
    Other {
        /// The exit code.
        exit_code: u8,
        /// Message.
        message: String,
    },
}

impl Failure {
    /// The exit code of the program.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scenario(_) | Self::Input(_) => 2,
            Self::Unreachable(_) => 3,
            Self::Stopped(StopRequest::Interrupt) => INTERRUPTED,
            Self::Stopped(StopRequest::TimeLimit) => TIME_LIMIT,
            Self::System(_) => 1,
            Self::Other { exit_code, .. } => *exit_code,
        }
    }

    /// Adds advice to the message about an argument.
    pub fn followed_by(self, more: &str) -> Self {
        match self {
            Self::Input(message) => Self::Input(message + more),
            other => other,
        }
    }

    /// Reports the failure on standard error.
    pub fn report(&self, colour: bool) {
        standard_error::report(&self.in_words(colour));
    }

    /// The message, ending with a line break.
    pub(super) fn in_words(&self, colour: bool) -> String {
        match self {
            Self::Scenario(errors) => errors.iter().map(|error| error.render(colour)).collect(),
            Self::Input(message)
            | Self::System(message)
            | Self::Unreachable(message)
            | Self::Other { message, .. } => format!("error: {message}\n"),
            Self::Stopped(StopRequest::Interrupt) => {
                "interrupted; run the same command again to resume\n".into()
            }
            Self::Stopped(StopRequest::TimeLimit) => {
                "time limit reached; run the same command again to resume\n".into()
            }
        }
    }

    /// Invalid input, with the message of an error.
    pub fn input(error: impl Display) -> Self {
        Self::Input(error.to_string())
    }

    /// Error of the operating system, with the message of an error.
    pub fn system(error: impl Display) -> Self {
        Self::System(error.to_string())
    }

    /// Interrupted motion.
    pub fn interrupted(message: String) -> Self {
        Self::Other {
            exit_code: INTERRUPTED,
            message,
        }
    }

    /// Failure of a training. Unsuitable files of the user are invalid input.
    pub fn of_training(error: &TrainingError) -> Self {
        match error {
            TrainingError::Results(fault) if fault.exit_code() == 1 => Self::system(error),
            TrainingError::System { .. } => Self::system(error),
            error => Self::input(error),
        }
    }
}

/// Converts errors to failures of the input, with their place.
pub trait OrInput<T> {
    /// Converts the error to one of invalid input.
    fn or_input(self) -> Result<T, Failure>;

    /// Converts the error to one of invalid input that begins with its place: a file or an option.
    fn at(self, place: impl Display) -> Result<T, Failure>;
}

impl<T, E: Display> OrInput<T> for Result<T, E> {
    fn or_input(self) -> Result<T, Failure> {
        self.map_err(Failure::input)
    }

    fn at(self, place: impl Display) -> Result<T, Failure> {
        self.map_err(|error| Failure::Input(format!("{place}: {error}")))
    }
}

/// Converts errors of the library that have exit codes.
impl<E: ExitCode + Display> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Other {
            exit_code: error.exit_code(),
            message: error.to_string(),
        }
    }
}

impl From<NotFinite> for Failure {
    fn from(error: NotFinite) -> Self {
        Self::Other {
            exit_code: 4,
            message: format!("{error}: it was not written"),
        }
    }
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(vec![error])
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            // Scenarios print the faulty lines.
            SweepError::Scenario(error) => error.into(),
            SweepError::Results(error) => error.into(),
            SweepError::Threads(_) => Self::system(error),
            error => Self::input(error),
        }
    }
}

impl From<RodError> for Failure {
    fn from(error: RodError) -> Self {
        match error {
            RodError::File(error) => (*error).into(),
            error => Self::input(error),
        }
    }
}

impl From<ServeError> for Failure {
    fn from(error: ServeError) -> Self {
        match error {
            ServeError::Rod(error) => Self::Other {
                exit_code: error.exit_code(),
                message: ServeError::Rod(error).to_string(),
            },
            error => Self::input(error),
        }
    }
}

impl From<VisionError> for Failure {
    fn from(error: VisionError) -> Self {
        match error {
            VisionError::Unwritable { .. } => Self::system(error),
            error => Self::input(error),
        }
    }
}
