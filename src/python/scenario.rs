//! Scenarios from files, texts and dictionaries.

use crate::errors::bad_argument;
use crate::gradient::{derivatives, over_fields};
use crate::table::table;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use rodlab::presets::{Preset, PresetKind};
use rodlab_lab::experiment::{self, prepare};
use rodlab_lab::run::PreparedRun;
use rodlab_lab::scenario::{self, Loaded, ScenarioError};
use std::path::PathBuf;
use std::sync::Arc;

/// A scenario: everything that a file describes, with defaults filled in.
#[pyclass(frozen, module = "rodlab._rodlab", from_py_object)]
#[derive(Clone)]
pub struct Scenario {
    loaded: Arc<Loaded>,
    reader: Arc<Reader>,
}

/// Reads a scenario from its source, with further overrides.
type Reader = dyn Fn(&[String]) -> Result<Loaded, ScenarioError> + Send + Sync;

impl Scenario {
    fn of(
        overrides: Option<Vec<String>>,
        read: impl Fn(&[String]) -> Result<Loaded, ScenarioError> + Send + Sync + 'static,
    ) -> PyResult<Self> {
        let overrides = overrides.unwrap_or_default();
        let reader = move |more: &[String]| read(&[overrides.as_slice(), more].concat());
        let loaded = reader(&[]).map_err(|error| bad_argument(error.to_string()))?;
        Ok(Self {
            loaded: Arc::new(loaded),
            reader: Arc::new(reader),
        })
    }

    /// Returns a function that reads the scenario with further overrides of the form `key=value`.
    pub fn source(&self) -> impl Fn(&[String]) -> Result<Loaded, ScenarioError> + use<> {
        let reader = Arc::clone(&self.reader);
        move |more| reader(more)
    }

    /// The resolved scenario.
    pub fn resolved(&self) -> &scenario::Scenario {
        &self.loaded.scenario
    }

    /// The scene of the scenario, with observers and controllers.
    pub fn prepare(&self) -> PyResult<PreparedRun> {
        prepare(&self.loaded.scenario)
            .map_err(|issues| bad_argument(self.loaded.locate(issues).to_string()))
    }
}

#[pymethods]
impl Scenario {
    #[staticmethod]
    #[pyo3(signature = (path, overrides = None))]
    fn load(path: PathBuf, overrides: Option<Vec<String>>) -> PyResult<Self> {
        let kind = PresetKind::Scenario;
        let path = match path.exists() {
            true => path,
            false => match Preset::in_place_of(kind, &path) {
                Some(preset) => preset
                    .file()
                    .map_err(|error| bad_argument(error.to_string()))?,
                None => path,
            },
        };
        Self::of(overrides, move |all| experiment::load(&path, all))
    }

    #[staticmethod]
    #[pyo3(signature = (text, overrides = None, name = "scenario", directory = None))]
    fn loads(
        text: &str,
        overrides: Option<Vec<String>>,
        name: &str,
        directory: Option<PathBuf>,
    ) -> PyResult<Self> {
        let (name, text, folder) = (name.to_owned(), text.to_owned(), folder(directory));
        Self::of(overrides, move |all| {
            experiment::from_text(&name, &text, &folder, all)
        })
    }

    #[staticmethod]
    #[pyo3(signature = (table, overrides = None, name = "scenario", directory = None))]
    fn from_dict(
        table: &Bound<'_, PyMapping>,
        overrides: Option<Vec<String>>,
        name: &str,
        directory: Option<PathBuf>,
    ) -> PyResult<Self> {
        let (name, table, folder) = (name.to_owned(), self::table(table)?, folder(directory));
        Self::of(overrides, move |all| {
            experiment::from_table(&name, table.clone(), &folder, all)
        })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.loaded.scenario.name
    }

    #[getter]
    fn experiment(&self) -> &str {
        self.loaded.scenario.experiment.name()
    }

    /// Differentiate probes with respect to keys at the outputs: a dictionary of arrays.
    fn sensitivity<'py>(
        &self,
        py: Python<'py>,
        to: Vec<String>,
        of: Vec<String>,
    ) -> PyResult<Bound<'py, PyDict>> {
        derivatives(py, self.source(), &to, &of, None)
    }

    /// Differentiate probes at the end with respect to fields along the rods: a dictionary of
    /// arrays.
    fn field_sensitivity<'py>(
        &self,
        py: Python<'py>,
        fields: Vec<String>,
        of: Vec<String>,
        parts: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        over_fields(py, self.source(), &fields, &of, parts)
    }

    /// Return the resolved scenario as TOML.
    fn to_toml(&self) -> String {
        self.loaded.scenario.to_toml()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let loads = py.get_type::<Self>().getattr("loads")?;
        let none: Vec<String> = Vec::new();
        (loads, (self.to_toml(), none, self.name()))
            .into_pyobject(py)
            .map(Bound::into_any)
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }

    fn __repr__(&self) -> String {
        format!(
            "<rodlab.Scenario {:?} ({})>",
            self.name(),
            self.experiment()
        )
    }
}

/// The folder to which file names in a scenario are relative.
fn folder(given: Option<PathBuf>) -> PathBuf {
    given.unwrap_or_else(|| PathBuf::from("."))
}
