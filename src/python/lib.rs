//! The Python module `rodlab._rodlab`: scenarios, simulations step by step, batches, and the command line.
//!
//! `rodlab/_rodlab.pyi` describes its interface.
//!
//! | file | what |
//! |---|---|
//! | `table` | values of Python as a table of a scenario |
//! | `scenario` | scenarios from files, texts and dictionaries |
//! | `stepper` | a simulation: its steps, poses of its clamps |
//! | `simulation` | the same as a class: actions, state, measurements |
//! | `arrays` | its state as arrays; arrays of Python with checked shapes |
//! | `pose` | clamps that move to a pose during a step |
//! | `actuation` | natural curvature as an array |
//! | `contacts` | contacts as arrays |
//! | `state` | states that are saved and restored |
//! | `gradient` | derivatives of probes over keys |
//! | `batch` | many simulations on all cores |
//! | `attention` | Ctrl-C during long calls |
//! | `command` | the command line, runs with files, traces of pictures |
//! | `errors` | exceptions |

mod actuation;
mod arrays;
mod attention;
mod batch;
mod command;
mod contacts;
mod errors;
mod gradient;
mod pose;
mod scenario;
mod simulation;
mod state;
mod stepper;
mod table;

#[pyo3::pymodule]
mod _rodlab {
    #[pymodule_export]
    use super::batch::Batch;
    #[pymodule_export]
    use super::command::{command, demonstrations, main, run, trace};
    #[pymodule_export]
    use super::contacts::Contacts;
    #[pymodule_export]
    use super::scenario::Scenario;
    #[pymodule_export]
    use super::simulation::Simulation;
    #[pymodule_export]
    use super::state::State;
    #[pymodule_export]
    use super::stepper::StepReport;

    /// Adds the version and the exceptions to the module.
    #[pymodule_init]
    fn complete(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::{PyAnyMethods, PyModuleMethods};
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        let errors = module.py().import("rodlab.errors")?;
        for name in super::errors::NAMES {
            module.add(name, errors.getattr(name)?)?;
        }
        Ok(())
    }
}
