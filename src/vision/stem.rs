//! Stems: stretches at the end of a strand on which another strand lies beside it.
//!
//! If two strands of one colour meet with their ends at a small angle, the mask has the shape of a
//! Y. Its skeleton gives the stem to one of them, and the other one ends where they separate. The
//! stem, however, is wider than one strand: each strand has one of its edges. Both strands are
//! measured from their own edge, up to the place where the mask is as wide as one strand.

use super::Point;
use super::centreline::{Strand, chord};
use super::contrast::Contrast;
use super::smoothing::{resample, smooth};
use super::strand_end::{end_direction, normal};

/// Longest stem, in widths.
const LONGEST: f64 = 40.0;
/// Shortest stem, in widths; where one strand ends on another, the mask is wider over up to half a
/// width.
const SHORTEST: f64 = 1.2;
/// Least and largest width of a stem, in widths of a strand.
const STEM_WIDTH: [f64; 2] = [1.12, 2.6];
/// Mean width of a stem, in widths of a strand.
const LEAST_MEAN: f64 = 1.2;
/// Cosine of the largest angle between two strands that share a stem.
const PARALLEL: f64 = 0.77;
/// Distance beyond the stem in which its strands end together, as a part of its length, and in
/// widths: they are hidden by each other where the angle between them closes.
const CLOSING: (f64, f64) = (0.25, 1.5);
/// Smoothing length at the start of a stem, in widths.
const SMOOTHING: f64 = 0.8;

/// Continues strands that end beside another one along their common stem; returns the number of
/// stems.
pub(super) fn share_stems(contrast: &Contrast, strands: &mut [Strand]) -> usize {
    let mut count = 0;
    for number in 0..strands.len() {
        if strands[number].closed || strands[number].points.len() < 4 {
            continue;
        }
        for _ in 0..2 {
            strands[number].reverse();
            if let Some(stem) = stem(contrast, strands, number) {
                stem.share(strands, number);
                count += 1;
            }
        }
    }
    count
}

/// A stem of a strand, from the place where another one ends beside it.
struct Stem {
    /// Number of the strand that has the stem.
    owner: usize,
    /// Whether the stem runs towards the first point of its owner.
    is_reversed: bool,
    /// Number of points of the owner before the stem, in the direction of the stem.
    first: usize,
    /// Centres of the owner, and those of the other strand.
    centres: [Vec<Point>; 2],
}

/// The stem beyond the last point of a strand.
fn stem(contrast: &Contrast, strands: &[Strand], number: usize) -> Option<Stem> {
    let strand = &strands[number];
    let step = strand.length() / (strand.points.len() - 1) as f64;
    let (along, _) = end_direction(&strand.points, strand.width(), step.max(1e-3))?;
    let others = (0..strands.len()).filter(|owner| *owner != number && !strands[*owner].closed);
    let stems = others.filter_map(|owner| stem_of(contrast, strands, [number, owner], along));
    stems.max_by_key(|stem| stem.centres[0].len())
}

