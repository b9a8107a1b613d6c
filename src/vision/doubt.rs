//! Signs that strands were joined or divided incorrectly.

use super::centreline::Strand;
use super::layers::{hue_apart, hue_at};
use super::mask::Mask;
use super::pixels::between;
use super::skeleton::median;
use image::RgbImage;

/// Largest number of strands; more mean that the mask is noise.
pub(super) const MOST_STRANDS: usize = 60;
/// Hue difference of different strands, in bins of 5°; within one strand it is smaller.
const OTHER_HUE: f64 = 5.0;
/// Length of a part with another hue at which a strand is doubtful, in widths.
const LONGEST_OTHER: f64 = 1.5;

/// Signs that strands were joined or divided incorrectly; none if the mask is noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Signs {
    /// Ends of strands on other strands, and strands that change their hue.
    pub joints: usize,
    /// Parts of the mask without a strand, each as large as the square of a strand's width.
    pub unexplained: usize,
    /// Ends that touch another strand of their colour at a kink or at the end of a stem.
    pub touching: usize,
}

impl Signs {
    /// Joints except those of ends that touch.
    pub fn wrong_joints(self) -> usize {
        self.joints.saturating_sub(self.touching)
    }

    /// Number of signs.
    pub fn count(self) -> usize {
        self.wrong_joints() + self.unexplained
    }
}

/// Looks for signs that strands were joined or divided incorrectly.
pub(super) fn doubts(picture: &RgbImage, mask: &Mask, strands: &[Strand]) -> Signs {
    if strands.len() > MOST_STRANDS {
        return Signs::default();
    }
    let owners = Owners::new(mask, strands);
    let numbers = 0..strands.len();
    let changing = numbers.filter(|number| changes_hue(picture, strands, *number, &owners));
    Signs {
        joints: doubtful_ends(strands) + changing.count(),
        unexplained: owners.unexplained(mask, strands),
        touching: 0,
    }
}

/// Ends of strands that touch another strand, since a strand may have been divided there.
fn doubtful_ends(strands: &[Strand]) -> usize {
    let open = strands
        .iter()
        .enumerate()
        .filter(|(_, strand)| !strand.closed);
    let ends = open.flat_map(|(number, strand)| {
        let ends = [strand.points[0], strand.points[strand.points.len() - 1]];
        ends.map(|end| (number, end, strand.width()))
    });
    ends.filter(|(number, end, width)| {
        strands.iter().enumerate().any(|(other, strand)| {
            let reach = 0.5 * (width + strand.width()) + 2.0;
            other != *number
                && strand
                    .points
                    .iter()
                    .any(|point| (point - end).norm_squared() < reach * reach)
        })
    })
    .count()
}

/// Whether a strand has two hues outside the overlaps with other strands.
fn changes_hue(picture: &RgbImage, strands: &[Strand], number: usize, owners: &Owners) -> bool {
    let strand = &strands[number];
    let width = strand.width();
    let hues: Vec<Option<f64>> = strand
        .points
        .iter()
        .step_by(2)
        .map(|point| {
            let nearest = |x: f64, size: u32| x.round().clamp(0.0, f64::from(size - 1)) as usize;
            let column = nearest(point.x, picture.width());
            let row = nearest(point.y, picture.height());
            let is_alone = owners.is_alone(number, column, row);
            is_alone.then(|| hue_at(picture, column, row)).flatten()
        })
        .collect();
    let known: Vec<f64> = hues.iter().flatten().copied().collect();
    let alike = |hue: f64| {
        let alike = known
            .iter()
            .filter(|other| hue_apart(hue, **other) < 0.5 * OTHER_HUE);
        alike.count()
    };
    let Some(main) = known.iter().copied().max_by_key(|hue| alike(*hue)) else {
        return false;
    };
    let step = strand.length() / hues.len() as f64;
    let longest = hues
        .split(|hue| hue.is_none_or(|hue| hue_apart(hue, main) < OTHER_HUE))
        .map(<[_]>::len)
        .max();
    longest.unwrap_or(0) as f64 * step > LONGEST_OTHER * width
}

/// The strand on each pixel of a mask.
struct Owners {
    stride: usize,
    /// In the order of the mask's cells: 0 for none, the number of the strand plus one, or [`SEVERAL`].
    cells: Vec<u8>,
}

/// Several strands on one pixel.
const SEVERAL: u8 = u8::MAX;

impl Owners {
    fn new(mask: &Mask, strands: &[Strand]) -> Self {
        let mut cells = vec![0; mask.cells().len()];
        for (number, strand) in strands.iter().enumerate() {
            let owner = number as u8 + 1;
            for (point, width) in strand.points.iter().zip(&strand.widths).step_by(2) {
                // A margin for blurred edges, and for corners between strands that meet.
                let reach = 0.5 * width + 1.5;
                let range = |x: f64, reach: f64, size| between(x - reach, x + reach, size);
                for row in range(point.y, reach, mask.height()) {
                    let rest = reach * reach - (row as f64 - point.y).powi(2);
                    let columns = range(point.x, rest.max(0.0).sqrt(), mask.width());
                    let first = mask.index(0, row);
                    for cell in
                        &mut cells[first + columns.start..first + columns.end.max(columns.start)]
                    {
                        if *cell != owner {
                            *cell = if *cell == 0 { owner } else { SEVERAL };
                        }
                    }
                }
            }
        }
        Self {
            stride: mask.stride(),
            cells,
        }
    }

    fn is_alone(&self, number: usize, column: usize, row: usize) -> bool {
        self.cells[(row + 1) * self.stride + column + 1] == number as u8 + 1
    }

    /// Area of the mask that no strand covers, in squares of a strand's width.
    fn unexplained(&self, mask: &Mask, strands: &[Strand]) -> usize {
        let widths: Vec<f64> = strands.iter().map(Strand::width).collect();
        let width = median(&widths).max(1.0);
        let pairs = mask.cells().iter().zip(&self.cells);
        let rest = pairs.filter(|(cell, owner)| **cell == 1 && **owner == 0);
        (rest.count() as f64 / (width * width)) as usize
    }
}
