//! The best-fit circle of points in space.

use rodlab_engine::mechanics::{Matrix3, Vector3};

/// A circle in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedCircle {
    /// Centre, m.
    pub centre: Vector3,
    /// Unit normal of its plane.
    pub normal: Vector3,
    /// Radius, m.
    pub radius: f64,
}

/// Fits a circle in the least-squares plane; it minimises the squares of |p − c|² − R² (Kåsa
/// 1976).
///
/// This fit is biased for short arcs, but not for whole circles. `None` for fewer than three
/// points or points on a line.
pub fn fit_circle(points: &[Vector3]) -> Option<FittedCircle> {
    if points.len() < 3 {
        return None;
    }
    let count = points.len() as f64;
    let centroid = points.iter().sum::<Vector3>() / count;
    let scatter: Matrix3 = points
        .iter()
        .map(|point| (point - centroid) * (point - centroid).transpose())
        .sum();
    let eigen = scatter.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let axis = |rank: usize| eigen.eigenvectors.column(order[rank]).into_owned();
    let variance = |rank: usize| eigen.eigenvalues[order[rank]];
    if variance(1) <= 1e-12 * variance(0) {
        return None;
    }
    // With principal axes the normal equations are diagonal: 2 c_u Σu² = Σ u (u² + v²).
    let (mut third_u, mut third_v, mut square) = (0.0, 0.0, 0.0);
    for point in points {
        let (u, v) = (
            axis(0).dot(&(point - centroid)),
            axis(1).dot(&(point - centroid)),
        );
        let distance = u * u + v * v;
        third_u += u * distance;
        third_v += v * distance;
        square += distance;
    }
    let (u, v) = (0.5 * third_u / variance(0), 0.5 * third_v / variance(1));
    Some(FittedCircle {
        centre: centroid + axis(0) * u + axis(1) * v,
        normal: axis(2),
        radius: (square / count + u * u + v * v).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_circle_give_it_back() {
        let normal = Vector3::new(1.0, -2.0, 0.5).normalize();
        let first = normal.cross(&Vector3::x()).normalize();
        let second = normal.cross(&first);
        let centre = Vector3::new(0.3, -0.1, 2.0);
        for arc in [2.0, 4.0, 6.0] {
            let points: Vec<Vector3> = (0..=50)
                .map(|k| arc * f64::from(k) / 50.0)
                .map(|t| centre + (first * t.cos() + second * t.sin()) * 0.07)
                .collect();
            let circle = fit_circle(&points).unwrap();
            assert!((circle.centre - centre).norm() < 1e-12);
            assert!((circle.radius - 0.07).abs() < 1e-12);
            assert!((circle.normal.dot(&normal).abs() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn lines_and_pairs_have_no_circle() {
        let line: Vec<Vector3> = (0..5).map(|k| Vector3::x() * f64::from(k)).collect();
        assert_eq!(fit_circle(&line), None);
        assert_eq!(fit_circle(&line[..2]), None);
    }
}
