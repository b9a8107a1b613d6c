//! Extension of ends that seem to stop at another strand: they are continued across it.

use super::Point;
use super::centreline::Strand;
use super::contrast::Contrast;
use super::strand_end::{end_direction, normal};

/// Largest distance over which an end is searched across another strand, in widths.
const FARTHEST_ACROSS: f64 = 4.0;
/// Smallest length that must emerge at the other side of that strand, pixels.
const LEAST_BEYOND: f64 = 1.0;

/// Moves ends that stop at another strand to its other side, if the mask continues there. The
/// emerging part is often too short for its own skeleton.
pub(super) fn reach_across(contrast: &Contrast, strands: &mut [Strand]) {
    for number in 0..strands.len() {
        if strands[number].closed || strands[number].points.len() < 4 {
            continue;
        }
        for _ in 0..2 {
            let reached = beyond_another(contrast, strands, number);
            let strand = &mut strands[number];
            let width = strand.widths[strand.widths.len() - 1];
            strand
                .widths
                .resize(strand.widths.len() + reached.len(), width);
            strand.points.extend(reached);
            strand.reverse();
        }
    }
}

/// The continuation from the last point of a strand across another one; `None` if it does not
/// emerge.
fn beyond_another(contrast: &Contrast, strands: &[Strand], number: usize) -> Vec<Point> {
    const STEP: f64 = 0.5;
    let strand = &strands[number];
    let width = strand.width();
    let step = strand.length() / (strand.points.len() - 1) as f64;
    let last = strand.points[strand.points.len() - 1];
    let Some((along, turn)) = end_direction(&strand.points, width, step.max(1e-3)) else {
        return Vec::new();
    };
    // Number of the strand's own points that the end cannot reach.
    let own = ((FARTHEST_ACROSS + 2.0) * width / step.max(1e-3)) as usize;
    let own = strand.points.len().saturating_sub(own);
    let place = |t: f64| last + along * t + normal(along) * (0.5 * turn * t * t);
    let near: Vec<(Point, f64)> = strands
        .iter()
        .enumerate()
        .flat_map(|(other, strand)| {
            let count = if other == number {
                own.min(strand.points.len())
            } else {
                strand.points.len()
            };
            let half_width = 0.5 * strand.width();
            strand.points[..count]
                .iter()
                .map(move |point| (*point, half_width))
        })
        .filter(|(point, _)| (point - last).norm() < (FARTHEST_ACROSS + 1.0) * width)
        .collect();
    let is_covered = |point: Point| {
        near.iter()
            .any(|(other, half_width)| (other - point).norm() < half_width + LEAST_BEYOND)
    };
    let (mut across, mut beyond, mut t) = (false, None, 0.0);
    while t <= FARTHEST_ACROSS * width {
        let point = place(t);
        if contrast.at(point.x, point.y) < f64::from(contrast.threshold) {
            break;
        }
        if is_covered(point) {
            (across, beyond) = (true, None);
        } else if across && beyond.is_none() {
            beyond = Some(t);
        }
        t += STEP;
    }
    let is_out = across && t <= FARTHEST_ACROSS * width;
    if !is_out || beyond.is_none_or(|beyond| t - beyond < LEAST_BEYOND) {
        return Vec::new();
    }
    let pieces = ((t - STEP) / step).floor() as usize;
    (1..=pieces)
        .map(|piece| place(step * piece as f64))
        .collect()
}
