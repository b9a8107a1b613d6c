//! Derivatives of probes with respect to keys and to fields along rods, as arrays.

use crate::arrays::{column, cube, table};
use crate::attention::Attention;
use crate::errors::{bad_argument, of_sensitivity};
use numpy::IntoPyArray;
use numpy::ndarray::Array4;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rodlab_lab::scenario::{Loaded, ScenarioError};
use rodlab_lab::sensitivity::{
    Derivatives, Field, FieldDerivatives, derivatives_at, field_derivatives,
};

/// Differentiates probes with respect to keys at given times, s, or at the outputs.
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

/// Differentiates probes with respect to fields, given by their names, that change in one of
/// `parts` of the motion each.
pub fn over_fields<'py>(
    py: Python<'py>,
    source: impl Fn(&[String]) -> Result<Loaded, ScenarioError> + Sync,
    fields: &[String],
    of: &[String],
    parts: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let named = |name: &String| {
        Field::named(name).ok_or_else(|| {
            let names = Field::ALL.map(Field::name).join(", ");
            bad_argument(format!("fields: unknown field `{name}`; allowed: {names}"))
        })
    };
    let fields = fields.iter().map(named).collect::<PyResult<Vec<_>>>()?;
    if fields.is_empty() || parts == 0 {
        let reason = "fields, parts: expected at least one field and one part";
        return Err(bad_argument(reason.to_owned()));
    }
    let (found, attention) = py.detach(|| {
        let attention = Attention::new();
        let goes_on = || attention.continues();
        let found = field_derivatives(&source, of, &fields, parts, &goes_on);
        (found, attention)
    });
    attention.finish()?;
    fields_as_arrays(py, &found.map_err(of_sensitivity)?)
}

/// Derivatives over fields as a dictionary of arrays: p parts, n nodes, f components, c columns.
fn fields_as_arrays<'py>(
    py: Python<'py>,
    found: &FieldDerivatives,
) -> PyResult<Bound<'py, PyDict>> {
    let parts = found.ends.len();
    let [components, columns] = [found.components.len(), found.columns.len()];
    let nodes = &found.rows[..found.rows.len() / parts];
    let rows = found.rows.iter().flat_map(|row| row.derivatives.iter());
    let flat: Vec<f64> = rows.flatten().copied().collect();
    let array = Array4::from_shape_vec([parts, nodes.len(), components, columns], flat)
        .expect("one element for each place");
    let answer = PyDict::new(py);
    answer.set_item("columns", found.columns.clone())?;
    answer.set_item("values", column(py, found.values.clone()))?;
    let of_components = found.components.iter();
    let fields: Vec<&String> = of_components.clone().map(|(name, _)| name).collect();
    let units: Vec<Option<&str>> = of_components.map(|(_, unit)| *unit).collect();
    answer.set_item("fields", fields)?;
    answer.set_item("units", units)?;
    let rods: Vec<&String> = nodes.iter().map(|row| &row.rod).collect();
    answer.set_item("rods", rods)?;
    let numbers: Vec<usize> = nodes.iter().map(|row| row.node).collect();
    answer.set_item("nodes", numbers)?;
    let arc_lengths = nodes.iter().map(|row| row.arc_length).collect();
    answer.set_item("arc_lengths", column(py, arc_lengths))?;
    answer.set_item("ends", column(py, found.ends.clone()))?;
    answer.set_item("derivatives", array.into_pyarray(py))?;
    Ok(answer)
}
