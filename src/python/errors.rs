//! Exceptions with the messages of the command line; `rodlab/errors.py` defines them.

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_lab::run::RunError;
use rodlab_lab::sensitivity::SensitivityError;

/// Names of the exceptions.
pub const NAMES: [&str; 4] = [
    "RodlabError",
    "ScenarioError",
    "ConvergenceError",
    "PhysicsError",
];

/// Exit code of a command that was interrupted.
const INTERRUPTED: u8 = 130;

/// The exception for a failure with an exit code of the command line.
pub fn of_exit_code(exit_code: u8, message: &str) -> PyErr {
    let message = message.trim_end();
    let message = message.strip_prefix("error: ").unwrap_or(message);
    let name = match exit_code {
        2 => "ScenarioError",
        3 => "ConvergenceError",
        4 => "PhysicsError",
        INTERRUPTED => return PyKeyboardInterrupt::new_err(message.to_owned()),
        _ => "RodlabError",
    };
    let raise = |py: Python<'_>| -> PyResult<PyErr> {
        let kind = py.import("rodlab.errors")?.getattr(name)?;
        let error = kind.call1((message,))?;
        error.setattr("exit_code", exit_code)?;
        Ok(PyErr::from_value(error))
    };
    Python::attach(raise).unwrap_or_else(|error| error)
}

/// The exception for an invalid argument.
pub fn bad_argument(message: impl Into<String>) -> PyErr {
    of_exit_code(2, &message.into())
}

/// The exception for an error of a simulation.
pub fn of_simulation(error: &SimulationError) -> PyErr {
    of_exit_code(
        rodlab::cli::exit_code_of_simulation(error),
        &error.to_string(),
    )
}

/// The exception for an error of a run.
pub fn of_run(error: &RunError) -> PyErr {
    of_exit_code(rodlab::cli::exit_code_of_run(error), &error.to_string())
}

/// The exception for a failed differentiation.
pub fn of_sensitivity(error: SensitivityError) -> PyErr {
    let (exit_code, message) = rodlab::cli::failure_of_sensitivity(error);
    of_exit_code(exit_code, &message)
}
