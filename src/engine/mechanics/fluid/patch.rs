//! A stored part of the collocation matrix: the rows of some nodes and the columns of others.

use super::chain::{Link, Slot, lay_out};
use super::lanes::{
    BlockLanes, SegmentLanes, VectorLanes, assemble_row, multiply_row, multiply_row_by_three,
};
use super::segment::{Segment, full};
use crate::linalg::instruction_set::{InstructionSet, LANES};
use crate::mechanics::{Matrix3, Vector3};

/// Blocks A_ij of some nodes i with some nodes j, 24 bytes each, plus a few for the neighbours of
/// the nodes j. Slots are stored in lanes as in [`FlowOperator`](super::FlowOperator).
#[derive(Default)]
pub(super) struct Patch {
    rows: Vec<usize>,
    slots: Vec<Slot>,
    segments: Vec<SegmentLanes>,
    blocks: Vec<BlockLanes>,
    vectors: [Vec<VectorLanes>; 3],
}

impl Patch {
    /// Evaluates the blocks of `rows` with `columns`; `columns` must be in ascending order.
    pub(crate) fn assemble(
        &mut self,
        set: InstructionSet,
        links: &[Link],
        positions: &[Vector3],
        rows: &[usize],
        columns: &[usize],
    ) {
        self.rows.clear();
        self.rows.extend_from_slice(rows);
        lay_out(links, columns, &mut self.slots);
        let chunks = self.slots.len().div_ceil(LANES);
        self.segments.resize(chunks, SegmentLanes::default());
        for place in 0..chunks * LANES {
            let segment = self.segment(place, links, positions);
            self.segments[place % chunks].set(place / chunks, &segment);
        }
        self.blocks
            .resize(rows.len() * chunks, BlockLanes::default());
        for (&row, blocks) in rows.iter().zip(self.blocks.chunks_exact_mut(chunks)) {
            assemble_row(set, positions[row].into(), &self.segments, blocks);
        }
        for vector in &mut self.vectors {
            vector.clear();
            vector.resize(chunks, VectorLanes::default());
        }
    }

    /// The segment that starts at a slot; if there is none, one without length, which has no flow.
    fn segment(&self, place: usize, links: &[Link], positions: &[Vector3]) -> Segment {
        match self.slots.get(place) {
            Some(slot) if slot.joined => Segment::new(
                &positions[slot.node],
                &positions[self.slots[place + 1].node],
                links[slot.node].regularization_squared,
            ),
            _ => Segment::new(&Vector3::zeros(), &Vector3::zeros(), 1.0),
        }
    }

    /// The slots of the columns, in order: the column index of [`block`](Self::block).
    pub(crate) fn columns(&self) -> impl Iterator<Item = usize> {
        (self.slots.iter().enumerate())
            .filter(|(_, slot)| slot.own)
            .map(|(place, _)| place)
    }

    /// The block A_ij for a row index and the slot of a column.
    pub(crate) fn block(&self, row: usize, slot: usize) -> Matrix3 {
        let chunks = self.segments.len();
        full(&self.blocks[row * chunks + slot % chunks].get(slot / chunks))
    }

    /// The block A_ij of two nodes; `None` if they have no row or no column.
    pub(crate) fn between(&self, row: usize, column: usize) -> Option<Matrix3> {
        let row = self.rows.iter().position(|&node| node == row)?;
        let slot = (self.slots.iter()).position(|slot| slot.own && slot.node == column)?;
        Some(self.block(row, slot))
    }

    /// Computes `velocities` += A `densities`; `velocities` are indexed by row, `densities` by
    /// node.
    pub(crate) fn add_product(
        &mut self,
        set: InstructionSet,
        densities: &[f64],
        velocities: &mut [[f64; 3]],
    ) {
        spread(&self.slots, densities, &mut self.vectors[0]);
        let rows = self.blocks.chunks_exact(self.segments.len());
        for (row, velocity) in rows.zip(velocities) {
            let product = multiply_row(set, row, &self.vectors[0]);
            for (u, product) in velocity.iter_mut().zip(product) {
                *u += product;
            }
        }
    }

    /// As [`add_product`](Self::add_product), for three vectors, at little more than the cost of
    /// one.
    pub(crate) fn add_three_products(
        &mut self,
        set: InstructionSet,
        densities: &[Vec<f64>; 3],
        velocities: &mut [Vec<[f64; 3]>; 3],
    ) {
        for (density, vector) in densities.iter().zip(&mut self.vectors) {
            spread(&self.slots, density, vector);
        }
        let rows = self.blocks.chunks_exact(self.segments.len());
        for (k, row) in rows.enumerate() {
            let products = multiply_row_by_three(set, row, &self.vectors);
            for (velocity, product) in velocities.iter_mut().zip(products) {
                for (u, product) in velocity[k].iter_mut().zip(product) {
                    *u += product;
                }
            }
        }
    }
}

/// Copies the densities of the nodes into the lanes of the slots.
fn spread(slots: &[Slot], densities: &[f64], lanes: &mut [VectorLanes]) {
    let chunks = lanes.len();
    for (place, slot) in slots.iter().enumerate() {
        if slot.own {
            let vector = &mut lanes[place % chunks].0;
            for k in 0..3 {
                vector[k][place / chunks] = densities[3 * slot.node + k];
            }
        }
    }
}
