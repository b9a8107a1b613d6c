//! Hessians of all copies, vertex by vertex and edge by edge: the band is filled in the order of
//! its elimination.

use super::super::edge_lanes::{self, SymmetricLanes};
use super::super::topology::STRIDE;
use super::super::vertex_lanes::HessianLanes;
use super::{RodCopies, Scratch};
use crate::linalg::HALF_BANDWIDTH;
use crate::linalg::instruction_set::{LANES, Lanes, kernel};

/// Columns of a band.
type Columns = [[Lanes; HALF_BANDWIDTH + 1]];

impl RodCopies {
    /// Clears the sums of the Hessians added so far.
    pub(crate) fn begin_hessians(&mut self) {
        self.spin_moments.fill([0.0; LANES]);
    }

    /// Adds the Hessians of a vertex at the last evaluation to `columns`, which are those of all
    /// unknowns.
    pub(crate) fn add_vertex(&mut self, vertex: usize, columns: &mut Columns) {
        let vertex = &self.vertices[vertex];
        let beside = vertex.edges.map(|edge| self.framed.of(edge).0);
        let Scratch { gradient, hessian } = &mut *self.scratch;
        (vertex.sections).derivatives(self.set, beside, gradient, hessian);
        for (edge, own) in vertex.edges.into_iter().zip([3, 7]) {
            for lane in 0..LANES {
                self.spin_moments[edge][lane] += gradient[own][lane];
            }
        }
        let (_, from, _) = vertex.unknowns;
        add_hessian(self.set, hessian, from, &mut columns[vertex.unknowns()]);
    }

    /// Adds the Hessians of an edge; those of the vertices next to it must have been added before.
    pub(crate) fn add_edge(&mut self, edge: usize, columns: &mut Columns) {
        let edge = &self.framed.real[edge];
        let [start, _] = edge.nodes;
        let moments = &self.spin_moments[start];
        let mut hessian = [[0.0; LANES]; 6];
        edge_lanes::hessians(self.set, &edge.lanes, moments, &mut hessian);
        let columns = columns[STRIDE * start..].first_chunk_mut();
        add_edge_hessian(self.set, &hessian, columns.expect("those of both nodes"));
    }
}

kernel! {
    /// Adds the Hessians of a vertex, from its local unknown `from` on, to their columns.
    fn add_hessian(hessians: &HessianLanes, from: usize, columns: &mut Columns) {
        let size = columns.len();
        for (j, column) in columns.iter_mut().enumerate() {
            let entries = column.iter_mut().zip(&hessians[from + j]);
            for (entry, own) in entries.take(size - j) {
                for lane in 0..LANES {
                    entry[lane] += own[lane];
                }
            }
        }
    }
}

kernel! {
    /// Adds the Hessians with respect to an edge vector to the columns of its two nodes.
    fn add_edge_hessian(hessian: &SymmetricLanes, columns: &mut [[Lanes; HALF_BANDWIDTH + 1]; STRIDE + 3]) {
        let rows = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];
        for j in 0..3 {
            for i in 0..3 {
                let own = &hessian[rows[i][j]];
                for lane in 0..LANES {
                    if i >= j {
                        columns[j][i - j][lane] += own[lane];
                        columns[STRIDE + j][i - j][lane] += own[lane];
                    }
                    columns[j][STRIDE + i - j][lane] -= own[lane];
                }
            }
        }
    }
}
