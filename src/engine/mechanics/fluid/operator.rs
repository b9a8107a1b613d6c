//! The collocation matrix of all filaments: velocities of nodes from force densities at nodes.

use super::Filament;
use super::lanes::{
    BlockLanes, PARALLEL_FROM, SegmentLanes, SingleLanes, VectorLanes, assemble_row, multiply_row,
    multiply_row_by_three,
};
use super::segment::{Segment, full};
use super::wall::{FlowWall, WallBlocks};
use crate::linalg::instruction_set::{InstructionSet, LANES};
use crate::mechanics::{Matrix3, Vector3};
use rayon::prelude::*;
use std::ops::Range;

/// Number of rows that a thread takes at a time.
const ROWS_PER_TASK: usize = 32;

/// The matrix A of 8πη u(x_i) = Σ_j A_ij f_j (thesis Eq. 2.25 and 2.27, all segments of all filaments).
///
/// f is the force per length on the fluid at the nodes, N/m, linear in between. A_ij is a
/// dimensionless symmetric 3×3 block, but A as a whole is not symmetric. Vectors hold three
/// numbers per node. A block is stored as its upper triangle in single precision: 24 bytes per
/// pair of nodes, 11 MB for 680 nodes.
///
/// # Slots
/// The columns are slots: one per node and, for a closed filament, one more that repeats its first
/// node. So segment j always runs from slot j to slot j + 1. The last slot of a filament starts a
/// segment without length, which has no flow. Slots are stored in chunks of eight lanes. They fill
/// the first lanes of all chunks, then the second lanes and so on, so that the next slot is in the
/// same lane of the next chunk.
pub struct FlowOperator {
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
    /// Contribution of a wall.
    wall: Option<WallBlocks>,
}

/// The slots of a filament.
struct SlotRange {
    slots: Range<usize>,
    regularization_squared: f64,
}

/// Slots of the column of a node; the column is the sum over them.
struct Column {
    slot: usize,
    /// For the first node of a closed filament, the last slot, which repeats it.
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
        // Lanes after the last slot hold segments without length, which have no flow.
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
            wall: None,
        }
    }

    /// Lays out the operator beside a wall; its blocks include the images of segments.
    pub(super) fn beside_wall(filaments: &[Filament], regularization: f64, wall: FlowWall) -> Self {
        let operator = Self::new(filaments, regularization);
        let blocks = WallBlocks::new(wall, operator.nodes(), operator.segments.len());
        Self {
            wall: Some(blocks),
            ..operator
        }
    }

    /// Whether there is a wall.
    pub(super) fn has_wall(&self) -> bool {
        self.wall.is_some()
    }

    /// Number of nodes.
    pub(crate) fn nodes(&self) -> usize {
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
                if let Some(wall) = &mut self.wall {
                    wall.set_segment(slot, start, end, filament.regularization_squared);
                }
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
        if let Some(wall) = &mut self.wall {
            let slot_of = |node: usize| self.columns[node].slot;
            wall.assemble(set, positions, slot_of, &mut self.blocks);
        }
    }

    /// A_ij.
    pub(crate) fn block(&self, row: usize, column: usize) -> Matrix3 {
        let Column { slot, repeated } = self.columns[column];
        let mut block = self.stored(row, slot);
        if let Some(slot) = repeated {
            block += self.stored(row, slot);
        }
        block
    }

    fn stored(&self, row: usize, slot: usize) -> Matrix3 {
        let chunks = self.segments.len();
        let block = full(&self.blocks[row * chunks + slot % chunks].get(slot / chunks));
        match &self.wall {
            Some(wall) => block + wall.axial(row, slot),
            None => block,
        }
    }

    /// Computes `count` weighted sums of columns: `shares` lists for each node the sums to which
    /// it contributes, with the weights. Three rows per node and three columns per sum; rows are
    /// padded to whole lanes.
    pub(super) fn sum_columns(
        &self,
        count: usize,
        shares: &[[(usize, f64); 2]],
        sums: &mut [SingleLanes],
    ) {
        let chunks = self.segments.len();
        let width = (3 * count).div_ceil(LANES);
        type Row<'a> = (usize, (&'a [BlockLanes], &'a mut [SingleLanes]));
        let sum_row = |totals: &mut Vec<Matrix3>, (row, (blocks, sums)): Row| {
            totals.clear();
            totals.resize(count, Matrix3::zeros());
            for (slot, &node) in self.slots.iter().enumerate() {
                for (sum, weight) in shares[node].into_iter().filter(|share| share.1 != 0.0) {
                    totals[sum] += full(&blocks[slot % chunks].get(slot / chunks)) * weight;
                    if let Some(wall) = &self.wall {
                        totals[sum] += wall.axial(row, slot) * weight;
                    }
                }
            }
            for (axis, row) in sums.chunks_exact_mut(width).enumerate() {
                let row: &mut [f32] = row.as_flattened_mut();
                for (sum, total) in totals.iter().enumerate() {
                    for column in 0..3 {
                        row[3 * sum + column] = total[(axis, column)] as f32;
                    }
                }
            }
        };
        (self.blocks.par_chunks_exact(chunks))
            .zip(sums.par_chunks_exact_mut(3 * width))
            .enumerate()
            .with_min_len(ROWS_PER_TASK)
            .for_each_init(Vec::new, sum_row);
    }

    /// Computes `velocities` = A `densities`.
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
        if let Some(wall) = &self.wall {
            wall.add_product(set, vector, velocities);
        }
    }

    /// As [`multiply`](Self::multiply), for three vectors, at little more than the cost of one.
    pub(super) fn multiply_three(
        &mut self,
        densities: &[Vec<f64>; 3],
        velocities: &mut [Vec<f64>; 3],
    ) {
        for (density, vector) in densities.iter().zip(&mut self.vectors) {
            spread(&self.slots, density, vector);
        }
        let (set, vectors) = (self.set, &self.vectors);
        let chunks = self.segments.len();
        let [u, v, w] = &mut *velocities;
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
        if let Some(wall) = &self.wall {
            for (vector, velocities) in self.vectors.iter().zip(velocities) {
                wall.add_product(set, vector, velocities);
            }
        }
    }
}

