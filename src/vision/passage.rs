//! Positions along strands.

use super::Point;
use super::centreline::Strand;

/// A strand at a crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Index of the strand, from 0.
    pub strand: usize,
    /// Position on the strand: 3.5 is half-way between its points 3 and 4.
    pub at: f64,
}

/// Both ends of the segment that begins at a point.
pub(super) fn segment(strand: &Strand, index: usize) -> [Point; 2] {
    let count = strand.points.len();
    [strand.points[index], strand.points[(index + 1) % count]]
}

/// Number of segments of a strand.
pub(super) fn segments(strand: &Strand) -> usize {
    match strand.points.len() {
        0 | 1 => 0,
        count if strand.closed => count,
        count => count - 1,
    }
}

/// Position and direction of a strand at a passage.
pub(super) fn locate(strands: &[Strand], passage: Passage) -> (Point, Point) {
    let strand = &strands[passage.strand];
    let index = (passage.at as usize).min(segments(strand) - 1);
    let [from, to] = segment(strand, index);
    let t = passage.at - index as f64;
    (from + (to - from) * t, strand.tangent(index))
}

/// Width of a strand at a passage.
pub(super) fn width_at(strands: &[Strand], passage: Passage) -> f64 {
    let widths = &strands[passage.strand].widths;
    widths[(passage.at as usize).min(widths.len() - 1)]
}
