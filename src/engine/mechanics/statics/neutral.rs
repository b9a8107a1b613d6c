//! Motions without stiffness: a ring that rolls through itself, a column that is bent in any
//! plane, a rod without supports.
//!
//! The energy is constant along them in any configuration. So forces have no component along them
//! except rounding errors, which the inverse of the Hessian would amplify without bound. They are
//! null vectors of the Hessian all along a path, unlike the null vector of a critical point.

use super::inner_product::{inner, normalise, scale_angles};
use crate::linalg::SingularMatrix;
use crate::mechanics::system::System;
use serde::{Deserialize, Serialize};

/// The null vectors of a Hessian.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct NeutralModes {
    /// B-orthonormal vectors, with B as in [`super::inner_product`].
    vectors: Vec<Vec<f64>>,
    /// Weight of the squares of angles in B, m².
    weight: f64,
}

impl NeutralModes {
    /// None as yet.
    pub(crate) fn new(weight: f64) -> Self {
        Self {
            vectors: Vec::new(),
            weight,
        }
    }

    /// Discards all of them.
    pub(crate) fn clear(&mut self) {
        self.vectors.clear();
    }

    /// Their number.
    pub(crate) fn count(&self) -> usize {
        self.vectors.len()
    }

    /// Updates them to the Hessian, whose factors `system` holds, by one inverse iteration.
    ///
    /// # Errors
    /// [`SingularMatrix`] if the system is singular to working precision.
    pub(crate) fn refine(&mut self, system: &mut System) -> Result<(), SingularMatrix> {
        for k in 0..self.vectors.len() {
            let (before, rest) = self.vectors.split_at_mut(k);
            let vector = &mut rest[0];
            scale_angles(vector, self.weight);
            system.solve(vector)?;
            remove(before, vector, self.weight);
            normalise(vector, self.weight);
        }
        Ok(())
    }

    /// Removes from `vector` its components along these motions.
    pub(crate) fn remove_from(&self, vector: &mut [f64]) {
        remove(&self.vectors, vector, self.weight);
    }

    /// Adds a B-orthonormal vector to these motions.
    pub(crate) fn push(&mut self, vector: Vec<f64>) {
        self.vectors.push(vector);
    }

    /// Weight of the squares of angles, m².
    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }
}

fn remove(vectors: &[Vec<f64>], from: &mut [f64], weight: f64) {
    for vector in vectors {
        let part = inner(vector, from, weight);
        for (entry, own) in from.iter_mut().zip(vector) {
            *entry -= part * own;
        }
    }
}
