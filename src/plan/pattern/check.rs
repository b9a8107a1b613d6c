//! What a pattern asks of a rod.

use super::{PatternPoint, Point};

/// A place where a pattern crosses itself, or another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Arc length at which it lies there first, m.
    pub first: f64,
    /// Arc length at which it comes there again, or the other one does, m.
    pub second: f64,
    /// The place, m.
    pub position: Point,
}

/// Where a pattern crosses itself, by its polygon.
pub fn crossings(points: &[PatternPoint]) -> Vec<Crossing> {
    let mut found = Vec::new();
    for (index, one) in points.windows(2).enumerate() {
        let others = points.windows(2).skip(index + 2);
        found.extend(others.filter_map(|other| crossing(one, other)));
    }
    found
}

/// Where a pattern crosses another one, by their polygons; `second` is the arc length of the other.
pub fn crossings_of_two(points: &[PatternPoint], others: &[PatternPoint]) -> Vec<Crossing> {
    let pieces = points.windows(2);
    let crossed = pieces.flat_map(|one| {
        others
            .windows(2)
            .filter_map(move |other| crossing(one, other))
    });
    crossed.collect()
}

/// Where two pieces cross.
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
