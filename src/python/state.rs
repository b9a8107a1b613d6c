//! States of simulations.

use crate::errors::bad_argument;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rodlab_lab::run::LiveState;
use serde::{Deserialize, Serialize};

/// All data that determine the future of a simulation.
#[derive(Clone, Serialize, Deserialize)]
pub struct Saved {
    /// The run.
    pub run: LiveState,
    /// Forces and moments that the program applies.
    pub actions: [Vec<f64>; 2],
    /// Natural curvature that the program sets.
    pub curvature: Vec<f64>,
    /// Whether the program has changed the course of the scenario.
    pub intervened: bool,
}

/// All data that determine the future of a simulation. Can be pickled.
#[pyclass(frozen, module = "rodlab._rodlab")]
pub struct State {
    pub saved: Saved,
}

#[pymethods]
impl State {
    /// Time, s.
    #[getter]
    fn time(&self) -> f64 {
        self.saved.run.simulation.time
    }

    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let saved = postcard::from_bytes(bytes);
        let saved = saved.map_err(|error| bad_argument(format!("not a state: {error}")))?;
        Ok(Self { saved })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let from_bytes = py.get_type::<Self>().getattr("_from_bytes")?;
        let bytes = postcard::to_stdvec(&self.saved).expect("plain data can be encoded");
        let arguments = (PyBytes::new(py, &bytes),);
        (from_bytes, arguments)
            .into_pyobject(py)
            .map(Bound::into_any)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        format!("<rodlab.State at {} s>", self.time())
    }
}
