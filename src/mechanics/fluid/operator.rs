//! The collocation matrix of all filaments: velocities of nodes from force densities at nodes.

use super::Filament;
use super::instruction_set::{InstructionSet, LANES};
use super::lanes::{
    BlockLanes, SegmentLanes, VectorLanes, assemble_row, multiply_row, multiply_row_by_three,
};
use super::segment::{Segment, full};
use crate::mechanics::{Matrix3, Vector3};
use rayon::prelude::*;
use std::ops::Range;

/// Nodes from which the work is shared among threads. Sharing out costs some ten microseconds, as much
/// as a whole product of 136 nodes.
pub(super) const PARALLEL_FROM: usize = 256;
/// Rows that a thread takes at a time.
const ROWS_PER_TASK: usize = 32;

/// The matrix A of 8πη u(x_i) = Σ_j A_ij f_j (thesis Eq. 2.25 and 2.27, all segments of all filaments).
///
/// f is the force per length on the fluid at the nodes, N/m, linear in between; A_ij is a symmetric
/// 3×3 block without dimension, but A as a whole is not symmetric. Vectors hold three numbers per node.
/// A block is stored as its upper triangle: 48 bytes per pair of nodes, 22 MB for 680 nodes.
///
/// # Slots
/// The columns are slots: one per node, and for a closed filament one more that repeats its first node,
/// so that segment j always runs from slot j to slot j + 1. The last slot of a filament starts a segment
/// without length, which moves nothing. Slots are stored in chunks of eight lanes: all that fit in the
/// first lanes of the chunks, then in the second and so on, so that the neighbour of a slot is in the
/// same lane of the next chunk.
pub(super) struct FlowOperator {
    set: InstructionSet,
    filaments: Vec<SlotRange>,
    /// Node of each slot.
    slots: Vec<usize>,
    columns: Vec<Column>,
    points: Vec<[f64; 3]>,
    segments: Vec<SegmentLanes>,
    /// Row after row.
    blocks: Vec<BlockLanes>,
    /// The vectors to be multiplied, by slots.
    vectors: [Vec<VectorLanes>; 3],
}

/// The slots of a filament.
struct SlotRange {
    slots: Range<usize>,
    regularization_squared: f64,
}

/// Where the column of a node is stored; it is the sum of both slots.
struct Column {
    slot: usize,
    /// The last slot of a closed filament, for its first node.
    repeated: Option<usize>,
}

impl FlowOperator {
    /// Lays out the operator of filaments whose nodes are numbered one filament after the other;
    /// ε is `regularization` times each filament's radius.
    pub fn new(filaments: &[Filament], regularization: f64) -> Self {
        Self::with_instruction_set(filaments, regularization, InstructionSet::best())
    }

