//! The coarse level of the preconditioner: filaments in aggregates of constant force density.

use super::lanes::{SingleLanes, multiply_rows};
use super::operator::FlowOperator;
use super::points::Points;
use super::{Filament, FluidError};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes};
use nalgebra::{DMatrix, DVector};

/// Approximate number of points per aggregate. In the bundle of ten flagella, aggregates of 8 and
/// 17 nodes and none take 7.0, 7.7 and 11.6 iterations a solve; shorter aggregates cost more than
/// they save.
const NODES: usize = 17;

/// The best forces Q x that are constant on each aggregate: Q = Z (Zᵀ A Z)⁻¹ Zᵀ, where Z has a
/// column for each component of the force on each aggregate, with ones at its nodes.
pub(super) struct CoarseSpace {
    set: InstructionSet,
    /// First point of each aggregate, then the number of points.
    bounds: Vec<usize>,
    /// The aggregates to which the points of each station belong, and their weights.
    shares: Vec<[(usize, f64); 2]>,
    /// A Z, row by row, padded to whole lanes; the rows of the points come first.
    images: Vec<SingleLanes>,
    /// (Zᵀ A Z)⁻¹.
    inverse: DMatrix<f64>,
    /// Zᵀ x.
    sums: DVector<f64>,
    /// Q x by aggregates.
    forces: DVector<f64>,
    /// Q x by aggregates, padded to whole lanes.
    lanes: Vec<Lanes>,
}

impl CoarseSpace {
    /// Divides filaments, whose stations are numbered one filament after the other, into equal aggregates of points.
    pub(crate) fn new(filaments: &[Filament], points: &Points) -> Self {
        let mut bounds = vec![0];
        let (mut first, mut stations) = (0, 0);
        for filament in filaments {
            stations += filament.nodes;
            let own = points.representatives();
            let own = own.partition_point(|&station| station < stations) - first;
            let count = own.div_ceil(NODES);
            bounds.extend((1..=count).map(|k| first + k * own / count));
            first += own;
        }
        let unknowns = 3 * (bounds.len() - 1);
        let width = unknowns.div_ceil(LANES);
        Self {
            set: InstructionSet::best(),
            shares: vec![[(0, 0.0); 2]; stations],
            images: vec![SingleLanes::default(); 3 * stations * width],
            inverse: DMatrix::zeros(unknowns, unknowns),
            sums: DVector::zeros(unknowns),
            forces: DVector::zeros(unknowns),
            lanes: vec![Lanes::default(); width],
            bounds,
        }
    }

    /// Sets up the coarse level for an assembled operator.
    ///
    /// # Errors
    /// [`FluidError::Singular`] if Zᵀ A Z has no inverse.
    pub(crate) fn build(
        &mut self,
        operator: &FlowOperator,
        points: &Points,
    ) -> Result<(), FluidError> {
        let bounds = &self.bounds;
        let aggregate = |point: usize| bounds.partition_point(|first| *first <= point) - 1;
        for (station, shares) in self.shares.iter_mut().enumerate() {
            let of = points.shares(station);
            *shares = of.map(|share| (aggregate(share.point), share.weight));
        }
        let width = self.lanes.len();
        operator.sum_columns(bounds.len() - 1, &self.shares, &mut self.images);
        if !points.are_plain() {
            for (point, station) in points.representatives().iter().enumerate() {
                let rows = 3 * station * width..3 * (station + 1) * width;
                self.images.copy_within(rows, 3 * point * width);
            }
        }
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
    pub(crate) fn solve(&mut self, x: &[f64], rest: &mut [f64]) {
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
    pub(crate) fn add_forces(&self, y: &mut [f64]) {
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
