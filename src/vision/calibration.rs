//! Calibration of a camera from pictures of a checkerboard.
//!
//! Homographies of the views give focal lengths and principal point in closed form (Zhang, IEEE TPAMI 22:1330,
//! 2000); Levenberg and Marquardt's method then brings the sum of squared reprojection errors over lens and poses
//! to its minimum.

use super::camera::{Camera, Lens};
use super::checkerboard::Checkerboard;
use super::{Point, VisionError};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix2x3, Matrix3, Rotation3, SMatrix, Translation3,
    UnitQuaternion, Vector3,
};

/// A calibrated lens, and where the board was.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The lens.
    pub lens: Lens,
    /// For each view the board in the camera's axes.
    pub boards: Vec<Isometry3<f64>>,
    /// Root mean square of the distances between found and computed corners over all views, pixels.
    pub reprojection_rms: f64,
    /// The same for each view.
    pub view_rms: Vec<f64>,
    /// Standard deviations of fx, fy, cx, cy, k1, k2, p1, p2, k3, from the scatter of the corners.
    pub lens_deviations: [f64; 9],
}

impl Calibration {
    /// The camera of a view whose board lies on the table and is the origin of the world: its corner at the lower
    /// left, x to the right, y upwards in the picture, z up. `height` is that of the board's face.
    pub fn camera(&self, view: usize, width: u32, height: u32) -> Camera {
        Camera {
            width,
            height,
            lens: self.lens,
            pose: self.boards[view].inverse(),
            table_height: 0.0,
        }
    }
}

const LENS: usize = 9;
const POSE: usize = 6;

/// Calibrates a lens from the corners found in several views.
///
/// # Errors
/// There are fewer than three views, or they are too much alike: pictures from one direction do not tell the focal
/// length from the distance.
pub fn calibrate(
    board: &Checkerboard,
    views: &[Vec<Point>],
    width: u32,
    height: u32,
) -> Result<Calibration, VisionError> {
    let undetermined = |reason: &str| VisionError::Undetermined {
        problem: "the camera",
        reason: reason.into(),
    };
    if views.len() < 3 {
        return Err(undetermined(
            "pictures of the board in three different poses are the least; ten or more are good",
        ));
    }
    let homographies: Option<Vec<Matrix3<f64>>> =
        views.iter().map(|view| homography(board, view)).collect();
    let alike =
        "the poses of the board are too much alike; tilt it by 20° to 45° to different sides";
    let homographies = homographies.ok_or_else(|| undetermined("the corners lie on a line"))?;
    let lens = first_lens(&homographies, width, height).ok_or_else(|| undetermined(alike))?;
    let mut state = State {
        lens,
        boards: homographies
            .iter()
            .map(|homography| first_pose(homography, &lens))
            .collect::<Option<_>>()
            .ok_or_else(|| undetermined(alike))?,
    };
    let normal = state
        .minimise(board, views)
        .ok_or_else(|| undetermined(alike))?;
    let view_squares: Vec<f64> = (0..views.len())
        .map(|view| state.residuals(board, view, &views[view]).norm_squared())
        .collect();
    let corners = board.corners() as f64;
    let total: f64 = view_squares.iter().sum();
    let unknowns = (LENS + POSE * views.len()) as f64;
    let observations = 2.0 * corners * views.len() as f64;
    let variance = total / (observations - unknowns).max(1.0);
    let covariance = normal.try_inverse().ok_or_else(|| undetermined(alike))? * variance;
    let mut lens_deviations = [0.0; LENS];
    for (index, deviation) in lens_deviations.iter_mut().enumerate() {
        *deviation = covariance[(index, index)].max(0.0).sqrt();
    }
    Ok(Calibration {
        lens: state.lens,
        boards: state.boards,
        reprojection_rms: (total / (corners * views.len() as f64)).sqrt(),
        view_rms: view_squares
            .iter()
            .map(|square| (square / corners).sqrt())
            .collect(),
        lens_deviations,
    })
}

