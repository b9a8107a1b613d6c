//! The Jacobian before unknowns are held.

use crate::linalg::{BandedSymmetric, Element, ElementMatrix, SharedUnknown, UNUSED};

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

    /// The Jacobian over the free unknowns as a dense matrix: rows and columns of `shared` unknowns
    /// belong to their owners, and those that are `held` have unit diagonals.
    pub(super) fn to_dense(
        &self,
        held: &[bool],
        shared: &[SharedUnknown],
    ) -> nalgebra::DMatrix<f64> {
        let n = self.band.dimension();
        let mut owners: Vec<usize> = (0..n).collect();
        for one in shared {
            owners[one.unknown] = one.owner;
        }
        let gone = |k: usize| held[k] || owners[k] != k;
        let mut dense = nalgebra::DMatrix::zeros(n, n);
        for i in 0..n {
            for j in 0..n {
                let (a, b) = (owners[i], owners[j]);
                if !held[a] && !held[b] {
                    dense[(a, b)] += self.band.get(i, j);
                }
            }
        }
        for (element, matrix) in &self.elements {
            for i in 0..12 {
                for j in 0..12 {
                    let (a, b) = (element[i], element[j]);
                    if a == UNUSED || b == UNUSED {
                        continue;
                    }
                    let (a, b) = (owners[a], owners[b]);
                    if !held[a] && !held[b] {
                        dense[(a, b)] += matrix[i][j];
                    }
                }
            }
        }
        for k in (0..n).filter(|&k| gone(k)) {
            dense[(k, k)] = 1.0;
        }
        dense
    }
}
