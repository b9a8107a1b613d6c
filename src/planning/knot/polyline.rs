//! Polylines that approximate smooth curves: length, and nodes at equal steps.

use rodlab_engine::mechanics::Vector3;

/// Length of an open polyline, m.
pub fn length(curve: &[Vector3]) -> f64 {
    curve
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum()
}

/// Points at equal steps of arc length, both ends among them.
pub fn equally_spaced(curve: &[Vector3], count: usize) -> Vec<Vector3> {
    let step = length(curve) / (count - 1) as f64;
    let mut points = vec![curve[0]];
    let mut travelled = 0.0;
    for pair in curve.windows(2) {
        let segment = (pair[1] - pair[0]).norm();
        while points.len() < count - 1 && travelled + segment >= points.len() as f64 * step {
            let part = (points.len() as f64 * step - travelled) / segment;
            points.push(pair[0].lerp(&pair[1], part));
        }
        travelled += segment;
    }
    points.push(curve[curve.len() - 1]);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_equally_spaced_and_keep_the_ends() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]];
        let polygon = corners.map(|[x, y]| Vector3::new(x, y, 0.0));
        assert_eq!(length(&polygon), 4.0);
        let points = equally_spaced(&polygon, 9);
        let expected = [0.0, 0.5, 1.0].map(|x| Vector3::new(x, 0.0, 0.0));
        assert_eq!(points.len(), 9);
        for (point, expected) in points.iter().zip(expected) {
            assert!((point - expected).norm() < 1e-15);
        }
        assert_eq!(points[8], Vector3::new(-1.0, 1.0, 0.0));
    }
}
