//! Exceptions, with the texts of the command line.

use pyo3::exceptions::{PyException, PyKeyboardInterrupt};
use pyo3::prelude::*;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_lab::run::RunError;

pyo3::create_exception!(
    rodlab,
    RodlabError,
    PyException,
    "Base class of all errors of rodlab; `exit_code` is that of the command line."
);
pyo3::create_exception!(
    rodlab,
    ScenarioError,
    RodlabError,
    "A fault of a scenario, of an argument, or of a file."
);
pyo3::create_exception!(
    rodlab,
    ConvergenceError,
    RodlabError,
    "No step converges, or no equilibrium is found."
);
pyo3::create_exception!(rodlab, PhysicsError, RodlabError, "A physics check failed.");

/// Exit code of a command that was interrupted.
const INTERRUPTED: u8 = 130;

/// The exception for a failure with an exit code of the command line.
pub fn of_exit_code(exit_code: u8, message: &str) -> PyErr {
    let message = message.trim_end().to_owned();
    let message = message
        .strip_prefix("error: ")
        .unwrap_or(&message)
        .to_owned();
    let error = match exit_code {
        2 => ScenarioError::new_err(message),
        3 => ConvergenceError::new_err(message),
        4 => PhysicsError::new_err(message),
        INTERRUPTED => return PyKeyboardInterrupt::new_err(message),
        _ => RodlabError::new_err(message),
    };
    Python::attach(|py| error.value(py).setattr("exit_code", exit_code))
        .map_or_else(|e| e, |()| error)
}

/// The exception for a fault of an argument.
pub fn bad_argument(message: impl Into<String>) -> PyErr {
    of_exit_code(2, &message.into())
}

/// The exception for an error of a simulation.
pub fn of_simulation(error: &SimulationError) -> PyErr {
    let exit_code = match error {
        SimulationError::BadScene(_) => 2,
        SimulationError::Unphysical(_) => 4,
        _ => 3,
    };
    of_exit_code(exit_code, &error.to_string())
}

/// The exception for an error of a run.
pub fn of_run(error: &RunError) -> PyErr {
    match error {
        RunError::Scene(source) | RunError::Simulation { source, .. } => {
            let exit_code = match source {
                SimulationError::BadScene(_) => 2,
                SimulationError::Unphysical(_) => 4,
                _ => 3,
            };
            of_exit_code(exit_code, &error.to_string())
        }
        RunError::Interrupted { .. } => of_exit_code(INTERRUPTED, &error.to_string()),
        RunError::TimeLimit { .. } => of_exit_code(5, &error.to_string()),
        RunError::Results(_) => of_exit_code(1, &error.to_string()),
    }
}