/// The board's pose in the axes of a camera whose lens is known, and the root mean square reprojection error.
///
/// # Errors
/// The corners do not determine a pose.
pub fn board_pose(
    board: &Checkerboard,
    corners: &[Point],
    lens: &Lens,
) -> Result<(Isometry3<f64>, f64), VisionError> {
    let undetermined = || VisionError::Undetermined {
        problem: "the pose of the board",
        reason: "its corners lie on a line, or outside of what the lens images".into(),
    };
    let ideal: Option<Vec<Point>> = corners
        .iter()
        .map(|corner| lens.direction(*corner))
        .collect();
    let homography =
        homography(board, &ideal.ok_or_else(undetermined)?).ok_or_else(undetermined)?;
    let unit = Lens {
        focal: [1.0; 2],
        centre: [0.0; 2],
        distortion: [0.0; 5],
    };
    let mut state = State {
        lens: *lens,
        boards: vec![first_pose(&homography, &unit).ok_or_else(undetermined)?],
    };
    let views = [corners.to_vec()];
    state
        .minimise_poses(board, &views)
        .ok_or_else(undetermined)?;
    let square = state.residuals(board, 0, corners).norm_squared();
    Ok((state.boards[0], (square / corners.len() as f64).sqrt()))
}

/// Homography from the board to pixels, by the direct linear transformation with normalised coordinates.
fn homography(board: &Checkerboard, corners: &[Point]) -> Option<Matrix3<f64>> {
    let plane: Vec<Point> = (0..board.corners())
        .map(|index| board.corner(index))
        .collect();
    let (from, scaled_plane) = normalised(&plane)?;
    let (to, scaled_corners) = normalised(corners)?;
    let mut matrix = SMatrix::<f64, 9, 9>::zeros();
    for (p, q) in scaled_plane.iter().zip(&scaled_corners) {
        let rows = [
            [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -q.x * p.x, -q.x * p.y, -q.x],
            [0.0, 0.0, 0.0, p.x, p.y, 1.0, -q.y * p.x, -q.y * p.y, -q.y],
        ];
        for row in rows {
            let row = nalgebra::SVector::<f64, 9>::from(row);
            matrix += row * row.transpose();
        }
    }
    let eigen = matrix.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let h = eigen.eigenvectors.column(least);
    let scaled = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8]);
    let homography = to.try_inverse()? * scaled * from;
    (homography.determinant().abs() > 1e-12).then_some(homography)
}

/// Points moved and scaled to mean 0 and mean distance √2, and the transformation that does it.
fn normalised(points: &[Point]) -> Option<(Matrix3<f64>, Vec<Point>)> {
    let middle = points.iter().sum::<Point>() / points.len() as f64;
    let spread: f64 = points.iter().map(|point| (point - middle).norm()).sum();
    let spread = spread / points.len() as f64;
    if !(spread > 0.0) {
        return None;
    }
    let scale = std::f64::consts::SQRT_2 / spread;
    let matrix = Matrix3::new(
        scale,
        0.0,
        -scale * middle.x,
        0.0,
        scale,
        -scale * middle.y,
        0.0,
        0.0,
        1.0,
    );
    let moved = points
        .iter()
        .map(|point| (point - middle) * scale)
        .collect();
    Some((matrix, moved))
}

/// Focal lengths for the principal point in the middle of the picture: columns of a homography are images of
/// orthogonal directions of equal length, which is linear in 1/fx² and 1/fy².
fn first_lens(homographies: &[Matrix3<f64>], width: u32, height: u32) -> Option<Lens> {
    let centre = [
        0.5 * (f64::from(width) - 1.0),
        0.5 * (f64::from(height) - 1.0),
    ];
    let mut normal = nalgebra::Matrix2::zeros();
    let mut right = nalgebra::Vector2::zeros();
    for homography in homographies {
        let shift = Matrix3::new(1.0, 0.0, -centre[0], 0.0, 1.0, -centre[1], 0.0, 0.0, 1.0);
        let h = shift * homography;
        let h = h / h.norm();
        let (a, b) = (h.column(0), h.column(1));
        let equations = [
            ([a[0] * b[0], a[1] * b[1]], -a[2] * b[2]),
            (
                [a[0] * a[0] - b[0] * b[0], a[1] * a[1] - b[1] * b[1]],
                b[2] * b[2] - a[2] * a[2],
            ),
        ];
        for (row, value) in equations {
            let row = nalgebra::Vector2::from(row);
            normal += row * row.transpose();
            right += row * value;
        }
    }
    let [x, y]: [f64; 2] = (normal.try_inverse()? * right).into();
    let plausible = |square: f64| {
        let focal = (1.0 / square).sqrt();
        let size = f64::from(width.max(height));
        (focal > 0.1 * size && focal < 100.0 * size).then_some(focal)
    };
    Some(Lens {
        focal: [plausible(x)?, plausible(y)?],
        centre,
        distortion: [0.0; 5],
    })
}

