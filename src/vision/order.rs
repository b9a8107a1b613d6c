//! Crossings of strands, and which strand is on top.
//!
//! The upper strand looks the same on the crossing as next to it. The lower one is hidden there:
//! along it, the colour changes to that of the upper strand. If both have the same colour, it is
//! interrupted by shading and edges of the upper strand.

use super::Point;
use super::centreline::Strand;
use super::overlap::differences;
use super::passage::{Passage, locate, segment, segments};
use image::RgbImage;
use std::collections::HashMap;

/// A point of an image at which two strands, or two parts of one strand, cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandCrossing {
    /// Position of the crossing, pixels.
    pub position: Point,
    /// The strand on top.
    pub over: Passage,
    /// The strand below.
    pub under: Passage,
    /// Angle between the strands, degrees, 0 to 90.
    pub angle_degrees: f64,
    /// Confidence of the order: 0 for a guess, 1 if the strand on top does not change at all.
    pub confidence: f64,
}

/// Finds all crossings and the order of their strands. The list of crossings is not ordered along
/// the strands.
pub fn find_crossings(picture: &RgbImage, strands: &[Strand]) -> Vec<StrandCrossing> {
    intersections(strands)
        .into_iter()
        .map(|[a, b]| {
            let (position, tangent_a) = locate(strands, a);
            let (_, tangent_b) = locate(strands, b);
            let sine = tangent_a.perp(&tangent_b).abs();
            let [change_a, change_b] = differences(picture, strands, [a, b]);
            let (over, under) = if change_a <= change_b { (a, b) } else { (b, a) };
            StrandCrossing {
                position,
                over,
                under,
                angle_degrees: libm::asin(sine.min(1.0)).to_degrees(),
                confidence: (change_a - change_b).abs() / (change_a + change_b).max(1e-9),
            }
        })
        .collect()
}

/// Data to compute the distance of two positions along a strand.
#[derive(Clone, Copy)]
struct Scale {
    segments: usize,
    closed: bool,
    /// Length of a segment relative to the width of the strand.
    step_in_widths: f64,
}

impl Scale {
    fn new(strand: &Strand) -> Self {
        let segments = segments(strand);
        Self {
            segments,
            closed: strand.closed,
            step_in_widths: strand.length() / segments.max(1) as f64 / strand.width().max(1e-9),
        }
    }

    /// Whether the distance of two positions along the strand is at most a number of widths.
    fn is_near(&self, at: f64, other: f64, widths: f64) -> bool {
        let apart = (at - other).abs();
        let apart = if self.closed {
            apart.min(self.segments as f64 - apart)
        } else {
            apart
        };
        apart * self.step_in_widths < widths
    }
}

/// Pairs of passages at which strands intersect.
pub(super) fn intersections(strands: &[Strand]) -> Vec<[Passage; 2]> {
    let scales: Vec<Scale> = strands.iter().map(Scale::new).collect();
    let longest_step = strands
        .iter()
        .flat_map(|strand| (0..segments(strand)).map(|index| segment(strand, index)))
        .map(|[from, to]| (to - from).norm())
        .fold(1.0, f64::max);
    // Each segment is entered into all cells that its bounding box touches.
    let size = 2.0 * longest_step;
    let mut cells: HashMap<(i64, i64), Vec<(usize, usize)>> = HashMap::new();
    let mut found: Vec<[Passage; 2]> = Vec::new();
    for (number, strand) in strands.iter().enumerate() {
        for index in 0..segments(strand) {
            let [from, to] = segment(strand, index);
            let cell = |x: f64| (x / size).floor() as i64;
            for row in cell(from.y.min(to.y))..=cell(from.y.max(to.y)) {
                for column in cell(from.x.min(to.x))..=cell(from.x.max(to.x)) {
                    let others = cells.entry((column, row)).or_default();
                    for (other, other_index) in others.iter().copied() {
                        let pair = [(other, other_index), (number, index)];
                        let [(a, i), (b, j)] = pair;
                        if a == b && scales[a].is_near(i as f64, j as f64, 2.0) {
                            continue;
                        }
                        if let Some(pair) = intersect(strands, pair) {
                            found.push(pair);
                        }
                    }
                    others.push((number, index));
                }
            }
        }
    }
    merge(&scales, found)
}

