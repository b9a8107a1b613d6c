//! Values of Python as a table of a scenario.

use crate::errors::bad_argument;
use numpy::{PyArrayDescrMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{
    PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PySequence, PyString, PyTuple,
};
use toml::{Table, Value};

/// Largest depth of nested values.
const DEEPEST: usize = 64;

/// Converts a mapping to a table. Keys with the value `None` are omitted.
///
/// # Errors
/// A key is not text, or a value cannot occur in a scenario; the message gives the place.
pub fn table(mapping: &Bound<'_, PyMapping>) -> PyResult<Table> {
    entries(mapping, "", 0)
}

fn entries(mapping: &Bound<'_, PyMapping>, place: &str, depth: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for item in mapping.items()?.iter() {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let Ok(key) = key.extract::<String>() else {
            let place = if place.is_empty() {
                "the scenario"
            } else {
                place
            };
            return Err(bad_argument(format!(
                "{place}: keys are texts, found {}",
                name_of_type(&key)
            )));
        };
        if value.is_none() {
            continue;
        }
        let place = match place {
            "" => key.clone(),
            place => format!("{place}.{key}"),
        };
        table.insert(key, one(&value, &place, depth + 1)?);
    }
    Ok(table)
}

fn one(value: &Bound<'_, PyAny>, place: &str, depth: usize) -> PyResult<Value> {
    if depth > DEEPEST {
        return Err(bad_argument(format!(
            "{place}: nested deeper than {DEEPEST} levels"
        )));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_str()?.to_owned()));
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        return Ok(Value::Float(number.value()));
    }
    if value.is_instance_of::<PyInt>() {
        let number = value.extract::<i64>();
        return number
            .map(Value::Integer)
            .map_err(|_| bad_argument(format!("{place}: {value} has more than 64 bits")));
    }
    if let Ok(array) = value.cast::<PyUntypedArray>() {
        return numbers(array, place, depth);
    }
    if let Ok(mapping) = value.cast::<PyMapping>() {
        return Ok(Value::Table(entries(mapping, place, depth)?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let sequence = value.cast::<PySequence>()?;
        let items = sequence.to_list()?;
        let values = items
            .iter()
            .enumerate()
            .map(|(index, item)| one(&item, &format!("{place}.{index}"), depth + 1));
        return Ok(Value::Array(values.collect::<PyResult<_>>()?));
    }
    // Accept numbers of NumPy, and objects with a name, such as rods of a scene.
    if let Ok(number) = value.extract::<f64>() {
        return Ok(match value.call_method0("__index__") {
            Ok(index) => Value::Integer(index.extract()?),
            Err(_) => Value::Float(number),
        });
    }
    if let Ok(path) = value.call_method0("__fspath__") {
        return Ok(Value::String(path.extract()?));
    }
    Err(bad_argument(format!(
        "{place}: expected a number, a text, a list, an array or a dictionary, found {}",
        name_of_type(value)
    )))
}

/// Converts an array to nested lists of numbers, one level per dimension.
fn numbers(array: &Bound<'_, PyUntypedArray>, place: &str, depth: usize) -> PyResult<Value> {
    if array.ndim() == 0 || array.dtype().kind() != b'f' {
        // Convert other arrays through their Python values.
        return one(&array.call_method0("tolist")?, place, depth + 1);
    }
    let floats = array.call_method1("astype", ("float64",))?;
    let floats: PyReadonlyArrayDyn<'_, f64> = floats.extract()?;
    Ok(nested(floats.as_array()))
}

fn nested(array: numpy::ndarray::ArrayViewD<'_, f64>) -> Value {
    if array.ndim() == 1 {
        return Value::Array(array.iter().map(|number| Value::Float(*number)).collect());
    }
    Value::Array(array.outer_iter().map(nested).collect())
}

fn name_of_type(value: &Bound<'_, PyAny>) -> String {
    let name = value.get_type().name();
    name.map_or_else(|_| "another object".to_owned(), |name| name.to_string())
}

/// Creates a dictionary from pairs.
pub fn dictionary<'py, V: IntoPyObject<'py>>(
    py: Python<'py>,
    pairs: impl IntoIterator<Item = (&'static str, V)>,
) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for (name, value) in pairs {
        dictionary.set_item(name, value)?;
    }
    Ok(dictionary)
}