/// Pose of the plane of a homography in front of a lens without distortion.
fn first_pose(homography: &Matrix3<f64>, lens: &Lens) -> Option<Isometry3<f64>> {
    let camera = Matrix3::new(
        lens.focal[0],
        0.0,
        lens.centre[0],
        0.0,
        lens.focal[1],
        lens.centre[1],
        0.0,
        0.0,
        1.0,
    );
    let columns = camera.try_inverse()? * homography;
    let scale = 2.0 / (columns.column(0).norm() + columns.column(1).norm());
    // In front of the camera.
    let scale = if columns[(2, 2)] < 0.0 { -scale } else { scale };
    let (x, y) = (columns.column(0) * scale, columns.column(1) * scale);
    let rotation = Rotation3::from_matrix(&Matrix3::from_columns(&[x, y, x.cross(&y)]));
    let translation = columns.column(2) * scale;
    let finite = translation.iter().all(|value| value.is_finite());
    finite.then(|| {
        Isometry3::from_parts(
            Translation3::from(translation),
            UnitQuaternion::from_rotation_matrix(&rotation),
        )
    })
}

/// What is varied: the lens and the poses of the boards.
#[derive(Clone)]
struct State {
    lens: Lens,
    boards: Vec<Isometry3<f64>>,
}

impl State {
    fn residuals(&self, board: &Checkerboard, view: usize, corners: &[Point]) -> DVector<f64> {
        let mut residuals = DVector::zeros(2 * corners.len());
        for (index, corner) in corners.iter().enumerate() {
            let seen = self.seen(board, view, index);
            let found = self
                .lens
                .image(Point::new(seen.x / seen.z, seen.y / seen.z));
            residuals[2 * index] = found.x - corner.x;
            residuals[2 * index + 1] = found.y - corner.y;
        }
        residuals
    }

    fn seen(&self, board: &Checkerboard, view: usize, corner: usize) -> Vector3<f64> {
        let place = board.corner(corner);
        (self.boards[view] * nalgebra::Point3::new(place.x, place.y, 0.0)).coords
    }

    /// Adds a view's JᵀJ and Jᵀr; a pose's unknowns turn the board about the camera's axes, then move it.
    fn accumulate(
        &self,
        board: &Checkerboard,
        view: usize,
        corners: &[Point],
        normal: &mut DMatrix<f64>,
        gradient: &mut DVector<f64>,
    ) -> f64 {
        let residuals = self.residuals(board, view, corners);
        let offset = LENS + POSE * view;
        for index in 0..corners.len() {
            let seen = self.seen(board, view, index);
            let z = seen.z;
            let (by_direction, by_lens) = self.lens.derivatives(Point::new(seen.x / z, seen.y / z));
            let by_seen = by_direction
                * Matrix2x3::new(
                    1.0 / z,
                    0.0,
                    -seen.x / (z * z),
                    0.0,
                    1.0 / z,
                    -seen.y / (z * z),
                );
            let turned = seen - self.boards[view].translation.vector;
            let by_turn = -by_seen * turned.cross_matrix();
            for axis in 0..2 {
                let mut row: Vec<(usize, f64)> = (0..LENS).map(|k| (k, by_lens[k][axis])).collect();
                row.extend((0..3).map(|k| (offset + k, by_turn[(axis, k)])));
                row.extend((0..3).map(|k| (offset + 3 + k, by_seen[(axis, k)])));
                let residual = residuals[2 * index + axis];
                for (i, a) in &row {
                    gradient[*i] += a * residual;
                    for (j, b) in &row {
                        normal[(*i, *j)] += a * b;
                    }
                }
            }
        }
        residuals.norm_squared()
    }

    fn moved(&self, step: &DVector<f64>) -> Self {
        let mut moved = self.clone();
        for axis in 0..2 {
            moved.lens.focal[axis] += step[axis];
            moved.lens.centre[axis] += step[2 + axis];
        }
        for (index, coefficient) in moved.lens.distortion.iter_mut().enumerate() {
            *coefficient += step[4 + index];
        }
        for (view, pose) in moved.boards.iter_mut().enumerate() {
            let part = |k: usize| step[LENS + POSE * view + k];
            let turn = UnitQuaternion::new(Vector3::new(part(0), part(1), part(2)));
            pose.rotation = turn * pose.rotation;
            pose.translation.vector += Vector3::new(part(3), part(4), part(5));
        }
        moved
    }

    fn minimise(&mut self, board: &Checkerboard, views: &[Vec<Point>]) -> Option<DMatrix<f64>> {
        self.levenberg_marquardt(board, views, 0)
    }

