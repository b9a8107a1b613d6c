//! A rod on top of itself whose picture shows a closed strand and an open one.
//!
//! If a rod returns to its own start, two of its parts run side by side. A strand that enters
//! there has two possible continuations, and the one with the least bending omits the loop. Since
//! a rod has two ends, a closed strand that an open one crosses or touches must be a part of it.

use super::Point;
use super::centreline::Strand;
use super::order::StrandCrossing;
use super::passage::Passage;

/// Largest distance of strands that touch, in widths.
const TOUCH: f64 = 1.3;

/// The rod along the open strand `index`, from its first point or from its last one. Each loop is
/// inserted where the open strand first meets it.
pub fn whole_rod(
    strands: &[Strand],
    crossings: &[StrandCrossing],
    index: usize,
    is_reversed: bool,
) -> Vec<Point> {
    let mut points = strands[index].points.clone();
    let place = |passage: &Passage| {
        if is_reversed {
            (points.len() - 1) as f64 - passage.at
        } else {
            passage.at
        }
    };
    // Closed strands, each with the first place at which the open strand meets it, on the open
    // strand and on the closed one.
    let mut loops: Vec<(usize, f64, Passage)> = Vec::new();
    for crossing in crossings {
        for (own, other) in [
            (&crossing.over, &crossing.under),
            (&crossing.under, &crossing.over),
        ] {
            if own.strand != index || !strands[other.strand].closed {
                continue;
            }
            let here = place(own);
            match loops.iter_mut().find(|known| known.0 == other.strand) {
                Some(known) if known.1 <= here => {}
                Some(known) => *known = (other.strand, here, *other),
                None => loops.push((other.strand, here, *other)),
            }
        }
    }
    for (number, closed) in strands.iter().enumerate() {
        let is_known = loops.iter().any(|known| known.0 == number);
        if closed.closed && !is_known && number != index {
            loops.extend(touch(strands, [index, number], place));
        }
    }
    if is_reversed {
        points.reverse();
    }
    loops.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (closed, here, there) in loops {
        let at = (here.floor() as usize + 1).min(points.len() - 1);
        let way = points[at] - points[at - 1];
        let part = round(&strands[closed].points, there.at as usize, way);
        points.splice(at..at, part);
    }
    points
}

/// The first place, in the order of `place`, at which an open strand touches a closed one.
fn touch(
    strands: &[Strand],
    [open, closed]: [usize; 2],
    place: impl Fn(&Passage) -> f64,
) -> Option<(usize, f64, Passage)> {
    let [own, other] = [&strands[open], &strands[closed]];
    let reach = TOUCH * 0.5 * (own.width() + other.width());
    let touching = own.points.iter().enumerate().filter_map(|(at, point)| {
        let distances = other.points.iter().map(|there| (there - point).norm());
        let (nearest, distance) = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let passage = |strand: usize, at: usize| Passage {
            strand,
            at: at as f64,
        };
        (distance <= reach).then(|| (closed, place(&passage(open, at)), passage(closed, nearest)))
    });
    touching.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The points of a closed strand, once around, starting behind a segment of it, in the direction
/// that agrees with `way`.
fn round(points: &[Point], segment: usize, way: Point) -> Vec<Point> {
    let count = points.len();
    let (from, to) = (segment % count, (segment + 1) % count);
    let along = (points[to] - points[from]).dot(&way) >= 0.0;
    (0..count)
        .map(|step| {
            if along {
                points[(to + step) % count]
            } else {
                points[(from + count - step) % count]
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::intersections;

    /// A line along x from 0 to 200 that cuts a circle around (100, 40), and the crossings of both.
    fn line_and_circle(turn: f64) -> (Vec<Strand>, Vec<StrandCrossing>) {
        let line = (0..=200).map(|x| Point::new(f64::from(x), 10.0)).collect();
        let circle = (0..400).map(|k| {
            let angle = turn * std::f64::consts::TAU * f64::from(k) / 400.0;
            Point::new(
                100.0 + 40.0 * libm::sin(angle),
                40.0 - 40.0 * libm::cos(angle),
            )
        });
        let strands = vec![
            Strand::even(line, 3.0, false),
            Strand::even(circle.collect(), 3.0, true),
        ];
        let crossings = intersections(&strands).into_iter();
        let crossings = crossings.map(|[over, under]| StrandCrossing {
            position: Point::zeros(),
            over,
            under,
            angle_degrees: 0.0,
            confidence: 1.0,
        });
        let crossings = crossings.collect();
        (strands, crossings)
    }

    #[test]
    fn a_closed_strand_is_a_part_of_the_open_one_that_crosses_it() {
        for (turn, is_reversed) in [(1.0, false), (-1.0, false), (1.0, true), (-1.0, true)] {
            let (strands, crossings) = line_and_circle(turn);
            assert_eq!(crossings.len(), 2);
            let whole = whole_rod(&strands, &crossings, 0, is_reversed);
            assert_eq!(whole.len(), 201 + 400);
            // The rod starts from the requested end and has no jumps.
            assert_eq!(whole[0].x, if is_reversed { 200.0 } else { 0.0 });
            let steps = whole.windows(2).map(|pair| (pair[1] - pair[0]).norm());
            assert!(steps.fold(0.0, f64::max) < 3.0);
            // The loop is inserted where the rod first meets it: at 73.5 or 126.5.
            let first = whole.iter().position(|point| (point.y - 10.0).abs() > 0.2);
            let first = whole[first.unwrap()].x;
            let expected = if is_reversed { 126.5 } else { 73.5 };
            assert!((first - expected).abs() < 3.0, "{first}");
        }
    }

    #[test]
    fn a_closed_strand_is_a_part_of_the_open_one_that_touches_it() {
        let (mut strands, _) = line_and_circle(1.0);
        for (height, count) in [(-3.0, 601), (-8.0, 201)] {
            for point in &mut strands[0].points {
                point.y = height;
            }
            for is_reversed in [false, true] {
                let whole = whole_rod(&strands, &[], 0, is_reversed);
                assert_eq!(whole.len(), count);
            }
        }
    }

    #[test]
    fn a_rod_without_a_loop_is_its_strand() {
        let (strands, _) = line_and_circle(1.0);
        let line = &strands[..1];
        assert_eq!(whole_rod(line, &[], 0, false), line[0].points);
    }
}
