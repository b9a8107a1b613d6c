//! Ends of strands: at the edge of the mask or of the picture, or on another strand.

use super::Point;
use super::colour::colour_difference;
use super::contrast::Contrast;
use super::crossing::Crossing;
use super::path_energy::departure;
use super::skeleton::{Arm, Skeleton};
use super::strand::Path;
use std::collections::BTreeMap;

/// Colour difference above which a strand is distinguished from the strand on which it ends.
const OTHER_COLOUR: f64 = 25.0;
/// Colour difference within a strand.
const SAME_COLOUR: f64 = 15.0;
/// Distance over which the colour of an ending strand is searched beyond the strand on which it
/// ends, in widths.
const FARTHEST_END: f64 = 3.0;

/// Ends of strands at other strands: the arms without a partner, and their crossings.
#[derive(Debug)]
pub(super) struct EndStops<C> {
    crossing_of: BTreeMap<Arm, Stop>,
    colour: C,
}

/// Crossing at which a strand ends.
#[derive(Clone, Copy, Debug)]
struct Stop {
    /// The crossing.
    position: Point,
    /// Colour of the strand, if the colours of the others at the crossing differ from it.
    own_colour: Option<[f64; 3]>,
}

impl<C: Fn(Point) -> [f64; 3]> EndStops<C> {
    /// Collects the arms without a partner; `colour` returns L\*a\*b\* of a pixel.
    pub fn new(skeleton: &Skeleton, crossings: &[Crossing], colour: C) -> Self {
        let mut crossing_of = BTreeMap::new();
        for crossing in crossings {
            let colours: Vec<[f64; 3]> = crossing
                .arms
                .iter()
                .map(|arm| departure(skeleton, *arm, crossing.position, &colour).colour)
                .collect();
            for (index, arm) in crossing.arms.iter().enumerate() {
                let own = colours[index];
                let differs = |other: usize| {
                    other == index || colour_difference(colours[other], own) > OTHER_COLOUR
                };
                let stop = Stop {
                    position: crossing.position,
                    own_colour: (0..colours.len()).all(differs).then_some(own),
                };
                crossing_of.insert(*arm, stop);
            }
        }
        Self {
            crossing_of,
            colour,
        }
    }

    /// Whether an arm ends at a crossing.
    pub fn has(&self, arm: Arm) -> bool {
        self.crossing_of.contains_key(&arm)
    }
}

/// Moves both ends along the strand to its true ends: the edge of the mask or of the image, or
/// another strand.
pub(super) fn extend_ends(
    contrast: &Contrast,
    points: &mut Vec<Point>,
    widths: &mut Vec<f64>,
    step: f64,
    path: &Path,
    ends: &EndStops<impl Fn(Point) -> [f64; 3]>,
) {
    for end in 0..2 {
        // The end to be moved is at the last point.
        points.reverse();
        widths.reverse();
        let arm = if end == 0 {
            path.entries.first().copied()
        } else {
            path.entries.last().map(|entry| entry.opposite())
        };
        let stop = arm.and_then(|arm| ends.crossing_of.get(&arm)).copied();
        extend_end(contrast, points, widths, step, stop, &ends.colour);
    }
}

/// Continues a strand with its curvature from its last point to the edge of the mask, by at most two
/// widths.
pub(super) fn extend_last(
    contrast: &Contrast,
    points: &mut Vec<Point>,
    widths: &mut Vec<f64>,
    step: f64,
) {
    extend_end(contrast, points, widths, step, None, |_| [0.0; 3]);
}

fn extend_end(
    contrast: &Contrast,
    points: &mut Vec<Point>,
    widths: &mut Vec<f64>,
    step: f64,
    stop: Option<Stop>,
    colour: impl Fn(Point) -> [f64; 3],
) {
    // No chord is measured at the border of the picture, and the smoothed curve may extend
    // slightly beyond it.
    while points.len() > 3
        && points
            .last()
            .is_some_and(|point| !in_picture(contrast, *point))
    {
        points.pop();
        widths.pop();
    }
    let (Some(last), Some(width)) = (points.last().copied(), widths.last().copied()) else {
        return;
    };
    let Some((along, turn)) = end_direction(points, width, step) else {
        return;
    };
    let longest = stop.map_or(2.0 * width, |stop| {
        ((stop.position - last).dot(&along) - 0.5 * width).clamp(0.0, 2.0 * width)
    });
    // The strand continues with its curvature.
    let place = |t: f64| last + along * t + normal(along) * (0.5 * turn * t * t);
    let inside = |t: f64| {
        let point = place(t);
        contrast.at(point.x, point.y) >= f64::from(contrast.threshold)
    };
    const STEP: f64 = 0.25;
    let mut reach = 0.0;
    while reach + STEP <= longest && inside(reach + STEP) {
        reach += STEP;
    }
    // A strand of another colour hides the end or is below it. The end is then the last position
    // with the strand's own colour.
    if let Some(own) = stop.and_then(|stop| stop.own_colour) {
        let farthest = reach + FARTHEST_END * width;
        let mut ahead = reach;
        while ahead + STEP <= farthest && inside(ahead + STEP) {
            ahead += STEP;
            if colour_difference(colour(place(ahead)), own) < SAME_COLOUR {
                reach = ahead;
            }
        }
    }
    let pieces = (reach / step).round() as usize;
    for piece in 1..=pieces {
        points.push(place(reach * piece as f64 / pieces as f64));
        widths.push(width);
    }
    if pieces == 0 && reach > 0.0 {
        let end = points.len() - 1;
        points[end] = place(reach);
    }
}

/// Whether a point lies on a pixel of the picture.
fn in_picture(contrast: &Contrast, point: Point) -> bool {
    let (width, height) = (contrast.width as f64, contrast.height as f64);
    point.x >= -0.5 && point.y >= -0.5 && point.x < width - 0.5 && point.y < height - 0.5
}

/// Direction and curvature at the end of a strand, from the last two widths.
pub(super) fn end_direction(points: &[Point], width: f64, step: f64) -> Option<(Point, f64)> {
    let back = (width / step).ceil() as usize;
    let at = |index: usize| {
        points
            .len()
            .checked_sub(1 + index)
            .map(|index| points[index])
    };
    let (Some(end), Some(middle), Some(start)) = (at(0), at(back), at(2 * back)) else {
        let along = points.last()? - points.first()?;
        return Some((along.try_normalize(1e-9)?, 0.0));
    };
    let later = (end - middle).try_normalize(1e-9)?;
    let earlier = (middle - start).try_normalize(1e-9)?;
    let turned = libm::atan2(earlier.perp(&later), earlier.dot(&later));
    let apart = 0.5 * (end - start).norm();
    // A strand bends with a radius of at least two widths; larger curvature is noise.
    let turn = (turned / apart).clamp(-0.5 / width, 0.5 / width);
    let ahead = 0.5 * turn * (end - middle).norm();
    Some(((later + normal(later) * ahead).normalize(), turn))
}

/// The unit vector across the strand, to the right of a tangent that points down.
pub(super) fn normal(tangent: Point) -> Point {
    Point::new(-tangent.y, tangent.x)
}