fn intersect(strands: &[Strand], pair: [(usize, usize); 2]) -> Option<[Passage; 2]> {
    let [(a, i), (b, j)] = pair;
    let ([p, q], [r, s]) = (segment(&strands[a], i), segment(&strands[b], j));
    let (along, across) = (q - p, s - r);
    let determinant = along.perp(&across);
    if determinant == 0.0 {
        return None;
    }
    let t = (r - p).perp(&across) / determinant;
    let u = (r - p).perp(&along) / determinant;
    let inside = (0.0..1.0).contains(&t) && (0.0..1.0).contains(&u);
    inside.then_some([
        Passage {
            strand: a,
            at: i as f64 + t,
        },
        Passage {
            strand: b,
            at: j as f64 + u,
        },
    ])
}

/// Strands side by side intersect several times: an odd number of them is one crossing, an even
/// number is none. A pair that was found in two cells counts once.
fn merge(scales: &[Scale], mut found: Vec<[Passage; 2]>) -> Vec<[Passage; 2]> {
    found.sort_by(|[a, b], [c, d]| {
        (a.strand, b.strand)
            .cmp(&(c.strand, d.strand))
            .then(a.at.total_cmp(&c.at))
            .then(b.at.total_cmp(&d.at))
    });
    found.dedup();
    let mut groups: Vec<Vec<[Passage; 2]>> = Vec::new();
    for pair in found {
        let [a, b] = pair;
        let group = groups.iter_mut().rev().find(|group| {
            let [c, d] = group[group.len() - 1];
            c.strand == a.strand
                && d.strand == b.strand
                && scales[a.strand].is_near(a.at, c.at, 3.0)
                && scales[b.strand].is_near(b.at, d.at, 3.0)
        });
        match group {
            Some(group) => group.push(pair),
            None => groups.push(vec![pair]),
        }
    }
    let odd = groups.into_iter().filter(|group| group.len() % 2 == 1);
    odd.map(|group| group[group.len() / 2]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: [f64; 2], to: [f64; 2]) -> Strand {
        let (from, to) = (Point::from(from), Point::from(to));
        let points = (0..=50).map(|index| from + (to - from) * (f64::from(index) / 50.0));
        Strand::even(points.collect(), 6.0, false)
    }

    #[test]
    fn two_lines_cross_once() {
        let strands = [
            line([0.0, 0.0], [100.0, 100.0]),
            line([0.0, 80.0], [100.0, 20.0]),
        ];
        let found = find_crossings(&RgbImage::new(101, 101), &strands);
        assert_eq!(found.len(), 1);
        assert!((found[0].position - Point::new(50.0, 50.0)).norm() < 1e-9);
        // atan 1 + atan 0.6
        assert!((found[0].angle_degrees - 75.964).abs() < 0.01);
    }

    #[test]
    fn lines_that_touch_do_not_cross() {
        let mut bent = line([0.0, 0.0], [100.0, 0.0]);
        for (index, point) in bent.points.iter_mut().enumerate() {
            point.y = if (20..28).contains(&index) { 0.4 } else { -0.4 };
        }
        let strands = [line([0.0, 0.0], [100.0, 0.0]), bent];
        assert!(find_crossings(&RgbImage::new(101, 11), &strands).is_empty());
    }

    #[test]
    fn the_strand_that_keeps_its_colour_is_on_top() {
        let strands = [
            line([0.0, 30.0], [60.0, 30.0]),
            line([30.0, 0.0], [30.0, 60.0]),
        ];
        for top in 0..2 {
            let picture = RgbImage::from_fn(61, 61, |u, v| {
                let on = [v.abs_diff(30) < 3, u.abs_diff(30) < 3];
                let colours = [[200, 60, 60], [70, 160, 90]];
                let shown = if on[top] { top } else { 1 - top };
                image::Rgb(if on[shown] {
                    colours[shown]
                } else {
                    [10, 10, 10]
                })
            });
            let found = find_crossings(&picture, &strands);
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].over.strand, top);
            assert!(found[0].confidence > 0.5, "{}", found[0].confidence);
        }
    }
}
