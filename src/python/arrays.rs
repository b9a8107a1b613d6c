//! Arrays of NumPy from vectors, and vectors from arrays whose shapes are checked.

use crate::errors::bad_argument;
use numpy::ndarray::{Array2, Array3};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use rodlab_engine::mechanics::Vector3;

/// Creates an array n × 3.
pub fn rows<'py>(py: Python<'py>, vectors: &[Vector3]) -> Bound<'py, PyArray2<f64>> {
    let flat = vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    table(py, [vectors.len(), 3], flat)
}

/// Creates an array with two dimensions from its elements, row by row.
pub fn table<'py>(py: Python<'py>, shape: [usize; 2], flat: Vec<f64>) -> Bound<'py, PyArray2<f64>> {
    let array = Array2::from_shape_vec(shape, flat).expect("one element for each place");
    array.into_pyarray(py)
}

/// Creates an array with three dimensions from its elements, row by row.
pub fn cube<'py>(py: Python<'py>, shape: [usize; 3], flat: Vec<f64>) -> Bound<'py, PyArray3<f64>> {
    let array = Array3::from_shape_vec(shape, flat).expect("one element for each place");
    array.into_pyarray(py)
}

/// An array with one dimension.
pub fn column(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    values.into_pyarray(py)
}

/// The number of the matching shape in `shapes` and the elements of an array-like object, row by
/// row; all must be finite.
///
/// # Errors
/// A message with the name of the argument and the expected shapes.
pub fn elements(
    py: Python<'_>,
    name: &str,
    like: &Bound<'_, PyAny>,
    shapes: &[&[usize]],
) -> PyResult<(usize, Vec<f64>)> {
    let expected = || {
        let shapes = shapes.iter().map(|shape| in_words(shape));
        shapes.collect::<Vec<_>>().join(" or ")
    };
    let wrong = |found: &str| {
        bad_argument(format!(
            "{name}: expected an array of numbers of shape {}, found {found}",
            expected()
        ))
    };
    let numpy = py.import("numpy")?;
    let array = numpy.call_method1("asarray", (like, "float64"));
    let array = array.map_err(|error| wrong(&error.value(py).to_string()))?;
    let array: PyReadonlyArrayDyn<'_, f64> = array.extract()?;
    let found = array.shape();
    let Some(which) = shapes.iter().position(|shape| *shape == found) else {
        return Err(wrong(&format!("shape {}", in_words(found))));
    };
    let elements: Vec<f64> = array.as_array().iter().copied().collect();
    if let Some(place) = elements.iter().position(|element| !element.is_finite()) {
        let element = elements[place];
        return Err(bad_argument(format!(
            "{name}: element {place} is {element}; allowed: finite numbers"
        )));
    }
    Ok((which, elements))
}

fn in_words(shape: &[usize]) -> String {
    let parts: Vec<String> = shape.iter().map(ToString::to_string).collect();
    match parts.as_slice() {
        [] => "()".to_owned(),
        [one] => format!("({one},)"),
        many => format!("({})", many.join(", ")),
    }
}

/// An array that a program writes to and a simulation reads before each step.
pub struct Written {
    name: &'static str,
    shape: Vec<usize>,
    /// The array; created at its first use.
    array: Option<Py<PyAny>>,
    /// Elements at the last read.
    read: Vec<f64>,
}

impl Written {
    /// Creates an array with a shape, filled with zeros.
    pub fn new(name: &'static str, shape: &[usize]) -> Self {
        Self {
            name,
            shape: shape.to_vec(),
            array: None,
            read: vec![0.0; shape.iter().product()],
        }
    }

    /// The array.
    pub fn array(&mut self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        if self.array.is_none() {
            let shape = self.shape.clone();
            let flat = numpy::ndarray::ArrayD::from_shape_vec(shape, self.read.clone());
            let flat = flat.expect("one element for each place").into_pyarray(py);
            self.array = Some(flat.into_any().unbind());
        }
        let array = self.array.as_ref().expect("made above");
        Ok(array.clone_ref(py))
    }

    /// Writes all elements; numbers and rows are repeated (broadcast) as in NumPy.
    pub fn assign(&mut self, py: Python<'_>, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let array = self.array(py)?;
        let assigned = array.bind(py).set_item(py.Ellipsis(), values);
        assigned.map_err(|error| bad_argument(format!("{}: {}", self.name, error.value(py))))
    }

    /// Reads the elements; returns them if they differ from the last read.
    pub fn changed(&mut self, py: Python<'_>) -> PyResult<Option<&[f64]>> {
        let Some(array) = &self.array else {
            return Ok(None);
        };
        let array: PyReadonlyArrayDyn<'_, f64> = array.bind(py).extract()?;
        let view = array.as_array();
        if view.iter().eq(&self.read) {
            return Ok(None);
        }
        if let Some(place) = view.iter().position(|element| !element.is_finite()) {
            let row = place / self.shape.last().unwrap_or(&1).max(&1);
            return Err(bad_argument(format!(
                "{}: row {row} has a number that is not finite",
                self.name
            )));
        }
        self.read.clear();
        self.read.extend(view.iter());
        Ok(Some(&self.read))
    }

    /// Elements at the last read.
    pub fn last_read(&self) -> &[f64] {
        &self.read
    }

    /// Restores the elements of another state, also in the array that the program holds.
    pub fn put_back(&mut self, py: Python<'_>, elements: &[f64]) -> PyResult<()> {
        self.read.copy_from_slice(elements);
        if let Some(array) = self.array.take() {
            let shape = self.shape.clone();
            let flat = numpy::ndarray::ArrayD::from_shape_vec(shape, self.read.clone());
            let flat = flat.expect("one element for each place").into_pyarray(py);
            array.bind(py).set_item(py.Ellipsis(), flat)?;
            self.array = Some(array);
        }
        Ok(())
    }
}

/// Rows of three numbers as vectors.
pub fn vectors(flat: &[f64]) -> Vec<Vector3> {
    flat.chunks_exact(3)
        .map(Vector3::from_column_slice)
        .collect()
}

/// Copies vectors into an existing array n × 3.
pub fn copy_rows(array: &Bound<'_, PyArray2<f64>>, vectors: &[Vector3]) -> PyResult<()> {
    let shape = [vectors.len(), 3];
    if array.shape() != shape {
        return Err(bad_argument(format!(
            "out: expected shape {}, found {}",
            in_words(&shape),
            in_words(array.shape())
        )));
    }
    let writable = array.try_readwrite();
    let mut writable = writable.map_err(|error| bad_argument(format!("out: {error}")))?;
    let mut view = writable.as_array_mut();
    for (mut row, vector) in view.outer_iter_mut().zip(vectors) {
        for (element, value) in row.iter_mut().zip(vector.iter()) {
            *element = *value;
        }
    }
    Ok(())
}
