//! Label images: pixel = number of the strand, from 1; 0 is background.

use super::Point;
use super::centreline::Strand;
use super::mask::Mask;
use super::order::StrandCrossing;
use super::pixels::between;
use image::GrayImage;

/// Maximum number of strands of a label image, whose pixels have 8 bits.
pub const MOST_LABELS: usize = 255;

/// Assigns every pixel of a mask to the strand with the nearest centreline, measured in widths; on
/// crossings, to the strand on top. Strands beyond [`MOST_LABELS`] are ignored. Pixels far from all
/// strands are background.
pub fn paint_labels(mask: &Mask, strands: &[Strand], crossings: &[StrandCrossing]) -> GrayImage {
    let mut canvas = Canvas {
        mask,
        labels: vec![0; mask.cells().len()],
        distances: vec![f32::INFINITY; mask.cells().len()],
    };
    for (number, strand) in strands.iter().enumerate().take(MOST_LABELS) {
        for index in 0..strand.points.len() {
            canvas.stamp(strand, index, number as u8 + 1, 0.7, Rule::Nearest);
        }
    }
    mask.spread(&mut canvas.labels, |near| {
        near.into_iter().find(|label| *label > 0)
    });
    for crossing in crossings {
        let over = crossing.over.strand;
        if over >= MOST_LABELS || over == crossing.under.strand {
            continue;
        }
        let (strand, under) = (&strands[over], &strands[crossing.under.strand]);
        let count = strand.points.len();
        let centre = (crossing.over.at as usize).min(count - 1);
        let step = (strand.length() / count as f64).max(0.1);
        let sine = libm::sin(crossing.angle_degrees.to_radians()).max(0.15);
        let covered = 0.5 * (under.width() + strand.width()) / sine + strand.width();
        let reach = ((covered / step).ceil() as usize).min(count);
        for offset in 0..=2 * reach {
            let index = centre as isize + offset as isize - reach as isize;
            let index = if strand.closed {
                index.rem_euclid(count as isize)
            } else {
                index
            };
            if (0..count as isize).contains(&index) {
                canvas.stamp(strand, index as usize, over as u8 + 1, 0.5, Rule::Over);
            }
        }
    }
    canvas.finish()
}

#[derive(Clone, Copy, PartialEq)]
enum Rule {
    /// The nearest strand, measured in widths, wins.
    Nearest,
    /// This strand wins.
    Over,
}

/// Labels and distances, in the order of the cells of the mask.
struct Canvas<'a> {
    mask: &'a Mask,
    labels: Vec<u8>,
    distances: Vec<f32>,
}

impl Canvas<'_> {
    /// Labels the pixels of the mask within `reach` widths of the segment that begins at a point.
    fn stamp(&mut self, strand: &Strand, index: usize, label: u8, reach: f64, rule: Rule) {
        let count = strand.points.len();
        let from = strand.points[index];
        let to = match index + 1 {
            next if next < count => strand.points[next],
            _ if strand.closed => strand.points[0],
            _ => from,
        };
        let radius = (strand.widths[index] * reach).clamp(0.5, 200.0);
        let bounds = |a: f64, b: f64, size| between(a.min(b) - radius, a.max(b) + radius, size);
        let along = to - from;
        let scale = 1.0 / along.norm_squared().max(1e-12);
        let inverse_width = 1.0 / strand.widths[index].max(1.0);
        let limit = radius * radius;
        let columns = bounds(from.x, to.x, self.mask.width());
        for row in bounds(from.y, to.y, self.mask.height()) {
            let first = self.mask.index(columns.start, row);
            for (offset, column) in columns.clone().enumerate() {
                let cell = first + offset;
                if self.mask.cells()[cell] == 0 {
                    continue;
                }
                let point = Point::new(column as f64, row as f64) - from;
                let t = (point.dot(&along) * scale).clamp(0.0, 1.0);
                let square = (point - along * t).norm_squared();
                if square > limit {
                    continue;
                }
                let relative = (square * inverse_width * inverse_width) as f32;
                if rule == Rule::Over || relative < self.distances[cell] {
                    self.distances[cell] = self.distances[cell].min(relative);
                    self.labels[cell] = label;
                }
            }
        }
    }

    fn finish(&self) -> GrayImage {
        let (width, stride) = (self.mask.width(), self.mask.stride());
        let mut image = GrayImage::new(width as u32, self.mask.height() as u32);
        if width > 0 {
            let rows = image.chunks_exact_mut(width);
            for (row, labels) in rows.zip(self.labels.chunks_exact(stride).skip(1)) {
                row.copy_from_slice(&labels[1..=width]);
            }
        }
        image
    }
}