    fn minimise_poses(&mut self, board: &Checkerboard, views: &[Vec<Point>]) -> Option<()> {
        self.levenberg_marquardt(board, views, LENS).map(drop)
    }

    /// Brings the sum of squares to its minimum; unknowns below `first` stay as they are. Returns JᵀJ there.
    fn levenberg_marquardt(
        &mut self,
        board: &Checkerboard,
        views: &[Vec<Point>],
        first: usize,
    ) -> Option<DMatrix<f64>> {
        let unknowns = LENS + POSE * views.len();
        let assemble = |state: &Self| {
            let mut normal = DMatrix::zeros(unknowns, unknowns);
            let mut gradient = DVector::zeros(unknowns);
            let mut sum = 0.0;
            for (view, corners) in views.iter().enumerate() {
                sum += state.accumulate(board, view, corners, &mut normal, &mut gradient);
            }
            (normal, gradient, sum)
        };
        let (mut normal, mut gradient, mut sum) = assemble(self);
        let mut damping = 1e-3;
        for _ in 0..200 {
            let size = unknowns - first;
            let mut damped = normal.view((first, first), (size, size)).into_owned();
            for index in 0..size {
                damped[(index, index)] *= 1.0 + damping;
            }
            let right = gradient.rows(first, size).into_owned();
            let solved = damped.cholesky()?.solve(&right);
            let mut step = DVector::zeros(unknowns);
            step.rows_mut(first, size).copy_from(&-&solved);
            let moved = self.moved(&step);
            let in_front = (0..views.len())
                .all(|view| (0..board.corners()).all(|k| moved.seen(board, view, k).z > 1e-6));
            let (new_normal, new_gradient, new_sum) = assemble(&moved);
            if in_front && new_sum.is_finite() && new_sum <= sum {
                let gained = sum - new_sum;
                *self = moved;
                (normal, gradient, sum) = (new_normal, new_gradient, new_sum);
                damping = (damping * 0.3).max(1e-12);
                if gained <= 1e-13 * sum.max(1e-12) {
                    return Some(normal);
                }
            } else {
                damping *= 8.0;
                if damping > 1e12 {
                    return Some(normal);
                }
            }
        }
        Some(normal)
    }
}

#[cfg(test)]
mod tests {
    use super::super::camera::tests::slanted_camera;
    use super::super::render::{RenderOptions, render};
    use super::*;

    const BOARD: Checkerboard = Checkerboard {
        columns: 8,
        rows: 5,
        square: 0.03,
    };

