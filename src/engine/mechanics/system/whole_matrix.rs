//! The Jacobian before unknowns are held.

use crate::linalg::{BandedSymmetric, Element, ElementMatrix, UNUSED};

/// A Jacobian with the rows of held unknowns, which give the change of the reactions.
pub(crate) struct WholeMatrix {
    pub(super) band: BandedSymmetric,
    pub(super) elements: Vec<(Element, ElementMatrix)>,
}

impl WholeMatrix {
    /// Product of the Jacobian with changes of all unknowns.
    pub(crate) fn multiply(&self, changes: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; changes.len()];
        self.band.multiply(changes, &mut product);
        for (element, matrix) in &self.elements {
            for (row, &k) in matrix.iter().zip(element).filter(|(_, k)| **k != UNUSED) {
                let entries = row.iter().zip(element).filter(|(_, k)| **k != UNUSED);
                let sum: f64 = entries.map(|(entry, &k)| entry * changes[k]).sum();
                product[k] += sum;
            }
        }
        product
    }
}
