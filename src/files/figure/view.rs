//! Views of rods.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// An orthographic view: lengths across it are true everywhere, so that one scale bar applies to
/// the whole picture.
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

/// Elevations of oblique views: of most scenes, and of flat horizontal ones, rad.
const LOW: f64 = 15.0 * std::f64::consts::PI / 180.0;
const HIGH: f64 = 40.0 * std::f64::consts::PI / 180.0;
/// Largest angle between the thin axis of a flat horizontal scene and the vertical, rad.
const STEEP: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// Ratio of the least extent to the next larger one, as variances, below which a scene is thin.
const THIN: f64 = 0.05;

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
        Self::turned(0.0, LOW)
    }

    /// View from the front, rotated about z by an angle, slightly from the right; from above by an
    /// elevation, rad.
    fn turned(angle: f64, elevation: f64) -> Self {
        let azimuth = angle + 20f64.to_radians();
        Self::from(Vector3::new(
            libm::sin(azimuth) * libm::cos(elevation),
            -libm::cos(azimuth) * libm::cos(elevation),
            libm::sin(elevation),
        ))
    }

    /// The same view, or one from slightly above if it is level, so that the ground is seen as a
    /// plane in three dimensions.
    pub(super) fn raised(&self) -> Self {
        let horizontal = libm::hypot(self.eye.x, self.eye.y);
        if self.eye.z.abs() >= libm::sin(LOW) || horizontal == 0.0 {
            return *self;
        }
        let [x, y] = [self.eye.x, self.eye.y].map(|part| part / horizontal * libm::cos(LOW));
        Self::from(Vector3::new(x, y, libm::sin(LOW)))
    }

    /// A view that shows the points well: normal to the plane of flat scenes; along the axis of
    /// the least extent if that is much smaller than the others; otherwise oblique.
    pub fn fitting<'a>(points: impl Iterator<Item = &'a Vector3<f64>> + Clone) -> Self {
        // Extents (as variances) below these fractions of the next larger one count as zero.
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
            // Of the two sides, choose the one from which x points right, or y if x is not
            // visible.
            Self::from(normal * normal.dot(&Vector3::new(1.0, -1.0, 1.0)).signum())
        } else if small < THIN * middle {
            Self::across(&eigenvectors.column(order[0]).into_owned())
        } else {
            Self::oblique()
        }
    }

    /// An oblique view that shows a thin scene from one of its broad sides, given the normal to them.
    fn across(normal: &Vector3<f64>) -> Self {
        if normal.z.abs() > libm::cos(STEEP) {
            return Self::turned(0.0, HIGH);
        }
        // Of the two sides, choose the one nearer to the front, or the right one.
        let side = if normal.y.abs() > 1e-6 {
            -normal.y
        } else {
            normal.x
        };
        let [x, y] = [normal.x, normal.y].map(|part| part * side.signum());
        Self::turned(libm::atan2(x, -y), LOW)
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

    #[test]
    fn thin_things_are_seen_from_a_broad_side_and_from_above() {
        let arch = |along: Vector3<f64>, up: Vector3<f64>| -> Vec<Vector3<f64>> {
            let across = along.cross(&up);
            (0..=20)
                .map(|k| std::f64::consts::PI * f64::from(k) / 20.0)
                .map(|s| -along * s.cos() + up * s.sin() + across * (0.05 * (3.0 * s).sin()))
                .collect()
        };
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let eye = |along, up| View::fitting(arch(along, up).iter()).eye;
        for along in [x, y, (x + y).normalize()] {
            let eye = eye(along, z);
            assert!(eye.dot(&along).abs() < 0.5, "{eye:?} along the arch");
            assert!((eye.z - LOW.sin()).abs() < 1e-9, "{eye:?}");
        }
        assert!(eye(x, y).z > 0.6, "from above");
        assert!((eye(x, z) - View::oblique().eye).norm() < 1e-6);
    }

    #[test]
    fn level_views_are_raised_and_others_kept() {
        let raised = View::from(-Vector3::y()).raised();
        frame_is_right_handed(&raised);
        assert!((raised.eye.z - LOW.sin()).abs() < 1e-12 && raised.eye.y < -0.9);
        for view in [View::oblique(), View::from(Vector3::z())] {
            assert_eq!(view.raised(), view);
        }
    }
}
