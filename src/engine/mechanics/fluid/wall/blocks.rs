//! Contribution of a wall to the stored collocation matrix.

use super::FlowWall;
use super::image::{Image, cross};
use super::lanes::{AxialLanes, ImageLanes, Row, add_images, multiply_axial_row};
use crate::linalg::instruction_set::{InstructionSet, LANES};
use crate::mechanics::fluid::lanes::{BlockLanes, PARALLEL_FROM, VectorLanes};

use crate::mechanics::{Matrix3, Vector3};
use rayon::prelude::*;

/// Number of rows that a thread takes at a time.
const ROWS_PER_TASK: usize = 32;

/// The part of the operator that a wall adds, in the layout of the operator's own blocks.
///
/// The symmetric parts of the images are added to the operator's blocks; the antisymmetric parts are stored here, 12 bytes
/// per pair of nodes. Scenes without a wall have none of these blocks.
pub(in super::super) struct WallBlocks {
    wall: FlowWall,
    images: Vec<ImageLanes>,
    axial: Vec<AxialLanes>,
}

impl WallBlocks {
    /// Creates storage for an operator of so many nodes, with so many chunks of slots.
    pub(crate) fn new(wall: FlowWall, nodes: usize, chunks: usize) -> Self {
        let origin = Vector3::zeros();
        let void = Image::new(&origin, &origin, 1.0, &origin, &Vector3::z());
        let mut images = vec![ImageLanes::default(); chunks];
        for images in &mut images {
            (0..LANES).for_each(|lane| images.set(lane, &void));
        }
        Self {
            wall,
            images,
            axial: vec![AxialLanes::default(); nodes * chunks],
        }
    }

    /// Sets the segment that starts at a slot.
    pub(crate) fn set_segment(
        &mut self,
        slot: usize,
        start: &Vector3,
        end: &Vector3,
        regularization_squared: f64,
    ) {
        let chunks = self.images.len();
        let plane = self.wall.plane();
        let image = Image::new(
            start,
            end,
            regularization_squared,
            &plane.point,
            &plane.normal,
        );
        self.images[slot % chunks].set(slot / chunks, &image);
    }

    /// Adds the images to all rows. The row of a node in the wall becomes that of the identity, in
    /// the slot that `slot_of` returns, so that it takes no force.
    pub(crate) fn assemble(
        &mut self,
        set: InstructionSet,
        positions: &[Vector3],
        slot_of: impl Fn(usize) -> usize + Sync,
        blocks: &mut [BlockLanes],
    ) {
        let chunks = self.images.len();
        let (wall, images) = (&self.wall, &self.images);
        let plane = wall.plane();
        let fill = |node: usize, blocks: &mut [BlockLanes], axial: &mut [AxialLanes]| {
            let x = &positions[node];
            if wall.holds(node, x) {
                blocks.fill(BlockLanes::default());
                axial.fill(AxialLanes::default());
                let slot = slot_of(node);
                let block = &mut blocks[slot % chunks].0;
                for diagonal in [0, 3, 5] {
                    block[diagonal][slot / chunks] = 1.0;
                }
                return;
            }
            let row = Row {
                x: (*x).into(),
                height: plane.height(x),
                normal: plane.normal.into(),
            };
            add_images(set, row, images, blocks, axial);
        };
        if positions.len() < PARALLEL_FROM {
            (blocks.chunks_exact_mut(chunks))
                .zip(self.axial.chunks_exact_mut(chunks))
                .enumerate()
                .for_each(|(node, (blocks, axial))| fill(node, blocks, axial));
        } else {
            (blocks.par_chunks_exact_mut(chunks))
                .zip(self.axial.par_chunks_exact_mut(chunks))
                .enumerate()
                .with_min_len(ROWS_PER_TASK)
                .for_each(|(node, (blocks, axial))| fill(node, blocks, axial));
        }
    }

    /// The antisymmetric part of the block of a row and a slot.
    pub(crate) fn axial(&self, row: usize, slot: usize) -> Matrix3 {
        let chunks = self.images.len();
        let lanes = &self.axial[row * chunks + slot % chunks].0;
        cross(&lanes.each_ref().map(|w| f64::from(w[slot / chunks])))
    }

    /// Adds the product of the antisymmetric parts with a vector to `velocities`.
    pub(crate) fn add_product(
        &self,
        set: InstructionSet,
        vector: &[VectorLanes],
        velocities: &mut [f64],
    ) {
        let chunks = self.images.len();
        let add = |(row, u): (&[AxialLanes], &mut [f64])| {
            for (u, product) in u.iter_mut().zip(multiply_axial_row(set, row, vector)) {
                *u += product;
            }
        };
        if velocities.len() < 3 * PARALLEL_FROM {
            (self.axial.chunks_exact(chunks))
                .zip(velocities.chunks_exact_mut(3))
                .for_each(add);
        } else {
            (self.axial.par_chunks_exact(chunks))
                .zip(velocities.par_chunks_exact_mut(3))
                .with_min_len(ROWS_PER_TASK)
                .for_each(add);
        }
    }
}
