//! Crossings of projected closed polygons.

use rodlab_engine::mechanics::Vector3;

/// Difference in height, over the largest coordinate, below which crossing segments count as
/// meeting, because of round-off.
const MEETING: f64 = 1e-13;
/// Directions without symmetry. If a projection is degenerate, which is rare, the next one is
/// used.
const DIRECTIONS: [[f64; 3]; 4] = [
    [0.123, 0.218, 0.968],
    [-0.317, 0.441, 0.839],
    [0.281, -0.529, 0.801],
    [0.407, 0.352, -0.843],
];

/// A crossing of a projection.
pub(super) struct Crossing {
    /// Number of the segment above and the fraction along it.
    pub over: f64,
    /// Number of the segment below and the fraction along it.
    pub under: f64,
    /// Whether the crossing is right-handed: the rotation from the segment above to the one below,
    /// by less than half a turn, is counter-clockwise.
    pub is_positive: bool,
}

/// All crossings of a closed polygon in some projection; `None` if none was found in which all of them are clear.
pub(super) fn some_crossings(closed: &[Vector3]) -> Option<Vec<Crossing>> {
    let mut directions = DIRECTIONS.into_iter().map(Vector3::from);
    directions.find_map(|direction| crossings(closed, &direction.normalize()))
}

/// All crossings of a closed polygon seen along `direction`; `None` if one is not clear.
pub(super) fn crossings(closed: &[Vector3], direction: &Vector3) -> Option<Vec<Crossing>> {
    let [right, up] = {
        let right = direction.cross(&Vector3::new(0.6, -0.7, 0.4)).normalize();
        [right, direction.cross(&right)]
    };
    let points: Vec<[f64; 3]> = closed
        .iter()
        .map(|point| [right.dot(point), up.dot(point), direction.dot(point)])
        .collect();
    let largest = points
        .iter()
        .flatten()
        .fold(0.0, |m: f64, c| m.max(c.abs()));
    let count = points.len();
    let end = |segment: usize| points[(segment + 1) % count];
    // Compares only segments that overlap in the first coordinate, from left to right.
    let extent = |segment: usize| {
        let [start, end] = [points[segment][0], end(segment)[0]];
        [start.min(end), start.max(end)]
    };
    let mut from_left: Vec<usize> = (0..count).collect();
    from_left.sort_by(|&one, &other| extent(one)[0].total_cmp(&extent(other)[0]));
    let mut crossings = Vec::new();
    for (rank, &one) in from_left.iter().enumerate() {
        let right_end = extent(one)[1];
        let reached = |other: &&usize| extent(**other)[0] <= right_end;
        for &other in from_left[rank + 1..].iter().take_while(reached) {
            let (i, j) = (one.min(other), one.max(other));
            if j == i + 1 || (i == 0 && j == count - 1) {
                continue;
            }
            let (a, b) = (points[i], end(i));
            let (c, d) = (points[j], end(j));
            if !boxes_overlap(&a, &b, &c, &d) {
                continue;
            }
            let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
            let first = [b[0] - a[0], b[1] - a[1]];
            let second = [d[0] - c[0], d[1] - c[1]];
            let between = [c[0] - a[0], c[1] - a[1]];
            let turn = cross(first, second);
            let (s, t) = (cross(between, second) / turn, cross(between, first) / turn);
            // Parallel segments cross at infinity, unless they are on one line.
            if s.is_nan() || t.is_nan() {
                return None;
            }
            let margin = 1e-9;
            let inside = |u: f64| (-margin..=1.0 + margin).contains(&u);
            if !inside(s) || !inside(t) {
                continue;
            }
            let clear = |u: f64| (margin..=1.0 - margin).contains(&u);
            let heights = [a[2] + s * (b[2] - a[2]), c[2] + t * (d[2] - c[2])];
            if !clear(s) || !clear(t) || (heights[0] - heights[1]).abs() <= MEETING * largest {
                return None;
            }
            let places = [i as f64 + s, j as f64 + t];
            crossings.push(if heights[0] > heights[1] {
                Crossing {
                    over: places[0],
                    under: places[1],
                    is_positive: turn > 0.0,
                }
            } else {
                Crossing {
                    over: places[1],
                    under: places[0],
                    is_positive: turn < 0.0,
                }
            });
        }
    }
    Some(crossings)
}

fn boxes_overlap(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> bool {
    (0..2).all(|axis| {
        a[axis].min(b[axis]) <= c[axis].max(d[axis]) && c[axis].min(d[axis]) <= a[axis].max(b[axis])
    })
}
