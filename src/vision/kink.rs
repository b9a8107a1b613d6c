//! Kinks: places at which two strands of one colour touch with their ends.
//!
//! A rod bends with a radius of several widths. A line that turns within one width, while its
//! curvature on both sides does not explain the turn, is two strands that meet there.

use super::Point;
use super::centreline::Strand;
use super::contrast::Contrast;
use super::path_energy::{quadratic_start, unit};
use super::strand_end::extend_last;

/// Distance from a kink beyond which the centreline is not rounded, in widths.
const ROUNDED: f64 = 0.9;
/// Length on both sides of a kink that determines its angle, in widths.
const STRETCH: f64 = 2.5;
/// Distance between other strands and a kink, in widths: at crossings, arms may be paired
/// incorrectly.
const OTHERS: f64 = 1.5;

/// What is a kink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct KinkRule {
    /// Least turn of the chords over one width before and behind the kink, rad. On an arc it is the
    /// inverse of the radius in widths.
    pub turn: f64,
    /// Least angle between the continuations of both sides, rad.
    pub angle: f64,
}

impl KinkRule {
    /// Radii below 2.2 widths, and turns by more than 43°. Rods of 12 widths and more bend less.
    pub const SHARP: Self = Self {
        turn: 0.45,
        angle: 0.75,
    };
    /// For pictures with more rods than strands: radii below five widths, and turns by more than 26°.
    pub const WEAK: Self = Self {
        turn: 0.2,
        angle: 0.45,
    };
}

/// Divides strands at their kinks; returns the number of kinks.
pub(super) fn split_at_kinks(
    contrast: &Contrast,
    strands: &mut Vec<Strand>,
    rule: KinkRule,
) -> usize {
    let before = strands.len();
    let mut number = 0;
    while number < strands.len() {
        match kink(strands, number, rule) {
            Some(place) => {
                // Both parts may have another kink; the first one is searched next.
                let [first, second] = split(contrast, &strands[number], place);
                strands[number] = first;
                strands.insert(number + 1, second);
            }
            None => number += 1,
        }
    }
    strands.len() - before
}

/// Numbers of points.
#[derive(Clone, Copy, Debug)]
struct Counts {
    width: usize,
    rounded: usize,
    stretch: usize,
}

impl Counts {
    fn new(strand: &Strand) -> Self {
        let step = strand.length() / strand.points.len().max(2) as f64;
        let count = |widths: f64| (widths * strand.width() / step.max(1e-3)).ceil() as usize;
        Self {
            width: count(1.0).max(1),
            rounded: count(ROUNDED),
            stretch: count(STRETCH).max(4),
        }
    }

    /// Least number of points on each side of a kink.
    fn margin(self) -> usize {
        self.rounded + self.stretch
    }
}

/// The sharpest kink of a strand away from others.
fn kink(strands: &[Strand], number: usize, rule: KinkRule) -> Option<usize> {
    let strand = &strands[number];
    let counts = Counts::new(strand);
    if strand.closed {
        return None;
    }
    let inside = counts.margin()..strand.points.len().saturating_sub(counts.margin());
    let turns = inside.map(|index| (index, turn(strand, index, counts.width)));
    let (sharpest, most) = turns.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (most >= rule.turn
        && angle(strand, sharpest, counts) >= rule.angle
        && is_alone(strands, number, strand.points[sharpest]))
    .then_some(sharpest)
}

/// Angle between the chords over `reach` points before and behind a point, rad.
fn turn(strand: &Strand, index: usize, reach: usize) -> f64 {
    let points = &strand.points;
    let before = points[index] - points[index - reach];
    between(before, points[index + reach] - points[index])
}

fn between(a: Point, b: Point) -> f64 {
    libm::atan2(a.perp(&b), a.dot(&b)).abs()
}

/// Angle between both sides of a point, continued to it with their curvature, rad.
fn angle(strand: &Strand, index: usize, counts: Counts) -> f64 {
    let points = &strand.points;
    let Counts {
        rounded, stretch, ..
    } = counts;
    let after = &points[index + rounded..index + counts.margin()];
    let before: Vec<Point> = points[index + 1 - counts.margin()..=index - rounded]
        .iter()
        .rev()
        .copied()
        .collect();
    let share = rounded as f64 / stretch as f64;
    between(-continued(&before, share), continued(after, share))
}

/// Direction of the parabola through points, continued before the first one by a share of its
/// length.
fn continued(points: &[Point], share: f64) -> Point {
    let (_, start) = quadratic_start(points);
    let reversed: Vec<Point> = points.iter().rev().copied().collect();
    let (_, back) = quadratic_start(&reversed);
    // The derivative of a parabola is linear; that at its end is −back.
    unit(start + (start + back) * share)
}

fn is_alone(strands: &[Strand], number: usize, place: Point) -> bool {
    let others = strands.iter().enumerate().filter(|(k, _)| *k != number);
    let width = strands[number].width();
    others.into_iter().all(|(_, other)| {
        let reach = OTHERS * width.max(other.width());
        let mut points = other.points.iter();
        points.all(|point| (point - place).norm_squared() > reach * reach)
    })
}

/// The two parts of a strand; each is continued to the edge of the mask.
fn split(contrast: &Contrast, strand: &Strand, place: usize) -> [Strand; 2] {
    let rounded = Counts::new(strand).rounded;
    let step = strand.length() / (strand.points.len() - 1) as f64;
    let part = |range: std::ops::Range<usize>| Strand {
        points: strand.points[range.clone()].to_vec(),
        widths: strand.widths[range].to_vec(),
        closed: false,
    };
    let mut first = part(0..place - rounded + 1);
    extend_last(contrast, &mut first.points, &mut first.widths, step);
    let mut second = part(place + rounded..strand.points.len());
    second.reverse();
    extend_last(contrast, &mut second.points, &mut second.widths, step);
    second.reverse();
    [first, second]
}
