//! Rasterises triangles into a depth buffer: the visible surface at each sample of a picture, and
//! its normal.

/// A corner of a triangle in samples: x to the right, y downwards, nearness to the eye; and the unit normal of the surface there, in
/// the same axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub at: [f32; 3],
    pub normal: [f32; 3],
}

/// Depth of an empty sample.
pub(super) const NOTHING: f32 = f32::NEG_INFINITY;

/// Levels of a component of a normal.
const LEVELS: f32 = 2047.0;

/// The samples of a picture: arrays by row. The used spans of the rows make it cheap to clear and
/// to shade.
pub(super) struct Samples {
    pub width: usize,
    pub height: usize,
    /// Nearness of the visible surface to the eye; [`NOTHING`] if there is none.
    pub depth: Vec<f32>,
    /// Material and normal of the sample, see [`packed`].
    pub surface: Vec<u32>,
    /// Columns of each row that may be used: first, and one beyond the last.
    spans: Vec<[usize; 2]>,
}

impl Samples {
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            depth: vec![NOTHING; width * height],
            surface: vec![0; width * height],
            spans: vec![[width, 0]; height],
        }
    }

    /// Clears the picture.
    pub fn clear(&mut self) {
        for (row, span) in self.spans.iter_mut().enumerate() {
            if span[0] < span[1] {
                let first = row * self.width;
                self.depth[first + span[0]..first + span[1]].fill(NOTHING);
            }
            *span = [self.width, 0];
        }
    }

    /// The columns of a row that may be used; an empty range if there are none.
    pub fn span(&self, row: usize) -> std::ops::Range<usize> {
        let [first, end] = self.spans[row];
        first..end.max(first)
    }

    /// Draws a triangle of a material. `one_sided`: it is part of a closed surface, whose back
    /// faces are hidden.
    ///
    /// Samples on an edge belong to both triangles; if both are equally near, the first one drawn
    /// is kept.
    pub fn fill(&mut self, corners: [&Corner; 3], material: u8, one_sided: bool) {
        let [a, b, c] = corners.map(|corner| corner.at);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // Since y is downwards, triangles that run clockwise on the page face the eye.
        if area.is_nan() || area == 0.0 || (one_sided && area < 0.0) {
            return;
        }
        let Some([left, right]) = covered([a[0], b[0], c[0]], self.width) else {
            return;
        };
        let Some([top, bottom]) = covered([a[1], b[1], c[1]], self.height) else {
            return;
        };
        let one_over_area = 1.0 / area;
        // Barycentric coordinates of b and c vary linearly along rows and columns.
        let along_x = [(c[1] - a[1]) * one_over_area, (a[1] - b[1]) * one_over_area];
        let along_y = [(a[0] - c[0]) * one_over_area, (b[0] - a[0]) * one_over_area];
        for row in top..=bottom {
            let (dx, dy) = (left as f32 + 0.5 - a[0], row as f32 + 0.5 - a[1]);
            let start = [0, 1].map(|k| along_x[k] * dx + along_y[k] * dy);
            let first = row * self.width;
            let mut drawn = [self.width, 0];
            // Long thin triangles cover little of their box.
            let at_left = [1.0 - start[0] - start[1], start[0], start[1]];
            let slopes = [-along_x[0] - along_x[1], along_x[0], along_x[1]];
            let [from, to] = inside(at_left, slopes, right - left);
            for column in left + from..left + to {
                let steps = (column - left) as f32;
                let [v, w] = [0, 1].map(|k| start[k] + steps * along_x[k]);
                let u = 1.0 - v - w;
                if u < 0.0 || v < 0.0 || w < 0.0 {
                    continue;
                }
                let depth = u * a[2] + v * b[2] + w * c[2];
                let sample = first + column;
                if depth > self.depth[sample] {
                    self.depth[sample] = depth;
                    let normal = [0, 1, 2].map(|k| {
                        u * corners[0].normal[k]
                            + v * corners[1].normal[k]
                            + w * corners[2].normal[k]
                    });
                    self.surface[sample] = packed(material, normal);
                    drawn = [drawn[0].min(column), column + 1];
                }
            }
            let span = &mut self.spans[row];
            *span = [span[0].min(drawn[0]), span[1].max(drawn[1])];
        }
    }
}

/// The steps from 0 to `most` at which three numbers that vary linearly from `start` may all be
/// positive: the first step, and one beyond the last.
fn inside(start: [f32; 3], slopes: [f32; 3], most: usize) -> [usize; 2] {
    let (mut low, mut high) = (0.0, most as f32);
    for (start, slope) in start.into_iter().zip(slopes) {
        let zero = -start / slope;
        if slope > 0.0 {
            low = zero.max(low);
        } else if slope < 0.0 {
            high = zero.min(high);
        }
    }
    // One more step on both sides compensates for rounding: outside samples are discarded later.
    let from = (low as usize).saturating_sub(1);
    let to = if high < 0.0 {
        0
    } else {
        (high as usize + 2).min(most + 1)
    };
    [from.min(to), to]
}

