//! Derivatives of probes over keys as arrays.

use crate::arrays::{column, cube, table};
use crate::attention::Attention;
use crate::errors::of_sensitivity;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rodlab_lab::scenario::{Loaded, ScenarioError};
use rodlab_lab::sensitivity::{Derivatives, derivatives_at};

/// Differentiates probes over keys at given times, s, or at the outputs.
pub fn derivatives<'py>(
    py: Python<'py>,
    source: impl Fn(&[String]) -> Result<Loaded, ScenarioError> + Sync,
    to: &[String],
    of: &[String],
    times: Option<&[f64]>,
) -> PyResult<Bound<'py, PyDict>> {
    let (found, attention) = py.detach(|| {
        let attention = Attention::new();
        let goes_on = || attention.continues();
        (derivatives_at(&source, of, to, times, &goes_on), attention)
    });
    attention.finish()?;
    as_arrays(py, &found.map_err(of_sensitivity)?)
}

/// Derivatives as a dictionary of arrays: t times, k keys, c columns.
fn as_arrays<'py>(py: Python<'py>, found: &Derivatives) -> PyResult<Bound<'py, PyDict>> {
    let [times, keys, columns] = [found.rows.len(), found.keys.len(), found.columns.len()];
    let or_nan = |value: &Option<f64>| value.unwrap_or(f64::NAN);
    let values = found
        .rows
        .iter()
        .flat_map(|row| row.values.iter().map(or_nan));
    let derivatives = found
        .rows
        .iter()
        .flat_map(|row| row.derivatives.iter().flatten().map(or_nan));
    let answer = PyDict::new(py);
    answer.set_item(
        "times",
        column(py, found.rows.iter().map(|row| row.time).collect()),
    )?;
    answer.set_item("columns", found.columns.clone())?;
    answer.set_item(
        "keys",
        found
            .keys
            .iter()
            .map(|key| key.key.clone())
            .collect::<Vec<_>>(),
    )?;
    answer.set_item(
        "units",
        found
            .keys
            .iter()
            .map(|key| key.unit.clone())
            .collect::<Vec<_>>(),
    )?;
    answer.set_item(
        "key_values",
        column(py, found.keys.iter().map(|key| key.value).collect()),
    )?;
    answer.set_item("values", table(py, [times, columns], values.collect()))?;
    answer.set_item(
        "derivatives",
        cube(py, [times, keys, columns], derivatives.collect()),
    )?;
    Ok(answer)
}
