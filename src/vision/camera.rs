//! A pinhole camera with lens distortion, its pose, and the table in its view.

use super::{Point, VisionError};
use nalgebra::{Isometry3, Vector3};

/// Lens of a camera: focal lengths, principal point and distortion.
///
/// The camera's axes are x to the right, y down, and z along the view. A point (X, Y, Z) in these
/// axes has x = X/Z, y = Y/Z and, with r² = x² + y² (Brown 1971; the five coefficients as OpenCV
/// orders them),
///
/// x' = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2 x²),
/// y' = y (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2 y²) + 2 p2 x y,
///
/// u = fx x' + cx, v = fy y' + cy, in pixels; (0, 0) is the centre of the first pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Focal lengths fx, fy, pixels.
    pub focal: [f64; 2],
    /// Principal point cx, cy, pixels.
    pub centre: [f64; 2],
    /// k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
}

impl Lens {
    /// Pixel of a direction given by (X/Z, Y/Z).
    pub fn image(&self, direction: Point) -> Point {
        let distorted = self.distort(direction).0;
        Point::new(
            self.focal[0] * distorted.x + self.centre[0],
            self.focal[1] * distorted.y + self.centre[1],
        )
    }

    /// The distorted direction, and its derivatives by x and y.
    fn distort(&self, direction: Point) -> (Point, nalgebra::Matrix2<f64>) {
        let [k1, k2, p1, p2, k3] = self.distortion;
        let (x, y) = (direction.x, direction.y);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let slope = k1 + r2 * (2.0 * k2 + 3.0 * k3 * r2);
        let distorted = Point::new(
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let mixed = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
        let derivatives = nalgebra::Matrix2::new(
            radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            mixed,
            mixed,
            radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        );
        (distorted, derivatives)
    }

    /// Direction (X/Z, Y/Z) that is imaged at a pixel, by Newton's method; `None` if the
    /// distortion is not invertible.
    pub fn direction(&self, pixel: Point) -> Option<Point> {
        let target = Point::new(
            (pixel.x - self.centre[0]) / self.focal[0],
            (pixel.y - self.centre[1]) / self.focal[1],
        );
        let mut direction = target;
        for _ in 0..30 {
            let (distorted, derivatives) = self.distort(direction);
            let residual = distorted - target;
            if residual.norm() < 1e-13 {
                break;
            }
            let step = derivatives.try_inverse()? * residual;
            // Far from the centre a full step may leave the range in which the polynomial
            // increases.
            let limit = 0.25 / step.norm().max(0.25);
            direction -= step * limit;
        }
        let (distorted, derivatives) = self.distort(direction);
        let found = (distorted - target).norm() < 1e-9 && derivatives.determinant() > 0.0;
        found.then_some(direction)
    }

    /// Derivatives of [`image`](Self::image) by direction, and by fx, fy, cx, cy, k1, k2, p1, p2, k3.
    pub(super) fn derivatives(&self, direction: Point) -> (nalgebra::Matrix2<f64>, [Point; 9]) {
        let (distorted, by_direction) = self.distort(direction);
        let (x, y) = (direction.x, direction.y);
        let r2 = x * x + y * y;
        let [fx, fy] = self.focal;
        let scaled = |dx: f64, dy: f64| Point::new(fx * dx, fy * dy);
        let by_direction = nalgebra::Matrix2::new(fx, 0.0, 0.0, fy) * by_direction;
        let by_lens = [
            Point::new(distorted.x, 0.0),
            Point::new(0.0, distorted.y),
            Point::x(),
            Point::y(),
            scaled(x * r2, y * r2),
            scaled(x * r2 * r2, y * r2 * r2),
            scaled(2.0 * x * y, r2 + 2.0 * y * y),
            scaled(r2 + 2.0 * x * x, 2.0 * x * y),
            scaled(x * r2 * r2 * r2, y * r2 * r2 * r2),
        ];
        (by_direction, by_lens)
    }
}

/// A camera and a table with a horizontal top in the world, whose z axis points up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Width of the picture, pixels.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Lens of the camera.
    pub lens: Lens,
    /// Pose of the camera's axes in the world, metres: x to the right of the image, y down, z
    /// along the view.
    pub pose: Isometry3<f64>,
    /// Height z of the plane on which image points are located, metres.
    pub table_height: f64,
}

impl Camera {
    /// Pixel of a point of the world in metres; `None` for a point behind the camera.
    pub fn project(&self, point: Vector3<f64>) -> Option<Point> {
        let seen = self.pose.inverse_transform_point(&point.into());
        (seen.z > 1e-9).then(|| {
            self.lens
                .image(Point::new(seen.x / seen.z, seen.y / seen.z))
        })
    }

    /// x and y in the world, metres, of the point of the table at a pixel.
    ///
    /// # Errors
    /// The ray through the pixel does not meet the table, or no direction is imaged there.
    pub fn on_table(&self, pixel: Point) -> Result<Point, VisionError> {
        self.on_plane(pixel, self.table_height)
    }

