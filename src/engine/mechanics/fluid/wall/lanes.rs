//! Images of segments over eight slots at a time.

use super::super::lanes::{
    BlockLanes, OffsetLanes, SegmentLanes, SingleLanes, VectorLanes, add_lanes,
};
use super::image::{Image, Moments};
use crate::linalg::instruction_set::{LANES, Lanes, kernel};

/// Chunks of eight lanes that go through one stage before the next begins, as in the kernel of the segments.
const TILE: usize = 4;

/// The images of eight segments, structure of arrays.
#[derive(Clone, Default)]
#[repr(align(64))]
pub(super) struct ImageLanes {
    mirrored: SegmentLanes,
    height: Lanes,
    slope: Lanes,
}

impl ImageLanes {
    /// Puts an image into a lane.
    pub(crate) fn set(&mut self, lane: usize, image: &Image) {
        self.mirrored.set(lane, &image.mirrored);
        self.height[lane] = image.height;
        self.slope[lane] = image.slope;
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> Image {
        Image {
            mirrored: self.mirrored.get(lane),
            height: self.height[lane],
            slope: self.slope[lane],
        }
    }
}

/// Antisymmetric parts of eight blocks, as the vectors w of the products w × f.
#[derive(Clone, Default)]
#[repr(align(64))]
pub(super) struct AxialLanes(pub [SingleLanes; 3]);

/// Position of an evaluation point relative to the wall, for one row of the operator.
#[derive(Clone, Copy)]
pub(super) struct Row {
    /// Point of evaluation, m.
    pub x: [f64; 3],
    /// Height over the wall, m.
    pub height: f64,
    /// Unit normal of the wall.
    pub normal: [f64; 3],
}

/// Coefficients of both matrices of eight images.
type MomentLanes = [[Lanes; 9]; 2];

kernel! {
    /// Adds the images of all slots to the symmetric blocks of a row and writes their antisymmetric parts. Slots and the
    /// neighbours of lanes are as in the row of the segments themselves.
    fn add_images(
        row: Row,
        images: &[ImageLanes],
        blocks: &mut [BlockLanes],
        axial: &mut [AxialLanes],
    ) {
        let mut ending = [[0.0; LANES]; 9];
        let mut offsets = [OffsetLanes::default(); TILE];
        let mut moments: [MomentLanes; TILE] = [[[[0.0; LANES]; 9]; 2]; TILE];
        for ((images, blocks), axial) in (images.chunks(TILE))
            .zip(blocks.chunks_mut(TILE))
            .zip(axial.chunks_mut(TILE))
        {
            for (images, offsets) in images.iter().zip(&mut offsets) {
                for lane in 0..LANES {
                    offsets.set(lane, &images.mirrored.get(lane).offset(row.x));
                }
            }
            for ((images, offsets), moments) in images.iter().zip(&offsets).zip(&mut moments) {
                for lane in 0..LANES {
                    let [first, second] = images.get(lane).moments(&offsets.get(lane));
                    for k in 0..9 {
                        moments[0][k][lane] = first.0[k];
                        moments[1][k][lane] = second.0[k];
                    }
                }
            }
            for ((((images, offsets), moments), blocks), axial) in (images.iter())
                .zip(&offsets)
                .zip(&moments)
                .zip(blocks)
                .zip(axial)
            {
                let first = parts(row, images, offsets, &moments[0]);
                for lane in 0..LANES {
                    for c in 0..6 {
                        let free = f64::from(blocks.0[c][lane]);
                        blocks.0[c][lane] = (free + (first[c][lane] + ending[c][lane])) as f32;
                    }
                    for c in 0..3 {
                        axial.0[c][lane] = (first[6 + c][lane] + ending[6 + c][lane]) as f32;
                    }
                }
                ending = parts(row, images, offsets, &moments[1]);
            }
        }
        for lane in 1..LANES {
            for c in 0..6 {
                let sum = f64::from(blocks[0].0[c][lane]) + ending[c][lane - 1];
                blocks[0].0[c][lane] = sum as f32;
            }
            for c in 0..3 {
                let sum = f64::from(axial[0].0[c][lane]) + ending[6 + c][lane - 1];
                axial[0].0[c][lane] = sum as f32;
            }
        }
    }
}

/// Symmetric (six) and antisymmetric (three) parts of the matrices of eight images.
#[inline(always)]
fn parts(row: Row, images: &ImageLanes, offsets: &OffsetLanes, moments: &[Lanes; 9]) -> [Lanes; 9] {
    let mut parts = [[0.0; LANES]; 9];
    for lane in 0..LANES {
        let m = Moments([
            moments[0][lane],
            moments[1][lane],
            moments[2][lane],
            moments[3][lane],
            moments[4][lane],
            moments[5][lane],
            moments[6][lane],
            moments[7][lane],
            moments[8][lane],
        ]);
        let offset = offsets.get(lane);
        let part = (images.get(lane)).combine(&m, &offset, row.height, &row.normal);
        for c in 0..6 {
            parts[c][lane] = part.symmetric[c];
        }
        for c in 0..3 {
            parts[6 + c][lane] = part.axial[c];
        }
    }
    parts
}

kernel! {
    /// Σ_j w_j × f_j over the antisymmetric parts of a row.
    fn multiply_axial_row(axial: &[AxialLanes], vectors: &[VectorLanes]) -> [f64; 3] {
        let mut sum = [[0.0; LANES]; 3];
        for (axial, vector) in axial.iter().zip(vectors) {
            let ([x, y, z], [f, g, h]) = (&axial.0, &vector.0);
            for lane in 0..LANES {
                let w = [f64::from(x[lane]), f64::from(y[lane]), f64::from(z[lane])];
                let f = [f[lane], g[lane], h[lane]];
                sum[0][lane] += w[1].mul_add(f[2], -w[2] * f[1]);
                sum[1][lane] += w[2].mul_add(f[0], -w[0] * f[2]);
                sum[2][lane] += w[0].mul_add(f[1], -w[1] * f[0]);
            }
        }
        add_lanes(&sum)
    }
}
