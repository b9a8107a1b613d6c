//! Stretches on which two strands lie side by side, with no edge between them.
//!
//! The mask is twice as wide there. Each strand keeps one of its two edges, which continues the
//! edge of the single strand before and behind the stretch; the other edge is a width away.

use super::Point;
use super::chord::Chord;
use super::strand_end::normal;
use std::ops::Range;

/// Width of the mask over two strands, in widths of one.
const TWO_STRANDS: [f64; 2] = [1.7, 2.3];
/// Width of the mask over one strand, in widths.
const ONE_STRAND: [f64; 2] = [0.8, 1.18];
/// Shortest stretch, in widths; at a crossing the mask is wide over a shorter one.
const SHORTEST: f64 = 3.0;
/// Longest part before or behind the stretch on which the strands approach each other, in widths.
const APPROACH: f64 = 8.0;

/// Whether a width is that of two strands of another width.
pub(super) fn is_double(width: f64, of_one: f64) -> bool {
    (TWO_STRANDS[0]..TWO_STRANDS[1]).contains(&(width / of_one))
}

/// A strand that other strands may lie beside.
pub(super) struct Beside<'a> {
    /// Points of its first guess, and its direction at each of them.
    pub points: &'a [Point],
    pub tangents: Vec<Point>,
    /// Distance between points, pixels.
    pub step: f64,
    /// Its width, pixels.
    pub width: f64,
    pub closed: bool,
}

impl Beside<'_> {
    /// Replaces chords over two strands by those over this one; returns the points of such
    /// stretches.
    pub fn separate(&self, chords: &mut [Option<Chord>]) -> Vec<Range<usize>> {
        let mut separated = self.runs(chords);
        separated.retain(|run| {
            if run.len() < self.count(SHORTEST) {
                return false;
            }
            // Positive if the second edge is that of the strand.
            let mut vote = 0.0;
            for (inside, way) in [(run.start, -1), (run.end - 1, 1)] {
                if let Some(outside) = self.single(chords, inside, run.len(), way) {
                    let [first, second] = self.jumps(chords, outside, inside);
                    vote += first - second;
                }
            }
            if vote == 0.0 {
                return false;
            }
            for chord in chords[run.clone()].iter_mut().flatten() {
                let [first, second] = chord.edges();
                *chord = Chord::new(if vote > 0.0 {
                    [second - self.width, second]
                } else {
                    [first, first + self.width]
                });
            }
            true
        });
        separated
    }

    /// Number of points on a length in widths.
    fn count(&self, widths: f64) -> usize {
        (widths * self.width / self.step.max(1e-3)).ceil() as usize
    }

    /// Runs of chords over two strands, with gaps of at most half a width.
    fn runs(&self, chords: &[Option<Chord>]) -> Vec<Range<usize>> {
        let gap = self.count(0.5);
        let mut runs: Vec<Range<usize>> = Vec::new();
        for (index, chord) in chords.iter().enumerate() {
            if chord.is_some_and(|chord| is_double(chord.width(), self.width)) {
                match runs.last_mut() {
                    Some(run) if index - run.end <= gap => run.end = index + 1,
                    _ => runs.push(index..index + 1),
                }
            }
        }
        runs
    }

    /// The nearest chord over one strand, on the approach to the end of a run of `length` points:
    /// before it (`way` is −1) or behind it.
    fn single(
        &self,
        chords: &[Option<Chord>],
        end: usize,
        length: usize,
        way: isize,
    ) -> Option<usize> {
        let count = chords.len();
        let farthest = self.count(APPROACH).min(count - length);
        (1..=farthest).find_map(|distance| {
            let index = end as isize + way * distance as isize;
            let index = if self.closed {
                index.rem_euclid(count as isize) as usize
            } else {
                usize::try_from(index).ok().filter(|index| *index < count)?
            };
            let chord = chords[index]?;
            let is_one = (ONE_STRAND[0]..ONE_STRAND[1]).contains(&(chord.width() / self.width));
            is_one.then_some(index)
        })
    }

    /// Distance of each edge at the point `inside` from the straight continuation of that edge at
    /// the point `outside`, pixels.
    fn jumps(&self, chords: &[Option<Chord>], outside: usize, inside: usize) -> [f64; 2] {
        let edges = |index: usize| {
            let across = normal(self.tangents[index]);
            let edges = chords[index].map_or([0.0; 2], |chord| chord.edges());
            edges.map(|edge| self.points[index] + across * edge)
        };
        // The mean direction, so that an arc does not move the edges.
        let along = self.tangents[outside] + self.tangents[inside];
        let along: Point = along.try_normalize(1e-9).unwrap_or(Point::x());
        let (from, to) = (edges(outside), edges(inside));
        [0, 1].map(|edge| along.perp(&(to[edge] - from[edge])).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::super::mask::tests::{contrast_of, drawn, strokes};
    use super::super::{TraceOptions, trace_contrast};
    use super::*;
    use crate::centreline::Strand;
    use crate::mask::Mask;
    use image::RgbImage;

    fn traced(mask: &Mask) -> Vec<Strand> {
        let picture = RgbImage::new(mask.width() as u32, mask.height() as u32);
        let contrast = contrast_of(mask);
        let found = trace_contrast(&picture, &contrast, &TraceOptions::default());
        found.expect("strands").strands
    }

    #[test]
    fn each_of_two_strands_side_by_side_keeps_its_own_edge() {
        // Fifty widths side by side: the mask is 14 pixels wide from v = 53 to 67.
        let upper = [[10.0, 20.0], [80.0, 56.5], [430.0, 56.5], [500.0, 20.0]];
        let lower = upper.map(|[u, v]| [u, 120.0 - v]);
        let strands = traced(&strokes(510, 120, 7.0, &[&upper, &lower]));
        assert_eq!(strands.len(), 2);
        let mut heights = Vec::new();
        for strand in &strands {
            assert!((strand.width() - 7.0).abs() < 1.2, "{}", strand.width());
            let shared = strand.points.iter();
            let shared: Vec<_> = shared
                .filter(|point| (110.0..400.0).contains(&point.x))
                .collect();
            let mean = shared.iter().map(|point| point.y).sum::<f64>() / shared.len() as f64;
            let far = shared.iter().map(|point| (point.y - mean).abs());
            assert!(far.fold(0.0, f64::max) < 0.5);
            heights.push(mean);
        }
        heights.sort_by(f64::total_cmp);
        assert!((heights[0] - 56.5).abs() < 0.7, "{heights:?}");
        assert!((heights[1] - 63.5).abs() < 0.7, "{heights:?}");
    }

    #[test]
    fn a_loop_beside_a_strand_is_closed() {
        let circle = |point: Point| (point - Point::new(150.0, 80.0)).norm() - 60.0;
        let mask = drawn(300, 170, |point| {
            let line = (20.0..280.0).contains(&point.x) && (point.y - 146.0).abs() <= 3.5;
            line || circle(point).abs() <= 3.5
        });
        let strands = traced(&mask);
        assert_eq!(strands.len(), 2);
        let closed: Vec<_> = strands.iter().filter(|strand| strand.closed).collect();
        assert_eq!(closed.len(), 1);
        let far = closed[0].points.iter().map(|point| circle(*point).abs());
        assert!(far.fold(0.0, f64::max) < 1.5);
    }
}
