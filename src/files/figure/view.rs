//! Views of rods.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// An orthographic view: lengths across it are true everywhere, so that one scale bar is valid for
/// all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Unit vector to the right of the picture.
    right: Vector3<f64>,
    /// Unit vector to its top.
    up: Vector3<f64>,
    /// Unit vector to the eye.
    eye: Vector3<f64>,
}

/// A point on the picture: right, up, and nearness to the eye, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Projected {
    pub x: f64,
    pub y: f64,
    pub nearness: f64,
}

impl View {
    /// View from the direction `eye`, with z up (y up if the eye is above or below).
    pub fn from(eye: Vector3<f64>) -> Self {
        let eye = eye.normalize();
        let upright = if eye.z.abs() < 0.9 {
            Vector3::z()
        } else {
            Vector3::y()
        };
        let right = upright.cross(&eye).normalize();
        Self {
            right,
            up: eye.cross(&right),
            eye,
        }
    }

    /// View from the front (−y), slightly from the right and from above.
    pub fn oblique() -> Self {
        let (azimuth, elevation) = (20f64.to_radians(), 15f64.to_radians());
        Self::from(Vector3::new(
            libm::sin(azimuth) * libm::cos(elevation),
            -libm::cos(azimuth) * libm::cos(elevation),
            libm::sin(elevation),
        ))
    }

    /// A view that shows the points well: normal to the plane of flat scenes, oblique for all
    /// others.
    pub fn fitting<'a>(points: impl Iterator<Item = &'a Vector3<f64>> + Clone) -> Self {
        // Extents (as variances) below these shares of the next larger one count as zero.
        const FLAT: f64 = 1e-4;
        const STRAIGHT: f64 = 1e-6;
        let count = points.clone().count().max(1) as f64;
        let mean = points.clone().sum::<Vector3<f64>>() / count;
        let scatter: Matrix3<f64> = points
            .map(|point| (point - mean) * (point - mean).transpose())
            .sum();
        let SymmetricEigen {
            eigenvalues,
            eigenvectors,
        } = scatter.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigenvalues[a].total_cmp(&eigenvalues[b]));
        let [small, middle, large] = order.map(|axis| eigenvalues[axis]);
        if small < FLAT * middle && middle > STRAIGHT * large {
            let normal = eigenvectors.column(order[0]).into_owned();
            // Of the two sides, the one from which x points right, or y if x is not visible.
            Self::from(normal * normal.dot(&Vector3::new(1.0, -1.0, 1.0)).signum())
        } else {
            Self::oblique()
        }
    }

    /// Unit vector to the eye.
    pub(super) fn eye(&self) -> Vector3<f64> {
        self.eye
    }

    pub(super) fn project(&self, point: &Vector3<f64>) -> Projected {
        Projected {
            x: self.right.dot(point),
            y: self.up.dot(point),
            nearness: self.eye.dot(point),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame_is_right_handed(view: &View) {
        assert!((view.right.cross(&view.up) - view.eye).norm() < 1e-12);
        assert!((view.right.norm() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn flat_things_are_seen_square_on_with_x_to_the_right_and_z_up() {
        let arc = |axes: [Vector3<f64>; 2]| -> Vec<Vector3<f64>> {
            (0..20)
                .map(|k| 0.1 * k as f64)
                .map(|s| Vector3::new(3.0, 1.0, 2.0) + axes[0] * s.sin() + axes[1] * s.cos())
                .collect()
        };
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        for (plane, right, up) in [([x, z], x, z), ([x, y], x, y), ([y, z], y, z)] {
            let view = View::fitting(arc(plane).iter());
            frame_is_right_handed(&view);
            assert!((view.right - right).norm() < 1e-6, "{view:?}");
            assert!((view.up - up).norm() < 1e-6, "{view:?}");
        }
    }

    #[test]
    fn spatial_and_straight_things_are_seen_obliquely() {
        let helix: Vec<_> = (0..50)
            .map(|k| 0.3 * k as f64)
            .map(|s| Vector3::new(s.cos(), s.sin(), 0.2 * s))
            .collect();
        let line: Vec<_> = (0..5).map(|k| Vector3::new(k as f64, 0.0, 0.0)).collect();
        for points in [helix, line, vec![]] {
            let view = View::fitting(points.iter());
            frame_is_right_handed(&view);
            assert_eq!(view, View::oblique());
        }
    }
}
