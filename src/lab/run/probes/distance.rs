//! Least distance of two polylines.

use rodlab_engine::mechanics::Vector3;

/// Least distance of two polylines, each given with whether it is closed.
pub fn least_distance(one: (&[Vector3], bool), other: (&[Vector3], bool)) -> f64 {
    let mut least = f64::INFINITY;
    for first in edges(one) {
        for second in edges(other) {
            least = least.min(segment_distance(first, second));
        }
    }
    least
}

fn edges((points, closed): (&[Vector3], bool)) -> impl Iterator<Item = [&Vector3; 2]> {
    let count = points.len() - usize::from(!closed);
    (0..count).map(move |k| [&points[k], &points[(k + 1) % points.len()]])
}

/// Distance of two segments: between the closest points of their lines if these are within both
/// segments, else from an end of one segment to the other.
fn segment_distance([a, b]: [&Vector3; 2], [c, d]: [&Vector3; 2]) -> f64 {
    let (first, second, between) = (b - a, d - c, a - c);
    let (aa, bb, ab) = (
        first.norm_squared(),
        second.norm_squared(),
        first.dot(&second),
    );
    let determinant = aa * bb - ab * ab;
    if determinant > 0.0 {
        let (da, db) = (first.dot(&between), second.dot(&between));
        let s = (ab * db - bb * da) / determinant;
        let t = (aa * db - ab * da) / determinant;
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            return (between + first * s - second * t).norm();
        }
    }
    [
        point_distance(a, [c, d]),
        point_distance(b, [c, d]),
        point_distance(c, [a, b]),
        point_distance(d, [a, b]),
    ]
    .into_iter()
    .fold(f64::INFINITY, f64::min)
}

fn point_distance(point: &Vector3, [start, end]: [&Vector3; 2]) -> f64 {
    let edge = end - start;
    let part = (point - start).dot(&edge) / edge.norm_squared();
    (point - start - edge * part.clamp(0.0, 1.0)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = Vector3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(Vector3::from)
    }

    proptest! {
        #[test]
        fn no_pair_of_points_is_nearer(points in prop::collection::vec(vector(), 4)) {
            let (one, other) = ([points[0], points[1]], [points[2], points[3]]);
            let least = least_distance((&one, false), (&other, false));
            let mut sampled = f64::INFINITY;
            for i in 0..=200 {
                let on_one = one[0].lerp(&one[1], f64::from(i) / 200.0);
                sampled = sampled.min(point_distance(&on_one, [&other[0], &other[1]]));
            }
            prop_assert!(least <= sampled + 1e-12);
            prop_assert!(sampled - least < 0.02);
        }
    }

    #[test]
    fn parallel_and_closed_curves() {
        let line = |y: f64| [Vector3::new(0.0, y, 0.0), Vector3::new(1.0, y, 0.0)];
        assert_eq!(
            least_distance((&line(0.0), false), (&line(0.5), false)),
            0.5
        );
        let square =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vector3::new(x, y, 0.0));
        let post = [
            Vector3::new(-0.25, 0.5, -1.0),
            Vector3::new(-0.25, 0.5, 1.0),
        ];
        assert_eq!(least_distance((&square, true), (&post, false)), 0.25);
        assert!(least_distance((&square, false), (&post, false)) > 0.5);
    }
}
