//! Where strands cross, and which of the two lies on top.
//!
//! The strand on top looks on the crossing as it does beside it. The one below is hidden there: along it, the colour
//! changes to that of the other one, or, where both are alike, shading and edges of the other one come in between.

use super::Point;
use super::centreline::Strand;
use super::colour::lab;
use image::RgbImage;
use std::collections::HashMap;

/// A point of an image at which two strands, or two parts of one, cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandCrossing {
    /// Where, pixels.
    pub position: Point,
    /// The strand on top.
    pub over: Passage,
    /// The strand below.
    pub under: Passage,
    /// Angle between both, degrees, 0 to 90.
    pub angle_degrees: f64,
    /// How sure the order is: 0 for a guess, 1 where the strand on top does not change at all.
    pub confidence: f64,
}

/// A strand at a crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Which strand, from 0.
    pub strand: usize,
    /// Where on it: 3.5 is half-way between its points 3 and 4.
    pub at: f64,
}

/// Lanes along a strand on which its colours are looked at, in widths from its middle.
const LANES: [f64; 5] = [-0.3, -0.15, 0.0, 0.15, 0.3];

/// Finds all crossings of strands and their order. Along each strand they come in no particular order.
pub fn find_crossings(picture: &RgbImage, strands: &[Strand]) -> Vec<StrandCrossing> {
    intersections(strands)
        .into_iter()
        .map(|[a, b]| {
            let (position, tangent_a) = locate(strands, a);
            let (_, tangent_b) = locate(strands, b);
            let sine = tangent_a.perp(&tangent_b).abs();
            let widths = [a, b].map(|passage| width_at(strands, passage));
            // Across the other strand's edges lies its normal: cot of the angle along for each step to the side.
            let skew = (tangent_a.dot(&tangent_b) / tangent_a.perp(&tangent_b)).clamp(-5.0, 5.0);
            let covered = widths.map(|width| width / sine.max(0.2));
            let change_a = change(picture, strands, a, widths[0], covered[1], skew);
            let change_b = change(picture, strands, b, widths[1], covered[0], -skew);
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

fn segment(strand: &Strand, index: usize) -> [Point; 2] {
    let count = strand.points.len();
    [strand.points[index], strand.points[(index + 1) % count]]
}

fn segments(strand: &Strand) -> usize {
    match strand.points.len() {
        0 | 1 => 0,
        count if strand.closed => count,
        count => count - 1,
    }
}

/// Position and direction of a strand at a passage.
fn locate(strands: &[Strand], passage: Passage) -> (Point, Point) {
    let strand = &strands[passage.strand];
    let index = (passage.at as usize).min(segments(strand) - 1);
    let [from, to] = segment(strand, index);
    let t = passage.at - index as f64;
    (from + (to - from) * t, strand.tangent(index))
}

fn width_at(strands: &[Strand], passage: Passage) -> f64 {
    let widths = &strands[passage.strand].widths;
    widths[(passage.at as usize).min(widths.len() - 1)]
}

/// What tells how near two places of a strand are along it.
#[derive(Clone, Copy)]
struct Scale {
    segments: usize,
    closed: bool,
    /// Length of a segment over the width of the strand.
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

    /// Whether two places are within some widths along the strand.
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
fn intersections(strands: &[Strand]) -> Vec<[Passage; 2]> {
    let scales: Vec<Scale> = strands.iter().map(Scale::new).collect();
    let longest_step = strands
        .iter()
        .flat_map(|strand| (0..segments(strand)).map(|index| segment(strand, index)))
        .map(|[from, to]| (to - from).norm())
        .fold(1.0, f64::max);
    // Segments are entered into the cells that their boxes touch.
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

/// Strands side by side intersect several times: an odd number of them is one crossing, an even number is none.
/// A pair found in two cells is one.
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

/// How much a strand's colour on a crossing differs from that beside it: mean along the strand of the colour difference
/// to what the colours before and behind the crossing say. `covered` is how far the other strand reaches along this one,
/// `skew` how much farther along it lies for each step to the side: with it, edges of the other strand are met at once on
/// all lanes, whose mean has less noise.
fn change(
    picture: &RgbImage,
    strands: &[Strand],
    passage: Passage,
    width: f64,
    covered: f64,
    skew: f64,
) -> f64 {
    let strand = &strands[passage.strand];
    let step = (strand.length() / segments(strand).max(1) as f64).max(1e-3);
    let half = 0.5 * covered;
    // Blurred edges reach a little beyond the strand that makes them.
    let margin = 1.0 + 0.1 * width;
    let look = |along: f64, lane: f64| {
        let index = passage.at + along / step;
        let count = strand.points.len() as f64;
        let index = if strand.closed {
            index.rem_euclid(count)
        } else {
            index.clamp(0.0, count - 1.0)
        };
        let (position, tangent) = locate(
            strands,
            Passage {
                at: index,
                ..passage
            },
        );
        let point = position + Point::new(-tangent.y, tangent.x) * (lane * width);
        colour_at(picture, point)
    };
    let across = |along: f64| {
        let mut mean = [0.0; 3];
        for lane in LANES {
            let colour = look(along + skew * lane * width, lane);
            for (mean, value) in mean.iter_mut().zip(colour) {
                *mean += value / LANES.len() as f64;
            }
        }
        mean
    };
    let mean = |from: f64, to: f64| {
        let count = ((to - from).abs().ceil() as usize).clamp(3, 40);
        let mut sum = [0.0; 3];
        for index in 0..count {
            let along = from + (to - from) * (index as f64 + 0.5) / count as f64;
            for (sum, value) in sum.iter_mut().zip(across(along)) {
                *sum += value / count as f64;
            }
        }
        sum
    };
    let (near, far) = (half + margin, half + margin + 0.75 * width);
    let (before, behind) = (mean(-far, -near), mean(near, far));
    let count = (2.0 * (half + margin)).ceil().clamp(5.0, 60.0);
    let mut total = 0.0;
    for index in 0..count as usize {
        let t = (index as f64 + 0.5) / count;
        let colour = across((2.0 * t - 1.0) * (half + 0.5 * margin));
        let mut square = 0.0;
        for channel in 0..3 {
            let expected = before[channel] * (1.0 - t) + behind[channel] * t;
            square += (colour[channel] - expected).powi(2);
        }
        total += square.sqrt();
    }
    total / count
}

/// Colour between pixels, L\*a\*b\* of the bilinear mean; outside of the picture, that of its border.
fn colour_at(picture: &RgbImage, point: Point) -> [f64; 3] {
    let (u, v) = (
        point.x.clamp(0.0, f64::from(picture.width() - 1)),
        point.y.clamp(0.0, f64::from(picture.height() - 1)),
    );
    let (column, row) = (u as u32, v as u32);
    let (right, below) = (
        (column + 1).min(picture.width() - 1),
        (row + 1).min(picture.height() - 1),
    );
    let (du, dv) = (u - f64::from(column), v - f64::from(row));
    let mut rgb = [0; 3];
    for (channel, value) in rgb.iter_mut().enumerate() {
        let pixel = |u, v| f64::from(picture.get_pixel(u, v)[channel]);
        let above = pixel(column, row) * (1.0 - du) + pixel(right, row) * du;
        let under = pixel(column, below) * (1.0 - du) + pixel(right, below) * du;
        *value = (above * (1.0 - dv) + under * dv).round() as u8;
    }
    lab(rgb)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: [f64; 2], to: [f64; 2]) -> Strand {
        let (from, to) = (Point::from(from), Point::from(to));
        let points: Vec<Point> = (0..=50)
            .map(|index| from + (to - from) * (f64::from(index) / 50.0))
            .collect();
        Strand {
            widths: vec![6.0; points.len()],
            points,
            closed: false,
        }
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