    /// Locates a pixel on a horizontal plane at another height z.
    ///
    /// # Errors
    /// See [`on_table`](Self::on_table).
    pub fn on_plane(&self, pixel: Point, height: f64) -> Result<Point, VisionError> {
        let missing = |reason: &str| VisionError::NotFound {
            what: "a point of the table",
            reason: format!("pixel ({:.1}, {:.1}): {reason}", pixel.x, pixel.y),
        };
        let direction = self
            .lens
            .direction(pixel)
            .ok_or_else(|| missing("the lens distortion cannot be inverted there"))?;
        let ray = self.pose.rotation * Vector3::new(direction.x, direction.y, 1.0);
        let start = self.pose.translation.vector;
        let reach = (height - start.z) / ray.z;
        if !(reach > 0.0) || !reach.is_finite() {
            return Err(missing("its ray does not meet the table"));
        }
        let point = start + ray * reach;
        Ok(Point::new(point.x, point.y))
    }

    /// Rejects pictures with a size other than the camera's, which would give wrong coordinates.
    ///
    /// # Errors
    /// [`VisionError::Size`] for another size.
    pub fn check_size(&self, width: u32, height: u32) -> Result<(), VisionError> {
        if (width, height) == (self.width, self.height) {
            return Ok(());
        }
        Err(VisionError::Size {
            what: "the image".into(),
            found_width: width as usize,
            found_height: height as usize,
            width: self.width as usize,
            height: self.height as usize,
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion};

    /// A camera of a size, in pixels, that looks at a place from a distance, m, rotated from the
    /// view straight down.
    pub fn looking_at(
        aim: Vector3<f64>,
        away: f64,
        turn: UnitQuaternion<f64>,
        [width, height]: [u32; 2],
        (focal, centre, distortion): ([f64; 2], [f64; 2], [f64; 5]),
    ) -> Camera {
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let rotation = turn * down;
        let place = Translation3::from(aim - rotation * Vector3::z() * away);
        Camera {
            width,
            height,
            lens: Lens {
                focal,
                centre,
                distortion,
            },
            pose: Isometry3::from_parts(place, rotation),
            table_height: 0.0,
        }
    }

    /// A camera 0.6 m above a table, which looks down obliquely.
    pub fn slanted_camera() -> Camera {
        let slant = UnitQuaternion::from_euler_angles(0.25, -0.1, 0.3);
        let distortion = [0.08, -0.15, 0.001, -0.0007, 0.05];
        let lens = ([910.0, 905.0], [640.0, 365.0], distortion);
        let mut camera = looking_at(Vector3::zeros(), 0.6, slant, [1280, 720], lens);
        camera.pose.translation = Translation3::new(0.1, 0.2, 0.6);
        camera
    }

    #[test]
    fn pixels_come_back_from_the_table() {
        let camera = slanted_camera();
        for (u, v) in [(0.0, 0.0), (640.0, 365.0), (1279.0, 719.0), (100.0, 600.0)] {
            let pixel = Point::new(u, v);
            let on_table = camera.on_table(pixel).expect("a point");
            let back = camera
                .project(Vector3::new(on_table.x, on_table.y, 0.0))
                .expect("in front");
            assert!((back - pixel).norm() < 1e-8, "{back}");
        }
    }

    #[test]
    fn without_distortion_the_image_is_a_perspective() {
        let mut camera = slanted_camera();
        camera.lens.distortion = [0.0; 5];
        camera.pose = Isometry3::from_parts(
            Translation3::new(0.0, 0.0, 1.0),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI),
        );
        let pixel = camera
            .project(Vector3::new(0.1, 0.2, 0.0))
            .expect("in front");
        assert!((pixel - Point::new(640.0 + 91.0, 365.0 - 181.0)).norm() < 1e-9);
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let lens = slanted_camera().lens;
        let direction = Point::new(0.31, -0.22);
        let (by_direction, by_lens) = lens.derivatives(direction);
        let h = 1e-6;
        for axis in 0..2 {
            let mut step = Point::zeros();
            step[axis] = h;
            let difference =
                (lens.image(direction + step) - lens.image(direction - step)) / (2.0 * h);
            assert!((by_direction.column(axis) - difference).norm() < 1e-4);
        }
        for (parameter, derivative) in by_lens.iter().enumerate() {
            let moved = |sign: f64| {
                let mut lens = lens;
                let value = match parameter {
                    0 | 1 => &mut lens.focal[parameter],
                    2 | 3 => &mut lens.centre[parameter - 2],
                    _ => &mut lens.distortion[parameter - 4],
                };
                *value += sign * h;
                lens.image(direction)
            };
            let difference = (moved(1.0) - moved(-1.0)) / (2.0 * h);
            assert!((derivative - difference).norm() < 1e-4, "{parameter}");
        }
    }

    #[test]
    fn rays_above_the_horizon_are_refused() {
        let mut camera = slanted_camera();
        camera.pose.rotation = UnitQuaternion::identity();
        let error = camera
            .on_table(Point::new(640.0, 300.0))
            .expect_err("a miss");
        assert!(error.to_string().contains("does not meet the table"));
    }
    #[test]
    fn points_are_located_at_the_height_at_which_they_lie() {
        let camera = Camera {
            table_height: 0.13,
            ..slanted_camera()
        };
        for (x, y) in [(0.02, -0.05), (-0.1, 0.07)] {
            let seen = |z: f64| camera.project(Vector3::new(x, y, z)).expect("in front");
            for height in [-0.05, 0.0, 0.2] {
                let found = camera.on_plane(seen(height), height).expect("on the plane");
                assert!(
                    (found - Point::new(x, y)).norm() < 1e-9,
                    "{height}: {found}"
                );
            }
            let found = camera.on_table(seen(0.13)).expect("on the table");
            assert!((found - Point::new(x, y)).norm() < 1e-9, "{found}");
        }
    }
}
