//! The segment kernel and the matrix–vector product over eight nodes at a time.

use super::segment::{Offset, Segment, Symmetric, combine};
use crate::linalg::instruction_set::{LANES, Lanes, kernel};

/// Number of chunks of eight lanes that go through one stage of the segment kernel before the next
/// stage begins. A whole pair is one dependent chain of some 150 cycles; stages keep several of
/// them in flight. Without stages assembly takes 1.7 times as long; with eight chunks the
/// compiler's code for AVX-512 takes twice as long.
const TILE: usize = 4;

/// Number of nodes from which the work is shared among threads. Sharing costs some ten
/// microseconds, as much as a whole product of 136 nodes.
pub(super) const PARALLEL_FROM: usize = 256;

/// Eight numbers in single precision. They take half the time to read, which is most of the time
/// of products. All sums are in double precision.
pub(super) type SingleLanes = [f32; LANES];

/// Eight segments, structure of arrays; meaning and units as in [`Segment`].
#[derive(Clone, Default)]
#[repr(align(64))]
pub(super) struct SegmentLanes {
    start: [Lanes; 3],
    tangent: [Lanes; 3],
    length: Lanes,
    inverse_length: Lanes,
    regularization_squared: Lanes,
}

impl SegmentLanes {
    /// Puts a segment into a lane.
    pub(crate) fn set(&mut self, lane: usize, segment: &Segment) {
        for k in 0..3 {
            self.start[k][lane] = segment.start[k];
            self.tangent[k][lane] = segment.tangent[k];
        }
        self.length[lane] = segment.length;
        self.inverse_length[lane] = segment.inverse_length;
        self.regularization_squared[lane] = segment.regularization_squared;
    }

    /// The segment in a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Segment {
        // Written out: with `map` over the arrays, the loop over lanes does not vectorise.
        let (start, tangent) = (&self.start, &self.tangent);
        Segment {
            start: [start[0][lane], start[1][lane], start[2][lane]],
            tangent: [tangent[0][lane], tangent[1][lane], tangent[2][lane]],
            length: self.length[lane],
            inverse_length: self.inverse_length[lane],
            regularization_squared: self.regularization_squared[lane],
        }
    }
}

/// Eight symmetric 3×3 blocks of a row of the operator, structure of arrays in the order of
/// [`Symmetric`]. Rounding to single precision changes each by at most 6e-8 (those of a row's
/// first chunk by twice that), while solves leave errors of 1e-6 in the velocities.
#[derive(Clone, Default)]
#[repr(align(64))]
pub(super) struct BlockLanes(pub [SingleLanes; 6]);

impl BlockLanes {
    /// The block in a lane.
    pub(crate) fn get(&self, lane: usize) -> Symmetric {
        self.0.map(|component| f64::from(component[lane]))
    }
}

/// Eight vectors, structure of arrays.
#[derive(Clone, Default)]
#[repr(align(64))]
pub(super) struct VectorLanes(pub [Lanes; 3]);

/// [`Offset`]s of eight segments.
#[derive(Clone, Copy, Default)]
pub(super) struct OffsetLanes {
    a: Lanes,
    p: [Lanes; 3],
    rho2: Lanes,
    r0: Lanes,
    r1: Lanes,
}

impl OffsetLanes {
    /// Puts an offset into a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, offset: &Offset) {
        self.a[lane] = offset.a;
        for k in 0..3 {
            self.p[k][lane] = offset.p[k];
        }
        self.rho2[lane] = offset.rho2;
        self.r0[lane] = offset.r0;
        self.r1[lane] = offset.r1;
    }

    /// The offset in a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Offset {
        Offset {
            a: self.a[lane],
            p: [self.p[0][lane], self.p[1][lane], self.p[2][lane]],
            rho2: self.rho2[lane],
            r0: self.r0[lane],
            r1: self.r1[lane],
        }
    }
}

/// [`Segment::moments`] of eight segments.
type MomentLanes = [[Lanes; 4]; 2];