/// The stem on one given strand.
fn stem_of(
    contrast: &Contrast,
    strands: &[Strand],
    [number, owner]: [usize; 2],
    along: Point,
) -> Option<Stem> {
    let strand = &strands[number];
    let (width, other) = (strands[owner].width(), strand.width());
    let last = *strand.points.last()?;
    let points = &strands[owner].points;
    let (nearest, apart) = nearest(points, last)?;
    let tangent = strands[owner].tangent(nearest);
    let cosine = tangent.dot(&along);
    if apart > 0.5 * (width + other) + 2.0 || cosine.abs() < PARALLEL {
        return None;
    }
    let mut line = strands[owner].clone();
    let is_reversed = cosine < 0.0;
    let mut first = nearest;
    if is_reversed {
        line.reverse();
        first = points.len() - 1 - nearest;
    }
    let step = line.length() / (points.len() - 1) as f64;
    // The side of the other strand, one and a half widths before its end.
    let back = (1.5 * other / step).ceil() as usize;
    let before = strand.points[strand.points.len().saturating_sub(1 + back)];
    let (beside, _) = self::nearest(&line.points, before)?;
    let across = normal(line.tangent(beside)).dot(&(before - line.points[beside]));
    let edges = edges(contrast, &line, first, width);
    let enough = |widths: f64| (widths * width / step).ceil() as usize;
    let is_stem = edges.len() >= enough(SHORTEST)
        && edges.len() <= enough(LONGEST)
        && mean_width(&edges) >= LEAST_MEAN * width;
    if !is_stem {
        return None;
    }
    let mut centres = [Vec::new(), Vec::new()];
    for (offset, edges) in edges.iter().enumerate() {
        let index = first + offset;
        let place = |t: f64| line.points[index] + normal(line.tangent(index)) * t;
        let [low, high] = *edges;
        let (own, others) = if across > 0.0 {
            (low + 0.5 * width, high - 0.5 * other)
        } else {
            (high - 0.5 * width, low + 0.5 * other)
        };
        centres[0].push(place(own));
        centres[1].push(place(others));
    }
    let rest = line.points.len() - first - edges.len();
    if rest <= enough(CLOSING.1) + (CLOSING.0 * edges.len() as f64) as usize {
        centres[1].extend_from_slice(&line.points[first + edges.len()..]);
    }
    Some(Stem {
        owner,
        is_reversed,
        first,
        centres,
    })
}

/// The point of a line that is nearest to a place, and its distance.
fn nearest(points: &[Point], place: Point) -> Option<(usize, f64)> {
    let distances = points.iter().map(|point| (point - place).norm());
    distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Edges of the mask across a strand, from a point to the place where the mask is as wide as the
/// strand.
fn edges(contrast: &Contrast, line: &Strand, first: usize, width: f64) -> Vec<[f64; 2]> {
    let indices = first..line.points.len();
    let chords = indices.map(|index| chord(contrast, line, index, width));
    let wide = chords.map_while(|chord| {
        let ratio = chord?.width() / width;
        (STEM_WIDTH[0]..STEM_WIDTH[1])
            .contains(&ratio)
            .then_some(chord?.edges())
    });
    wide.collect()
}

fn mean_width(edges: &[[f64; 2]]) -> f64 {
    let sum: f64 = edges.iter().map(|[low, high]| high - low).sum();
    sum / edges.len().max(1) as f64
}

impl Stem {
    /// Gives the stem to both strands.
    fn share(self, strands: &mut [Strand], number: usize) {
        let [own, others] = self.centres;
        let owner = &mut strands[self.owner];
        if self.is_reversed {
            owner.reverse();
        }
        owner.points[self.first..self.first + own.len()].copy_from_slice(&own);
        smoothed(owner);
        if self.is_reversed {
            owner.reverse();
        }
        let strand = &mut strands[number];
        let width = strand.width();
        // The last width of the strand bends towards the middle of the stem.
        let step = strand.length() / (strand.points.len() - 1) as f64;
        let bent = (width / step.max(1e-3)).ceil() as usize;
        let kept = strand.points.len().saturating_sub(bent).max(3);
        strand.points.truncate(kept);
        strand.points.extend(others);
        strand.widths.resize(strand.points.len(), width);
        let (points, _) = resample(&strand.points, step.max(1e-3), false);
        strand.points = points;
        strand.widths.resize(strand.points.len(), width);
        smoothed(strand);
    }
}

/// Smooths a strand.
fn smoothed(strand: &mut Strand) {
    let step = strand.length() / (strand.points.len() - 1) as f64;
    let lambda = (SMOOTHING * strand.width() / step.max(1e-3)).powi(4);
    let weights = vec![1.0; strand.points.len()];
    strand.points = smooth(&strand.points, &weights, lambda, false);
}
