//! Writhe and linking number of polylines.
//!
//! Gauss' integral over two curves,
//!
//! ```text
//! G = 1/4π ∫∫ (x − y)·(dx × dy)/|x − y|³
//! ```
//!
//! is the signed area, over 4π, that is covered by the directions from points of one curve to
//! points of the other. For two straight segments this area is a spherical quadrilateral, so the
//! sum over all pairs is exact (Klenin & Langowski 2000, Biopolymers 54, 307). For two closed
//! curves G is their linking number, a whole number; for one curve and itself it is the writhe.

use rodlab_engine::mechanics::Vector3;
use std::f64::consts::PI;

/// Writhe of a polyline. A closed polyline is given without its first point at the end. An open
/// one is not closed.
pub fn writhe(points: &[Vector3], closed: bool) -> f64 {
    let segments = segments(points, closed);
    let mut sum = 0.0;
    for (index, one) in segments.iter().enumerate() {
        for other in &segments[index + 1..] {
            sum += area(one, other);
        }
    }
    // Each pair counts twice.
    2.0 * sum / (4.0 * PI)
}

/// Linking number of two polylines, each given with whether it is closed. For open ones it is
/// Gauss' integral, which need not be a whole number.
pub fn linking_number(one: (&[Vector3], bool), other: (&[Vector3], bool)) -> f64 {
    let others = segments(other.0, other.1);
    let mut sum = 0.0;
    for segment in segments(one.0, one.1) {
        for other in &others {
            sum += area(&segment, other);
        }
    }
    sum / (4.0 * PI)
}

fn segments(points: &[Vector3], closed: bool) -> Vec<[Vector3; 2]> {
    let inner = points.windows(2).map(|pair| [pair[0], pair[1]]);
    let last = closed.then(|| [points[points.len() - 1], points[0]]);
    inner.chain(last).collect()
}

/// Signed area covered by the directions from the points of one segment to those of another; 0 for
/// neighbours and for segments in one plane.
fn area(one: &[Vector3; 2], other: &[Vector3; 2]) -> f64 {
    let directions = [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(i, j)| one[i] - other[j]);
    if directions
        .iter()
        .any(|direction| direction.norm_squared() == 0.0)
    {
        return 0.0;
    }
    let [a, b, c, d] = directions.map(|direction| direction.normalize());
    triangle(&a, &b, &c) + triangle(&a, &c, &d)
}

/// Signed area of a spherical triangle (Van Oosterom & Strackee 1983).
fn triangle(a: &Vector3, b: &Vector3, c: &Vector3) -> f64 {
    let volume = a.dot(&b.cross(c));
    let sum = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
    2.0 * libm::atan2(volume, sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn ring(count: usize, point: impl Fn(f64) -> Vector3) -> Vec<Vector3> {
        let parts = (0..count).map(|k| k as f64 / count as f64 * TAU);
        parts.map(point).collect()
    }

    #[test]
    fn linked_rings_of_any_shape_have_linking_number_one() {
        let one = ring(7, |t| Vector3::new(t.cos(), t.sin(), 0.0));
        let other = ring(9, |t| Vector3::new(1.0 + 1.3 * t.cos(), 0.1, 0.8 * t.sin()));
        let far = ring(9, |t| Vector3::new(5.0 + t.cos(), 0.1, t.sin()));
        let link = |a: &[Vector3], b: &[Vector3]| linking_number((a, true), (b, true));
        assert!((link(&one, &other).abs() - 1.0).abs() < 1e-12);
        assert!((link(&one, &other) - link(&other, &one)).abs() < 1e-12);
        assert!(link(&one, &far).abs() < 1e-12);
        // The mirror image has the opposite linking number.
        let mirror = |points: &[Vector3]| -> Vec<Vector3> {
            points
                .iter()
                .map(|p| Vector3::new(p.x, p.y, -p.z))
                .collect()
        };
        let sum = link(&one, &other) + link(&mirror(&one), &mirror(&other));
        assert!(sum.abs() < 1e-12);
    }

    /// Directions between two long edges that nearly touch cover almost a hemisphere.
    #[test]
    fn links_that_nearly_touch_count_as_any() {
        let triangle = [[-1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(Vector3::from);
        let square = [
            [0.1, -1.0, 0.01],
            [0.1, 0.5, 0.01],
            [0.1, 0.5, -1.0],
            [0.1, -1.0, -1.0],
        ]
        .map(Vector3::from);
        let link = linking_number((&triangle, true), (&square, true));
        assert!((link.abs() - 1.0).abs() < 1e-12, "{link}");
        // A line beyond the edge of the triangle is not linked with it.
        let beside = square.map(|point| point - Vector3::y() * 0.6);
        let link = linking_number((&triangle, true), (&beside, true));
        assert!(link.abs() < 1e-12, "{link}");
    }

    /// Two strands of a right-handed double helix have linking number +1 per turn.
    #[test]
    fn right_handed_windings_count_as_positive() {
        // The curve winds n times around the circle of radius 2, as around the axis of a torus.
        let axis = ring(60, |t| Vector3::new(2.0 * t.cos(), 2.0 * t.sin(), 0.0));
        let winding = |turns: f64| {
            ring(200, |t| {
                let outward = Vector3::new(t.cos(), t.sin(), 0.0);
                let (sine, cosine) = (turns * t).sin_cos();
                // Angle about the direction of travel, right-handed: from outwards towards −z.
                outward * (2.0 + 0.5 * cosine) - Vector3::z() * (0.5 * sine)
            })
        };
        let link = |turns: f64| linking_number((&axis, true), (&winding(turns), true));
        for turns in [1.0, 3.0, -2.0] {
            assert!(
                (link(turns) - turns).abs() < 1e-9,
                "{turns}: {}",
                link(turns)
            );
        }
    }

    /// Plane curves have no writhe. A long right-handed helix with n turns and pitch angle α has n
    /// (1 − sin α) (Fuller 1971), except for its ends.
    #[test]
    fn the_writhe_of_a_helix_agrees_with_fuller() {
        let plane = ring(40, |t| Vector3::new(2.0 * t.cos(), t.sin(), 0.0));
        assert!(writhe(&plane, true).abs() < 1e-12);
        let helix = |turns: usize| -> Vec<Vector3> {
            let angle = |k: usize| k as f64 / 40.0 * TAU;
            (0..=40 * turns)
                .map(|k| Vector3::new(angle(k).cos(), angle(k).sin(), angle(k) / 2.0))
                .collect()
        };
        let sine = 0.5 / 1.25_f64.sqrt();
        let per_turn = (writhe(&helix(16), false) - writhe(&helix(12), false)) / 4.0;
        assert!((per_turn / (1.0 - sine) - 1.0).abs() < 5e-3, "{per_turn}");
        let left: Vec<Vector3> = helix(5)
            .iter()
            .map(|p| Vector3::new(p.x, -p.y, p.z))
            .collect();
        assert!((writhe(&left, false) + writhe(&helix(5), false)).abs() < 1e-12);
    }
}