kernel! {
    /// Evaluates the blocks of the evaluation point `x` with all slots. A slot gets A₁ of the
    /// segment that starts there and A₂ of the segment that ends there. The latter is in the same
    /// lane of the previous chunk; for the first chunk it is in the previous lane of the last
    /// chunk.
    fn assemble_row(x: [f64; 3], segments: &[SegmentLanes], blocks: &mut [BlockLanes]) {
        let mut ending = [[0.0; LANES]; 6];
        let mut offsets = [OffsetLanes::default(); TILE];
        let mut moments: [MomentLanes; TILE] = [[[[0.0; LANES]; 4]; 2]; TILE];
        for (segments, blocks) in segments.chunks(TILE).zip(blocks.chunks_mut(TILE)) {
            for (segments, offsets) in segments.iter().zip(&mut offsets) {
                for lane in 0..LANES {
                    offsets.set(lane, &segments.get(lane).offset(x));
                }
            }
            for ((segments, offsets), moments) in segments.iter().zip(&offsets).zip(&mut moments) {
                for lane in 0..LANES {
                    let [first, second] = segments.get(lane).moments(&offsets.get(lane));
                    for k in 0..4 {
                        moments[0][k][lane] = first[k];
                        moments[1][k][lane] = second[k];
                    }
                }
            }
            for (((segments, offsets), moments), blocks) in
                segments.iter().zip(&offsets).zip(&moments).zip(blocks)
            {
                let mut second = [[0.0; LANES]; 6];
                for lane in 0..LANES {
                    let tangent = segments.get(lane).tangent;
                    let p = offsets.get(lane).p;
                    let [m1, m2] = moments;
                    let m1 = [m1[0][lane], m1[1][lane], m1[2][lane], m1[3][lane]];
                    let m2 = [m2[0][lane], m2[1][lane], m2[2][lane], m2[3][lane]];
                    let a1 = combine(&m1, &p, &tangent);
                    let a2 = combine(&m2, &p, &tangent);
                    for c in 0..6 {
                        blocks.0[c][lane] = (a1[c] + ending[c][lane]) as f32;
                        second[c][lane] = a2[c];
                    }
                }
                ending = second;
            }
        }
        for c in 0..6 {
            for lane in 1..LANES {
                blocks[0].0[c][lane] =
                    (f64::from(blocks[0].0[c][lane]) + ending[c][lane - 1]) as f32;
            }
        }
    }
}

kernel! {
    /// Σ_j B_j f_j over the blocks of a row.
    fn multiply_row(blocks: &[BlockLanes], vectors: &[VectorLanes]) -> [f64; 3] {
        let mut sum = [[0.0; LANES]; 3];
        for (block, vector) in blocks.iter().zip(vectors) {
            accumulate(block, vector, &mut sum);
        }
        add_lanes(&sum)
    }
}

kernel! {
    /// As [`multiply_row`], for three vectors at once; the row is read only once.
    fn multiply_row_by_three(
        blocks: &[BlockLanes],
        vectors: &[Vec<VectorLanes>; 3],
    ) -> [[f64; 3]; 3] {
        let [f, g, h] = vectors;
        let mut sums = [[[0.0; LANES]; 3]; 3];
        for (((block, f), g), h) in blocks.iter().zip(f).zip(g).zip(h) {
            accumulate(block, f, &mut sums[0]);
            accumulate(block, g, &mut sums[1]);
            accumulate(block, h, &mut sums[2]);
        }
        [add_lanes(&sums[0]), add_lanes(&sums[1]), add_lanes(&sums[2])]
    }
}

kernel! {
    /// Products of `x` with rows of its width.
    fn multiply_rows(rows: &[SingleLanes], x: &[Lanes], y: &mut [f64]) {
        for (row, y) in rows.chunks_exact(x.len()).zip(y) {
            let mut sums = [0.0; LANES];
            for (a, x) in row.iter().zip(x) {
                for lane in 0..LANES {
                    sums[lane] = f64::from(a[lane]).mul_add(x[lane], sums[lane]);
                }
            }
            *y = sums.iter().sum();
        }
    }
}

/// Adds the products of eight blocks with eight vectors to their sums.
#[inline(always)]
fn accumulate(block: &BlockLanes, vector: &VectorLanes, sum: &mut [Lanes; 3]) {
    let [xx, xy, xz, yy, yz, zz] = &block.0;
    add_products([xx, xy, xz], &vector.0, &mut sum[0]);
    add_products([xy, yy, yz], &vector.0, &mut sum[1]);
    add_products([xz, yz, zz], &vector.0, &mut sum[2]);
}

#[inline(always)]
fn add_products(row: [&SingleLanes; 3], vector: &[Lanes; 3], sum: &mut Lanes) {
    for (a, x) in row.into_iter().zip(vector) {
        for lane in 0..LANES {
            sum[lane] = f64::from(a[lane]).mul_add(x[lane], sum[lane]);
        }
    }
}

/// Sums over the lanes in a fixed order.
///
/// Not inlined: otherwise the compiler packs components instead of lanes in the loop before, at
/// four times the cost.
#[inline(never)]
pub(super) fn add_lanes(sums: &[Lanes; 3]) -> [f64; 3] {
    sums.map(|a| ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7])))
}