    pub(super) fn with_instruction_set(
        filaments: &[Filament],
        regularization: f64,
        set: InstructionSet,
    ) -> Self {
        let mut slots = Vec::new();
        let mut columns = Vec::new();
        let mut ranges = Vec::new();
        for filament in filaments {
            let (first_slot, first_node) = (slots.len(), columns.len());
            for node in first_node..first_node + filament.nodes {
                columns.push(Column {
                    slot: slots.len(),
                    repeated: None,
                });
                slots.push(node);
            }
            if filament.closed {
                columns[first_node].repeated = Some(slots.len());
                slots.push(first_node);
            }
            ranges.push(SlotRange {
                slots: first_slot..slots.len(),
                regularization_squared: {
                    let epsilon = regularization * filament.radius;
                    epsilon * epsilon
                },
            });
        }
        let (nodes, chunks) = (columns.len(), slots.len().div_ceil(LANES));
        // Lanes after the last slot hold segments without length, which move nothing.
        let void = Segment::new(&Vector3::zeros(), &Vector3::zeros(), 1.0);
        let mut segments = vec![SegmentLanes::default(); chunks];
        for slot in slots.len()..chunks * LANES {
            segments[slot % chunks].set(slot / chunks, &void);
        }
        Self {
            set,
            filaments: ranges,
            slots,
            columns,
            points: vec![[0.0; 3]; nodes],
            segments,
            blocks: vec![BlockLanes::default(); nodes * chunks],
            vectors: std::array::from_fn(|_| vec![VectorLanes::default(); chunks]),
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.points.len()
    }

    /// Evaluates all blocks at new positions of the nodes, m.
    pub fn assemble(&mut self, positions: &[Vector3]) {
        for (point, x) in self.points.iter_mut().zip(positions) {
            *point = (*x).into();
        }
        let chunks = self.segments.len();
        for filament in &self.filaments {
            let last = filament.slots.end - 1;
            for slot in filament.slots.clone() {
                let start = &positions[self.slots[slot]];
                let end = &positions[self.slots[last.min(slot + 1)]];
                let segment = Segment::new(start, end, filament.regularization_squared);
                self.segments[slot % chunks].set(slot / chunks, &segment);
            }
        }
        let (set, segments) = (self.set, &self.segments);
        if self.nodes() < PARALLEL_FROM {
            for (&x, row) in self.points.iter().zip(self.blocks.chunks_exact_mut(chunks)) {
                assemble_row(set, x, segments, row);
            }
        } else {
            self.points
                .par_iter()
                .zip(self.blocks.par_chunks_exact_mut(chunks))
                .with_min_len(ROWS_PER_TASK)
                .for_each(|(&x, row)| assemble_row(set, x, segments, row));
        }
    }

    /// A_ij.
    pub fn block(&self, row: usize, column: usize) -> Matrix3 {
        let Column { slot, repeated } = self.columns[column];
        let mut block = self.stored(row, slot);
        if let Some(slot) = repeated {
            block += self.stored(row, slot);
        }
        block
    }

    fn stored(&self, row: usize, slot: usize) -> Matrix3 {
        let chunks = self.segments.len();
        full(&self.blocks[row * chunks + slot % chunks].get(slot / chunks))
    }

    /// `velocities` = A `densities`.
    pub fn multiply(&mut self, densities: &[f64], velocities: &mut [f64]) {
        spread(&self.slots, densities, &mut self.vectors[0]);
        let (set, vector) = (self.set, &self.vectors[0]);
        let chunks = self.segments.len();
        if self.points.len() < PARALLEL_FROM {
            let rows = self.blocks.chunks_exact(chunks);
            for (row, u) in rows.zip(velocities.chunks_exact_mut(3)) {
                u.copy_from_slice(&multiply_row(set, row, vector));
            }
        } else {
            self.blocks
                .par_chunks_exact(chunks)
                .zip(velocities.par_chunks_exact_mut(3))
                .with_min_len(ROWS_PER_TASK)
                .for_each(|(row, u)| u.copy_from_slice(&multiply_row(set, row, vector)));
        }
    }

    /// [`multiply`](Self::multiply) for three vectors, at little more than the price of one.
    pub fn multiply_three(&mut self, densities: &[Vec<f64>; 3], velocities: &mut [Vec<f64>; 3]) {
        for (density, vector) in densities.iter().zip(&mut self.vectors) {
            spread(&self.slots, density, vector);
        }
        let (set, vectors) = (self.set, &self.vectors);
        let chunks = self.segments.len();
        let [u, v, w] = velocities;
        if self.points.len() < PARALLEL_FROM {
            for (i, row) in self.blocks.chunks_exact(chunks).enumerate() {
                let products = multiply_row_by_three(set, row, vectors);
                for (velocity, product) in [&mut *u, &mut *v, &mut *w].into_iter().zip(products) {
                    velocity[3 * i..3 * i + 3].copy_from_slice(&product);
                }
            }
        } else {
            self.blocks
                .par_chunks_exact(chunks)
                .zip(u.par_chunks_exact_mut(3))
                .zip(v.par_chunks_exact_mut(3))
                .zip(w.par_chunks_exact_mut(3))
                .with_min_len(ROWS_PER_TASK)
                .for_each(|(((row, u), v), w)| {
                    let products = multiply_row_by_three(set, row, vectors);
                    for (velocity, product) in [u, v, w].into_iter().zip(products) {
                        velocity.copy_from_slice(&product);
                    }
                });
        }
    }
}

/// Puts a vector of nodes into the lanes of the slots.
fn spread(slots: &[usize], nodes: &[f64], lanes: &mut [VectorLanes]) {
    let chunks = lanes.len();
    for (slot, &node) in slots.iter().enumerate() {
        let vector = &mut lanes[slot % chunks].0;
        for k in 0..3 {
            vector[k][slot / chunks] = nodes[3 * node + k];
        }
    }
}