/// Copies a vector of nodes into the lanes of the slots.
fn spread(slots: &[usize], nodes: &[f64], lanes: &mut [VectorLanes]) {
    let chunks = lanes.len();
    for (slot, &node) in slots.iter().enumerate() {
        let vector = &mut lanes[slot % chunks].0;
        for k in 0..3 {
            vector[k][slot / chunks] = nodes[3 * node + k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::segment_integral;
    use super::*;

    /// A spiral and a ring of different radii; 37 slots, so that the last lanes are partly empty.
    fn scene() -> (Vec<Filament>, Vec<Vector3>) {
        let filament = |first_node, nodes, closed, radius| Filament {
            first_node,
            nodes,
            closed,
            radius,
        };
        let filaments = vec![filament(0, 21, false, 1e-3), filament(21, 15, true, 2e-3)];
        let point = |i: usize| {
            let angle = 0.42 * i as f64;
            let height = if i < 21 { 3e-3 * i as f64 } else { 0.05 };
            Vector3::new(0.03 * angle.cos(), 0.02 * angle.sin(), height)
        };
        (filaments, (0..36).map(point).collect())
    }

    #[test]
    fn blocks_are_sums_of_segment_integrals() {
        let (filaments, positions) = scene();
        let mut operator = FlowOperator::new(&filaments, 1.02);
        operator.assemble(&positions);
        for row in 0..36 {
            for column in 0..36 {
                let mut expected = Matrix3::zeros();
                for filament in &filaments {
                    for edge in 0..filament.edges() {
                        let ends = [edge, (edge + 1) % filament.nodes];
                        let [start, end] = ends.map(|k| filament.first_node + k);
                        let a = segment_integral(
                            &positions[row],
                            &positions[start],
                            &positions[end],
                            1.02 * filament.radius,
                        );
                        for (node, a) in [start, end].into_iter().zip(&a) {
                            if node == column {
                                expected += a;
                            }
                        }
                    }
                }
                let error = (operator.block(row, column) - expected).norm();
                let rounding = f64::from(f32::EPSILON) * expected.norm();
                assert!(error < rounding, "{row} {column}");
            }
        }
    }

    #[test]
    fn sums_of_columns_agree_with_blocks() {
        let (filaments, positions) = scene();
        let mut operator = FlowOperator::new(&filaments, 1.02);
        operator.assemble(&positions);
        let bounds = [0, 10, 21, 36];
        // The last node of the first run is also in the second.
        let shares: Vec<[(usize, f64); 2]> = (0..36)
            .map(
                |node| match bounds.partition_point(|first| *first <= node) - 1 {
                    0 if node == 9 => [(0, 0.25), (1, 0.75)],
                    run => [(run, 1.0), (0, 0.0)],
                },
            )
            .collect();
        let mut sums = vec![SingleLanes::default(); 3 * 36 * 2];
        operator.sum_columns(3, &shares, &mut sums);
        for row in 0..36 {
            for run in 0..3 {
                let weight = |column: usize| -> f64 {
                    let own = shares[column].iter().filter(|share| share.0 == run);
                    own.map(|share| share.1).sum()
                };
                let expected: Matrix3 = (0..36)
                    .map(|column| operator.block(row, column) * weight(column))
                    .sum();
                let found = Matrix3::from_fn(|r, c| {
                    let entries = sums[2 * (3 * row + r)..].as_flattened();
                    f64::from(entries[3 * run + c])
                });
                let rounding = f64::from(f32::EPSILON) * expected.norm();
                assert!((found - expected).norm() < rounding, "{row} {run}");
            }
        }
    }

    #[test]
    fn products_agree_with_blocks() {
        let (filaments, positions) = scene();
        let mut operator = FlowOperator::new(&filaments, 1.02);
        operator.assemble(&positions);
        let densities: [Vec<f64>; 3] = std::array::from_fn(|k| {
            (0..108)
                .map(|i| ((k + 2) as f64 * i as f64).sin())
                .collect()
        });
        let mut products = [(); 3].map(|()| vec![0.0; 108]);
        operator.multiply_three(&densities, &mut products);
        for (density, product) in densities.iter().zip(&products) {
            for row in 0..36 {
                let expected: Vector3 = (0..36)
                    .map(|column| {
                        operator.block(row, column)
                            * Vector3::from_column_slice(&density[3 * column..][..3])
                    })
                    .sum();
                let got = Vector3::from_column_slice(&product[3 * row..][..3]);
                assert!((got - expected).norm() < 1e-14);
            }
            let mut single = vec![0.0; 108];
            operator.multiply(density, &mut single);
            assert_eq!(&single, product);
        }
    }

    #[test]
    fn all_instruction_sets_give_the_same_bytes() {
        let (filaments, positions) = scene();
        let densities: Vec<f64> = (0..108).map(|i| (i as f64).sin()).collect();
        let results: Vec<Vec<f64>> = InstructionSet::available()
            .map(|set| {
                let mut operator = FlowOperator::with_instruction_set(&filaments, 1.02, set);
                operator.assemble(&positions);
                let mut velocities = vec![0.0; 108];
                operator.multiply(&densities, &mut velocities);
                velocities
            })
            .collect();
        for result in &results[1..] {
            assert_eq!(&results[0], result);
        }
    }
}
