//! Contacts as arrays.

use crate::arrays::{column, rows};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::ActiveContact;
use rodlab_engine::mechanics::dynamics::Simulation;

/// Pairs in contact at the last step, m of them.
#[pyclass(frozen, module = "rodlab._rodlab")]
pub struct Contacts {
    count: usize,
    /// Nodes of each pair, m × 4: ends of the first edge, then of the second.
    #[pyo3(get)]
    nodes: Py<PyArray2<i64>>,
    /// Places of the contacts, m × 3, m.
    #[pyo3(get)]
    points: Py<PyArray2<f64>>,
    /// Forces on the first of each pair, friction included, m × 3, N.
    #[pyo3(get)]
    forces: Py<PyArray2<f64>>,
    /// Unit vectors from the second body to the first, m × 3.
    #[pyo3(get)]
    normals: Py<PyArray2<f64>>,
    /// Distances of centrelines, m, m.
    #[pyo3(get)]
    distances: Py<PyArray1<f64>>,
}

impl Contacts {
    /// The contacts of a simulation.
    pub fn of(py: Python<'_>, simulation: &Simulation) -> Self {
        let contacts = simulation.contacts();
        let positions = simulation.positions();
        let nodes = contacts
            .iter()
            .flat_map(|contact| contact.nodes)
            .map(|node| node as i64);
        let nodes = Array2::from_shape_vec([contacts.len(), 4], nodes.collect());
        let nodes = nodes.expect("four nodes for each contact").into_pyarray(py);
        let of_each = |value: fn(&ActiveContact) -> Vector3| {
            let values: Vec<Vector3> = contacts.iter().map(value).collect();
            rows(py, &values).unbind()
        };
        let points: Vec<Vector3> = contacts.iter().map(|one| point(one, positions)).collect();
        let distances = contacts.iter().map(|contact| contact.distance).collect();
        Self {
            count: contacts.len(),
            nodes: nodes.unbind(),
            points: rows(py, &points).unbind(),
            forces: of_each(ActiveContact::force_on_first),
            normals: of_each(|contact| contact.normal.try_normalize(0.0).unwrap_or(contact.normal)),
            distances: column(py, distances).unbind(),
        }
    }
}

/// Point on the centreline of the first body at which the force acts: the mean of its nodes,
/// weighted with their forces along the normal.
fn point(contact: &ActiveContact, positions: &[Vector3]) -> Vector3 {
    let forces = contact
        .force
        .chunks_exact(3)
        .map(Vector3::from_column_slice);
    let own = contact
        .nodes
        .iter()
        .zip(forces)
        .take(contact.first_body.max(1));
    let (mut sum, mut weight) = (Vector3::zeros(), 0.0);
    for (node, force) in own {
        let share = force.dot(&contact.normal);
        sum += positions.get(*node).copied().unwrap_or_default() * share;
        weight += share;
    }
    match weight {
        0.0 => positions.get(contact.nodes[0]).copied().unwrap_or_default(),
        weight => sum / weight,
    }
}

#[pymethods]
impl Contacts {
    fn __len__(&self) -> usize {
        self.count
    }

    fn __repr__(&self) -> String {
        format!("<rodlab.Contacts: {}>", self.count)
    }
}
