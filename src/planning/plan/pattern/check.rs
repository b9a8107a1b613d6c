//! Crossings of a pattern with itself, or with another pattern.
//!
//! Polygons of touching curves may cross each other many times by chance: a full circle, for
//! example, ends along its own start. Each crossing of two polygons is therefore followed in both
//! directions along the second polygon, as long as this is within the chord error of the first. The
//! curves themselves cross there if the second polygon leaves the first on opposite sides. Curves
//! that meet and leave on the same side, or that end there, only touch.

use super::{PatternPoint, Point};

/// Distance below which two polygons count as equal, relative to their largest chord error h² κ/8.
const CHORD_ERRORS: f64 = 4.0;
/// Minimum of this distance, relative to the length of the curves: a retraced line does not match
/// more exactly.
const LEAST_DISTANCE: f64 = 1e-4;

/// A crossing of a pattern with itself or another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Arc length of the first pass, m.
    pub first: f64,
    /// Arc length of the second pass, on the other pattern if there is one, m.
    pub second: f64,
    /// Position of the crossing, m.
    pub position: Point,
}

/// Crossings of a pattern with itself.
pub fn crossings(points: &[PatternPoint]) -> Vec<Crossing> {
    let curves = Curves::new(points, points);
    let mut found = Vec::new();
    for (index, one) in points.windows(2).enumerate() {
        // Neighbours share a point.
        for (other, pair) in points.windows(2).enumerate().skip(index + 2) {
            found.extend(crossing(one, pair).map(|crossing| (index, other, crossing)));
        }
    }
    curves.crossings(&found)
}

/// Crossings of a pattern with another one; `second` is the arc length on the other pattern.
pub fn crossings_of_two(points: &[PatternPoint], others: &[PatternPoint]) -> Vec<Crossing> {
    let curves = Curves::new(points, others);
    let mut found = Vec::new();
    for (index, one) in points.windows(2).enumerate() {
        for (other, pair) in others.windows(2).enumerate() {
            found.extend(crossing(one, pair).map(|crossing| (index, other, crossing)));
        }
    }
    curves.crossings(&found)
}

/// Points of two curves, or of one curve twice.
struct Curves<'a> {
    first: &'a [PatternPoint],
    second: &'a [PatternPoint],
    /// Distance below which they count as equal, m.
    distance: f64,
}

/// The coinciding parts of two curves around a crossing of their polygons: segments of the first
/// and of the second one.
struct Contact {
    first: [usize; 2],
    second: [usize; 2],
    crosses: bool,
}

/// The point where a curve leaves another one.
struct Exit {
    /// The last segments reached, of the first curve and of the second one.
    pieces: [usize; 2],
    /// Side of the first curve, +1 left and −1 right; `None` if one of them ends.
    side: Option<f64>,
}

impl<'a> Curves<'a> {
    fn new(first: &'a [PatternPoint], second: &'a [PatternPoint]) -> Self {
        let points = || first.iter().chain(second);
        let spacing = [first, second]
            .iter()
            .flat_map(|points| points.windows(2))
            .fold(0.0, |most: f64, pair| {
                most.max((pair[1].position - pair[0].position).norm())
            });
        let curvature = points().fold(0.0, |most: f64, point| most.max(point.curvature.abs()));
        let length = [first, second]
            .iter()
            .filter_map(|points| points.last())
            .fold(0.0, |most: f64, last| most.max(last.s));
        // The chord error of a piece is at most its length.
        let chord_error = (spacing * spacing * curvature / 8.0).min(0.1 * spacing);
        Self {
            first,
            second,
            distance: (CHORD_ERRORS * chord_error).max(LEAST_DISTANCE * length),
        }
    }

    /// Selects the crossings of the curves among the crossings of their polygons.
    fn crossings(&self, found: &[(usize, usize, Crossing)]) -> Vec<Crossing> {
        let mut contacts: Vec<Contact> = Vec::new();
        let mut crossings = Vec::new();
        for (first, second, crossing) in found {
            let is_known = contacts.iter().any(|contact| {
                let [from, to] = contact.first;
                let [other_from, other_to] = contact.second;
                (from..=to).contains(first) && (other_from..=other_to).contains(second)
            });
            if is_known {
                continue;
            }
            let contact = self.contact(*first, *second);
            if contact.crosses {
                crossings.push(*crossing);
            }
            contacts.push(contact);
        }
        crossings
    }

    fn contact(&self, first: usize, second: usize) -> Contact {
        let [back, ahead] = [false, true].map(|ahead| self.exit(first, second, ahead));
        let range = |curve: usize| {
            let [from, to] = [back.pieces[curve], ahead.pieces[curve]];
            [from.min(to), from.max(to)]
        };
        Contact {
            first: range(0),
            second: range(1),
            crosses: matches!((back.side, ahead.side), (Some(one), Some(other)) if one != other),
        }
    }

    /// Follows the second curve from a crossing of the polygons until it leaves the first one.
    fn exit(&self, first: usize, second: usize, ahead: bool) -> Exit {
        let last = self.first.len() - 2;
        let mut piece = first;
        let mut point = if ahead { second + 1 } else { second };
        loop {
            let position = self.second[point].position;
            // The nearest segment of the first curve, found by descent from the previous one.
            while piece < last && self.away(piece + 1, position) < self.away(piece, position) {
                piece += 1;
            }
            while piece > 0 && self.away(piece - 1, position) < self.away(piece, position) {
                piece -= 1;
            }
            let pieces = [piece, if ahead { point - 1 } else { point }];
            let [from, to] = [self.first[piece].position, self.first[piece + 1].position];
            let along = to - from;
            let part = (position - from).dot(&along) / along.norm_squared();
            if (piece == 0 && part < 0.0) || (piece == last && part > 1.0) {
                return Exit { pieces, side: None };
            }
            if self.away(piece, position) > self.distance {
                let side = along.perp(&(position - from)).signum();
                return Exit {
                    pieces,
                    side: Some(side),
                };
            }
            let next = if ahead {
                Some(point + 1).filter(|next| *next < self.second.len())
            } else {
                point.checked_sub(1)
            };
            match next {
                Some(next) => point = next,
                None => return Exit { pieces, side: None },
            }
        }
    }

    /// Distance of a position from a segment of the first curve, m.
    fn away(&self, piece: usize, place: Point) -> f64 {
        let [from, to] = [self.first[piece].position, self.first[piece + 1].position];
        let along = to - from;
        let part = ((place - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (place - from - part * along).norm()
    }
}

/// Intersection of two pieces.
fn crossing(one: &[PatternPoint], other: &[PatternPoint]) -> Option<Crossing> {
    let [a, b, c, d] = [one[0], one[1], other[0], other[1]].map(|point| point.position);
    let (along, across) = (b - a, d - c);
    let determinant = along.perp(&across);
    if determinant == 0.0 {
        return None;
    }
    let part = (c - a).perp(&across) / determinant;
    let other_part = (c - a).perp(&along) / determinant;
    let is_inside = (0.0..1.0).contains(&part) && (0.0..1.0).contains(&other_part);
    is_inside.then(|| Crossing {
        first: one[0].s + part * (one[1].s - one[0].s),
        second: other[0].s + other_part * (other[1].s - other[0].s),
        position: a + part * along,
    })
}
