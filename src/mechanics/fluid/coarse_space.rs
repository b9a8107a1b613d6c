//! The coarse level of the preconditioner: filaments in aggregates of constant force density.

use super::lanes::{SingleLanes, multiply_rows};
use super::operator::FlowOperator;
use super::{Filament, FluidError};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes};
use nalgebra::{DMatrix, DVector};

/// Nodes of an aggregate, about. In the bundle of ten flagella aggregates of 8, 17 nodes and none take 7.0, 7.7 and 11.6
/// iterations a solve; shorter ones cost more than they save.
const NODES: usize = 17;

/// The best forces Q x that are constant along aggregates: Q = Z (Zᵀ A Z)⁻¹ Zᵀ, where Z has a column for each component
/// of the force on each aggregate, with ones at its nodes.
pub(super) struct CoarseSpace {
    set: InstructionSet,
    /// First node of each aggregate, and the number of nodes.
    bounds: Vec<usize>,
    /// A Z, row by row, padded to whole lanes.
    images: Vec<SingleLanes>,
    /// (Zᵀ A Z)⁻¹.
    inverse: DMatrix<f64>,
    /// Zᵀ x.
    sums: DVector<f64>,
    /// Q x by aggregates.
    forces: DVector<f64>,
    /// The same, padded to whole lanes.
    lanes: Vec<Lanes>,
}

impl CoarseSpace {
    /// Divides filaments, whose nodes are numbered one filament after the other, into equal aggregates.
    pub fn new(filaments: &[Filament]) -> Self {
        let mut bounds = vec![0];
        let mut first = 0;
        for filament in filaments {
            let count = filament.nodes.div_ceil(NODES);
            bounds.extend((1..=count).map(|k| first + k * filament.nodes / count));
            first += filament.nodes;
        }
        let unknowns = 3 * (bounds.len() - 1);
        let width = unknowns.div_ceil(LANES);
        Self {
            set: InstructionSet::best(),
            images: vec![SingleLanes::default(); 3 * first * width],
            inverse: DMatrix::zeros(unknowns, unknowns),
            sums: DVector::zeros(unknowns),
            forces: DVector::zeros(unknowns),
            lanes: vec![Lanes::default(); width],
            bounds,
        }
    }

    /// Takes over an assembled operator.
    ///
    /// # Errors
    /// [`FluidError::Singular`] where Zᵀ A Z has no inverse.
    pub fn build(&mut self, operator: &FlowOperator) -> Result<(), FluidError> {
        operator.sum_columns(&self.bounds, &mut self.images);
        let width = self.lanes.len();
        let mut system = DMatrix::zeros(self.inverse.nrows(), self.inverse.ncols());
        for (aggregate, nodes) in self.bounds.windows(2).enumerate() {
            for (k, row) in self.images[3 * nodes[0] * width..3 * nodes[1] * width]
                .chunks_exact(width)
                .enumerate()
            {
                let entries = row.as_flattened().iter();
                for (sum, entry) in system
                    .row_mut(3 * aggregate + k % 3)
                    .iter_mut()
                    .zip(entries)
                {
                    *sum += f64::from(*entry);
                }
            }
        }
        self.inverse = system.try_inverse().ok_or(FluidError::Singular)?;
        Ok(())
    }

    /// Solves for the forces of the aggregates; `rest` = x − A Q x.
    pub fn solve(&mut self, x: &[f64], rest: &mut [f64]) {
        for (aggregate, nodes) in self.bounds.windows(2).enumerate() {
            let mut sum = [0.0; 3];
            for x in x[3 * nodes[0]..3 * nodes[1]].chunks_exact(3) {
                for (sum, x) in sum.iter_mut().zip(x) {
                    *sum += x;
                }
            }
            self.sums.as_mut_slice()[3 * aggregate..3 * aggregate + 3].copy_from_slice(&sum);
        }
        self.forces.gemv(1.0, &self.inverse, &self.sums, 0.0);
        let lanes = self.lanes.as_flattened_mut();
        lanes[..self.forces.len()].copy_from_slice(self.forces.as_slice());
        multiply_rows(self.set, &self.images, &self.lanes, rest);
        for (rest, x) in rest.iter_mut().zip(x) {
            *rest = x - *rest;
        }
    }

    /// `y` += Q x of the last solution.
    pub fn add_forces(&self, y: &mut [f64]) {
        let forces = self.forces.as_slice().chunks_exact(3);
        for (nodes, force) in self.bounds.windows(2).zip(forces) {
            for y in y[3 * nodes[0]..3 * nodes[1]].chunks_exact_mut(3) {
                for (y, force) in y.iter_mut().zip(force) {
                    *y += force;
                }
            }
        }
    }
}