    /// Cameras about the board, which lies on the table with its lower left inner corner at the origin.
    fn cameras(count: usize) -> Vec<Camera> {
        let middle = Vector3::new(0.105, 0.06, 0.0);
        (0..count)
            .map(|index| {
                let turn = index as f64 * 2.4;
                let tilt = if index == 0 { 0.05 } else { 0.55 };
                let down =
                    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
                let rotation = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3 * (turn.sin()))
                    * UnitQuaternion::new(Vector3::new(turn.cos(), turn.sin(), 0.0) * tilt)
                    * down;
                let away = 0.42 + 0.05 * (1.7 * turn).sin();
                let aim = middle + Vector3::new(0.05 * turn.sin(), 0.03 * turn.cos(), 0.0);
                Camera {
                    width: 800,
                    height: 600,
                    lens: Lens {
                        focal: [760.0, 755.0],
                        centre: [405.0, 296.0],
                        distortion: [-0.12, 0.1, 0.0008, -0.0005, 0.0],
                    },
                    pose: Isometry3::from_parts(
                        Translation3::from(aim - rotation * Vector3::z() * away),
                        rotation,
                    ),
                    table_height: 0.0,
                }
            })
            .collect()
    }

    fn picture(camera: &Camera, seed: u64) -> image::RgbImage {
        let ground = |point: Point| {
            let (x, y) = ((point.x / 0.03).floor(), (point.y / 0.03).floor());
            // The square to the lower right of the corner at the top left is dark.
            let inside = (-1.0..8.0).contains(&x) && (-1.0..5.0).contains(&y);
            let dark = (x + y).rem_euclid(2.0) == 1.0;
            if inside && dark {
                [35.0; 3]
            } else {
                [215.0; 3]
            }
        };
        let options = RenderOptions {
            seed,
            ..RenderOptions::default()
        };
        render(camera, &[], ground, &options)
    }

    #[test]
    fn exact_corners_give_the_exact_camera() {
        let cameras = cameras(6);
        let views: Vec<Vec<Point>> = cameras
            .iter()
            .map(|camera| {
                (0..BOARD.corners())
                    .map(|index| {
                        let place = BOARD.corner(index);
                        camera
                            .project(Vector3::new(place.x, place.y, 0.0))
                            .expect("in front")
                    })
                    .collect()
            })
            .collect();
        let found = calibrate(&BOARD, &views, 800, 600).expect("a calibration");
        let truth = cameras[0].lens;
        assert!(found.reprojection_rms < 1e-6, "{}", found.reprojection_rms);
        for axis in 0..2 {
            assert!((found.lens.focal[axis] - truth.focal[axis]).abs() < 1e-3);
            assert!((found.lens.centre[axis] - truth.centre[axis]).abs() < 1e-3);
        }
        assert!((found.lens.distortion[0] - truth.distortion[0]).abs() < 1e-5);
        let (pose, rms) = board_pose(&BOARD, &views[1], &truth).expect("a pose");
        let expected = cameras[1].pose.inverse();
        assert!(rms < 1e-6);
        assert!((pose.translation.vector - expected.translation.vector).norm() < 1e-8);
    }

    #[test]
    fn rendered_boards_calibrate_the_camera() {
        let cameras = cameras(10);
        let views: Vec<Vec<Point>> = cameras
            .iter()
            .enumerate()
            .map(|(seed, camera)| BOARD.find(&picture(camera, seed as u64)).expect("a board"))
            .collect();
        let mut worst: f64 = 0.0;
        for (camera, view) in cameras.iter().zip(&views) {
            for (index, corner) in view.iter().enumerate() {
                let place = BOARD.corner(index);
                let truth = camera.project(Vector3::new(place.x, place.y, 0.0));
                worst = worst.max((truth.expect("in front") - corner).norm());
            }
        }
        assert!(worst < 0.3, "a corner is {worst} pixels off");
        let found = calibrate(&BOARD, &views, 800, 600).expect("a calibration");
        assert!(found.reprojection_rms < 0.1, "{}", found.reprojection_rms);
        // A camera at 0.6 m from a board on the table.
        let mut far = cameras[3];
        let aim = Vector3::new(0.105, 0.06, 0.0);
        let view = far.pose.rotation * Vector3::z();
        far.pose.translation.vector = aim - view * 0.6;
        let corners = BOARD.find(&picture(&far, 99)).expect("a board");
        let aim = nalgebra::Point3::from(aim);
        let (pose, _) = board_pose(&BOARD, &corners, &far.lens).expect("a pose");
        let off = (pose * aim - far.pose.inverse() * aim).norm();
        assert!(off < 0.1e-3, "with the true lens the pose is {off} m off");
        // The principal point found is uncertain by some tenths of a pixel, which turns the camera instead of
        // moving it: what lies on the table stays in place.
        let (pose, _) = board_pose(&BOARD, &corners, &found.lens).expect("a pose");
        let off = (pose * aim - far.pose.inverse() * aim).norm();
        assert!(off < 0.5e-3, "with the lens found the pose is {off} m off");
        let calibrated = Camera {
            lens: found.lens,
            pose: pose.inverse(),
            ..far
        };
        for (x, y) in [(0.0, 0.0), (0.21, 0.0), (0.105, 0.06), (-0.05, 0.15)] {
            let pixel = far.project(Vector3::new(x, y, 0.0)).expect("in front");
            let located = calibrated.on_table(pixel).expect("on the table");
            let off = (located - Point::new(x, y)).norm();
            assert!(off < 0.1e-3, "({x}, {y}) is {off} m off");
        }
    }

    #[test]
    fn views_from_one_direction_are_refused() {
        let camera = slanted_camera();
        let view: Vec<Point> = (0..BOARD.corners())
            .map(|index| {
                let place = BOARD.corner(index);
                camera
                    .project(Vector3::new(place.x, place.y, 0.0))
                    .expect("in front")
            })
            .collect();
        let error = calibrate(&BOARD, &[view.clone(), view], 1280, 720).expect_err("two views");
        assert!(error.to_string().contains("three"), "{error}");
    }

    #[test]
    fn a_board_that_is_not_there_is_named() {
        let empty = image::RgbImage::from_pixel(200, 100, image::Rgb([128; 3]));
        let error = BOARD.find(&empty).expect_err("no board").to_string();
        assert!(error.contains("the checkerboard was not found"), "{error}");
    }
}