/// The samples whose centres may be between the least and the largest of three coordinates; `None`
/// if none of them is in the picture.
fn covered(coordinates: [f32; 3], count: usize) -> Option<[usize; 2]> {
    let low = coordinates.iter().copied().fold(f32::INFINITY, f32::min);
    let high = coordinates
        .iter()
        .copied()
        .fold(f32::NEG_INFINITY, f32::max);
    if !(high >= 0.5 && low <= count as f32 - 0.5) {
        return None;
    }
    // Rounded up and down by conversion to integers, which is faster than a function call.
    let start = (low - 0.5).max(0.0);
    let whole = start as usize;
    let first = whole + usize::from((whole as f32) < start);
    let last = ((high - 0.5) as usize).min(count - 1);
    (first <= last).then_some([first, last])
}

/// A material and a normal in 32 bits: twelve for each component in the picture. The third
/// component follows, because visible surfaces face the eye.
fn packed(material: u8, [x, y, z]: [f32; 3]) -> u32 {
    let length = (x * x + y * y + z * z).sqrt().max(1e-12);
    // A back face is seen from behind, so its normal is reversed.
    let scale = if z < 0.0 { -1.0 } else { 1.0 } / length;
    let level = |component: f32| (component * scale * LEVELS + LEVELS + 0.5) as u32 & 0xfff;
    u32::from(material) << 24 | level(x) << 12 | level(y)
}

/// The material and the unit normal of a sample.
pub(super) fn unpacked(surface: u32) -> (u8, [f32; 3]) {
    let component = |bits: u32| (bits & 0xfff) as f32 / LEVELS - 1.0;
    let [x, y] = [component(surface >> 12), component(surface)];
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    ((surface >> 24) as u8, [x, y, z])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f32, y: f32, depth: f32) -> Corner {
        Corner {
            at: [x, y, depth],
            normal: [0.0, 0.0, 1.0],
        }
    }

    fn seen(samples: &Samples) -> usize {
        samples
            .depth
            .iter()
            .filter(|depth| **depth > NOTHING)
            .count()
    }

    #[test]
    fn a_triangle_covers_its_area_and_clearing_removes_it() {
        let mut samples = Samples::new(200, 100);
        let corners = [
            corner(10.0, 10.0, 0.0),
            corner(190.0, 20.0, 0.0),
            corner(60.0, 95.0, 0.0),
        ];
        let area = 0.5 * (180.0 * 85.0 - 10.0 * 50.0);
        let [a, b, c] = &corners;
        samples.fill([a, b, c], 1, false);
        assert!((seen(&samples) as f64 - area).abs() < 0.005 * area);
        samples.clear();
        assert_eq!(seen(&samples), 0);
        // Only the front of a closed body is visible: the side from which its triangles run
        // clockwise.
        samples.fill([a, c, b], 1, true);
        assert_eq!(seen(&samples), 0);
        samples.fill([a, b, c], 1, true);
        assert!((seen(&samples) as f64 - area).abs() < 0.005 * area);
    }

    #[test]
    fn the_nearer_of_two_triangles_that_cross_is_seen_in_any_order() {
        // One triangle is nearer on the left, the other on the right.
        let tilted = |left: f32, right: f32| {
            [
                corner(0.0, 0.0, left),
                corner(0.0, 200.0, left),
                corner(100.0, 0.0, right),
            ]
        };
        let (one, other) = (tilted(1.0, 0.0), tilted(0.0, 1.0));
        let material = |samples: &Samples, column: usize| unpacked(samples.surface[column]).0;
        for order in [[(&one, 1), (&other, 2)], [(&other, 2), (&one, 1)]] {
            let mut samples = Samples::new(100, 100);
            for ([a, b, c], material) in order {
                samples.fill([a, b, c], material, false);
            }
            assert_eq!([material(&samples, 40), material(&samples, 60)], [1, 2]);
        }
    }

    #[test]
    fn normals_are_kept_to_a_thousandth_and_face_the_eye() {
        for normal in [[0.6f32, 0.0, 0.8], [-0.48, 0.6, 0.64], [0.0, 0.0, -1.0]] {
            let (material, read) = unpacked(packed(7, normal.map(|x| 3.0 * x)));
            let sign = if normal[2] < 0.0 { -1.0 } else { 1.0 };
            assert_eq!(material, 7);
            for k in 0..3 {
                assert!((read[k] - sign * normal[k]).abs() < 1e-3, "{read:?}");
            }
        }
    }

    #[test]
    fn triangles_beyond_the_picture_and_without_numbers_draw_nothing() {
        let mut samples = Samples::new(10, 10);
        for shift in [-50.0, 50.0, f32::NAN, f32::INFINITY] {
            let corners = [
                corner(shift, 0.0, 0.0),
                corner(shift + 9.0, 0.0, 0.0),
                corner(shift, 9.0, 0.0),
            ];
            let [a, b, c] = &corners;
            samples.fill([a, b, c], 1, false);
        }
        assert_eq!(seen(&samples), 0);
    }
}
