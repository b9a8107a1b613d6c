//! How much strands look like rods.

use super::Point;
use super::centreline::{Strand, chord};
use super::contrast::Contrast;

/// A chord of a rod differs by at most these ratios from the median width.
const EVEN_WIDTH: [f64; 2] = [0.75, 1.3];
/// Slenderness at which a strand is certainly a line.
const SLENDER: f64 = 12.0;
/// Distance between samples of the width, in widths.
const SAMPLE_STEP: f64 = 0.5;

/// Properties by which a strand is compared with a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fitness {
    /// Length, pixels.
    pub length: f64,
    /// Part of its free length with an even width, 0 to 1.
    pub evenness: f64,
    /// Part of the length that counts, 0 to 1: e² min(1, L/(12 w)) for evenness e, length L and
    /// width w.
    pub likeness: f64,
}

impl Fitness {
    /// Length that counts as rod, pixels.
    pub fn rod_length(&self) -> f64 {
        self.length * self.likeness
    }
}

/// Compares each strand with a rod.
pub(super) fn fitness(contrast: &Contrast, strands: &[Strand]) -> Vec<Fitness> {
    let numbers = 0..strands.len();
    numbers
        .map(|number| {
            let strand = &strands[number];
            let (length, width) = (strand.length(), strand.width().max(1.0));
            let evenness = evenness(contrast, strands, number);
            Fitness {
                length,
                evenness,
                likeness: evenness * evenness * (length / (SLENDER * width)).min(1.0),
            }
        })
        .collect()
}

/// Part of the samples away from other strands whose width is even.
fn evenness(contrast: &Contrast, strands: &[Strand], number: usize) -> f64 {
    let strand = &strands[number];
    let count = strand.points.len();
    let width = strand.width().max(1.0);
    let step = strand.length() / count.max(2) as f64;
    let stride = ((SAMPLE_STEP * width / step.max(1e-3)) as usize).max(1);
    // The ends are round or cut off by the border of the image.
    let margin = ((width / step.max(1e-3)) as usize).min(count / 4);
    let is_even = |index: usize| {
        let chord = chord(contrast, strand, index, width);
        let even = EVEN_WIDTH[0]..=EVEN_WIDTH[1];
        chord.is_some_and(|chord| even.contains(&(chord.width() / width)))
    };
    // A part that something else hides, such as a gripper, has no edges of its own.
    let is_hidden = |point: Point| contrast.at(point.x, point.y) < f64::from(contrast.threshold);
    let (mut even, mut all) = (0.0, 0.0);
    for index in (margin..count - margin).step_by(stride) {
        let point = strand.points[index];
        if !is_hidden(point) && !is_met(strands, number, point, width) {
            all += 1.0;
            even += f64::from(u8::from(is_even(index)));
        }
    }
    if all > 0.0 { even / all } else { 1.0 }
}

/// Whether another strand lies on or beside a point of a strand.
fn is_met(strands: &[Strand], number: usize, point: Point, width: f64) -> bool {
    let others = strands.iter().enumerate().filter(|(k, _)| *k != number);
    others.into_iter().any(|(_, other)| {
        let reach = 0.5 * (width + other.width()) + 3.0;
        let stride = ((0.5 * reach) as usize).clamp(1, 4);
        let mut points = other.points.iter().step_by(stride);
        points.any(|place| (place - point).norm_squared() < reach * reach)
    })
}

#[cfg(test)]
mod tests {
    use super::super::mask::tests::{contrast_of, drawn, strokes};
    use super::super::{TraceOptions, trace_contrast};
    use super::*;
    use image::RgbImage;

    fn likeness(is_rod: impl Fn(Point) -> bool) -> f64 {
        let mask = drawn(300, 120, is_rod);
        let contrast = contrast_of(&mask);
        let picture = RgbImage::new(300, 120);
        let found = trace_contrast(&picture, &contrast, &TraceOptions::default());
        let found = found.expect("a strand");
        let all = fitness(&contrast, &found.strands);
        all.iter().map(|one| one.likeness).sum::<f64>() / all.len() as f64
    }

    #[test]
    fn a_rod_is_more_like_a_rod_than_a_stripe_of_uneven_width() {
        let line: &[[f64; 2]] = &[[20.0, 40.0], [150.0, 80.0], [280.0, 50.0]];
        let rod = strokes(300, 120, 9.0, &[line]);
        let rod = likeness(|p| rod.contains(p.x as usize, p.y as usize));
        assert!(rod > 0.9, "{rod}");
        // Its width varies between 4 and 16 pixels.
        let uneven = likeness(|p| {
            (20.0..280.0).contains(&p.x) && (p.y - 60.0).abs() < 5.0 + 3.0 * (p.x / 9.0).sin()
        });
        assert!(uneven < 0.6 * rod, "{uneven}");
    }

    #[test]
    fn a_crossing_does_not_count_as_uneven() {
        let lines: [&[[f64; 2]]; 2] = [
            &[[20.0, 20.0], [280.0, 100.0]],
            &[[20.0, 100.0], [280.0, 20.0]],
        ];
        let cross = strokes(300, 120, 9.0, &lines);
        let cross = likeness(|p| cross.contains(p.x as usize, p.y as usize));
        assert!(cross > 0.9, "{cross}");
    }
}
