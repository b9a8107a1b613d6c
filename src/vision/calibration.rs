//! Calibration of a camera from pictures of a checkerboard.
//!
//! Homographies of the views give focal lengths and principal point in closed form (Zhang, IEEE
//! TPAMI 22:1330, 2000); Levenberg and Marquardt's method then minimises the sum of squared
//! reprojection errors over lens and poses.

use super::camera::{Camera, Lens};
use super::checkerboard::Checkerboard;
use super::homography::{first_lens, first_pose, homography};
use super::lens_fit::LensMisfit;
use super::reprojection::{LENS, POSE, State};
use super::{Point, VisionError};
use nalgebra::{Isometry3, Matrix3};

/// A calibrated lens and the poses of the board.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The lens.
    pub lens: Lens,
    /// Pose of the board in the camera's axes, for each view.
    pub boards: Vec<Isometry3<f64>>,
    /// Root mean square reprojection error of the corners over all views, pixels.
    pub reprojection_rms: f64,
    /// Root mean square reprojection error of each view, pixels.
    pub view_rms: Vec<f64>,
    /// Standard deviations of fx, fy, cx, cy, k1, k2, p1, p2, k3, from the scatter of the corners,
    /// enlarged if the model does not fit.
    pub lens_deviations: [f64; 9],
    /// The part of the residuals that noise does not explain, if any.
    pub misfit: Option<LensMisfit>,
}

/// Largest radial error of a model that is accepted, pixels.
const MOST_MISFIT: f64 = 0.5;

impl Calibration {
    /// The camera of a view whose board lies on the table and is the origin of the world: its corner at the lower
    /// left, x to the right, y upwards in the picture, z up from its face. `width` and `height` are those of the picture.
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

/// Calibrates a lens from the corners found in several views.
///
/// # Errors
/// There are fewer than three views, or they are too similar, since pictures from one direction do
/// not separate the focal length from the distance; or the lens does not fit the model, such as a
/// fisheye lens.
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
            "pictures of the board in at least three different poses are needed; ten or more are better",
        ));
    }
    let homographies: Option<Vec<Matrix3<f64>>> =
        views.iter().map(|view| homography(board, view)).collect();
    let alike = "the poses of the board are too similar; tilt it by 20° to 45° to different sides";
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
    let misfit = state.misfit(board, views);
    if let Some(misfit) = misfit.filter(|misfit| misfit.radial_error_px > MOST_MISFIT) {
        return Err(undetermined(&format!(
            "the lens does not fit the model (a pinhole with distortion k1, k2, p1, p2, k3): {:.2} px off at {:.0} px from \
             the middle of the picture; fisheye lenses are not supported: use another lens, or \
             crop the pictures to their middle",
            misfit.radial_error_px, misfit.at_radius_px
        )));
    }
    // Errors other than noise do not average out.
    let inflation = misfit.map_or(1.0, |misfit| misfit.inflation());
    let mut lens_deviations = [0.0; LENS];
    for (index, deviation) in lens_deviations.iter_mut().enumerate() {
        *deviation = inflation * covariance[(index, index)].max(0.0).sqrt();
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
        misfit,
    })
}

/// The pose of the board in the axes of a camera with a known lens, and the root mean square
/// reprojection error.
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
        reason: "its corners are on one line, or outside the view of the lens".into(),
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

#[cfg(test)]
mod tests {
    use super::super::camera::tests::{looking_at, slanted_camera};
    use super::super::render::{RenderOptions, render};
    use super::super::trace_tests::Dice;
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

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
                let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3 * (turn.sin()))
                    * UnitQuaternion::new(Vector3::new(turn.cos(), turn.sin(), 0.0) * tilt);
                let away = 0.42 + 0.05 * (1.7 * turn).sin();
                let aim = middle + Vector3::new(0.05 * turn.sin(), 0.03 * turn.cos(), 0.0);
                let distortion = [-0.12, 0.1, 0.0008, -0.0005, 0.0];
                let lens = ([760.0, 755.0], [405.0, 296.0], distortion);
                looking_at(aim, away, turned, [800, 600], lens)
            })
            .collect()
    }

    /// Pixels of the corners of the board.
    fn seen(camera: &Camera) -> Vec<Point> {
        let places = (0..BOARD.corners()).map(|index| BOARD.corner(index).push(0.0));
        let pixels = places.map(|place| camera.project(place).expect("in front"));
        pixels.collect()
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
        let views: Vec<Vec<Point>> = cameras.iter().map(seen).collect();
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
        let camera = found.camera(1, 800, 600);
        assert_eq!((camera.width, camera.height), (800, 600));
        for (index, pixel) in views[1].iter().enumerate() {
            let place = camera.on_table(*pixel).expect("on the table");
            assert!((place - BOARD.corner(index)).norm() < 1e-8, "{place}");
        }
    }

    /// Corners with a reproducible noise of a standard deviation, pixels, in each coordinate.
    fn with_noise(view: &[Point], deviation: f64, dice: &mut Dice) -> Vec<Point> {
        // Uniform between ±√3 deviations.
        let mut noise = || deviation * 12.0_f64.sqrt() * (dice.roll() - 0.5);
        view.iter()
            .map(|corner| corner + Point::new(noise(), noise()))
            .collect()
    }

    /// A least squares solution with p unknowns leaves 1 − p/n of the squares of the noise of n numbers, and is as far
    /// from the truth as it states, in the mean of many.
    #[test]
    fn errors_of_a_calibration_are_those_stated_for_the_noise_of_the_corners() {
        const NOISE: f64 = 0.1;
        let cameras = cameras(6);
        let views: Vec<Vec<Point>> = cameras.iter().map(seen).collect();
        let truth = cameras[0].lens;
        let per_corner = |unknowns: f64, corners: usize| {
            2.0 * NOISE * NOISE * (1.0 - unknowns / (2.0 * corners as f64))
        };
        let mut dice = Dice(3);
        let trials = 12;
        let (mut off, mut square, mut pose_square) = (0.0, 0.0, 0.0);
        for _ in 0..trials {
            let noisy = |view: &Vec<Point>| with_noise(view, NOISE, &mut dice);
            let noisy: Vec<Vec<Point>> = views.iter().map(noisy).collect();
            let found = calibrate(&BOARD, &noisy, 800, 600).expect("a calibration");
            let [numbers, exact] = [found.lens, truth].map(|lens| {
                let ([fx, fy], [cx, cy]) = (lens.focal, lens.centre);
                let [k1, k2, p1, p2, k3] = lens.distortion;
                [fx, fy, cx, cy, k1, k2, p1, p2, k3]
            });
            for k in 0..9 {
                off += ((numbers[k] - exact[k]) / found.lens_deviations[k]).powi(2) / 9.0;
            }
            square += found.reprojection_rms.powi(2);
            let of_views: f64 = found.view_rms.iter().map(|rms| rms * rms).sum();
            assert!((of_views / 6.0 / found.reprojection_rms.powi(2) - 1.0).abs() < 1e-12);
            for view in &noisy {
                let (_, rms) = board_pose(&BOARD, view, &truth).expect("a pose");
                pose_square += rms * rms / 6.0;
            }
        }
        let means = [off, square, pose_square].map(|sum| sum / f64::from(trials));
        let unknowns = (LENS + 6 * POSE) as f64;
        assert!((0.7..1.4).contains(&means[0]), "{means:?}");
        let left = means[1] / per_corner(unknowns, 6 * BOARD.corners());
        let of_pose = means[2] / per_corner(POSE as f64, BOARD.corners());
        assert!((left - 1.0).abs() < 0.05, "{left}");
        assert!((of_pose - 1.0).abs() < 0.05, "{of_pose}");
    }

    /// Corners of boards behind an equidistant fisheye lens of a focal length, pixels, with a reproducible noise of 0.05 pixels.
    fn fisheye_views(focal: f64) -> Vec<Vec<Point>> {
        let mut dice = Dice(7);
        let mut noise = || 0.17 * (dice.roll() - 0.5);
        let middle = Vector3::new(0.105, 0.06, 0.0);
        let views = (0..15).map(|index| {
            let turn = 2.4 * f64::from(index);
            let tilt = UnitQuaternion::new(Vector3::new(turn.cos(), turn.sin(), 0.1) * 0.4);
            let shift = Vector3::new(
                0.14 * (1.3 * turn).sin(),
                0.1 * turn.cos(),
                0.16 + 0.03 * f64::from(index % 4),
            );
            let corners = (0..BOARD.corners()).map(|corner| {
                let place = BOARD.corner(corner);
                let seen = tilt * (Vector3::new(place.x, place.y, 0.0) - middle) + shift;
                let aside = seen.xy().norm();
                let scale = focal * libm::atan2(aside, seen.z) / aside.max(1e-12);
                Point::new(
                    400.0 + scale * seen.x + noise(),
                    300.0 + scale * seen.y + noise(),
                )
            });
            corners.collect()
        });
        views.collect()
    }

    #[test]
    fn a_fisheye_lens_is_flagged_with_honest_error_bars() {
        let found = calibrate(&BOARD, &fisheye_views(350.0), 800, 600).expect("a calibration");
        let misfit = found.misfit.expect("a misfit");
        assert!(misfit.radial_error_px > 0.03, "{misfit:?}");
        let off = (found.lens.focal[0] - 350.0).abs() / found.lens_deviations[0];
        assert!(
            off < 2.5,
            "fx is {off} of its standard deviations off: {misfit:?}"
        );
    }

    #[test]
    fn rendered_boards_calibrate_the_camera() {
        let cameras = cameras(20);
        let views: Vec<Vec<Point>> = cameras
            .iter()
            .enumerate()
            .map(|(seed, camera)| BOARD.find(&picture(camera, seed as u64)).expect("a board"))
            .collect();
        let mut worst: f64 = 0.0;
        for (camera, view) in cameras.iter().zip(&views) {
            for (truth, corner) in seen(camera).iter().zip(view) {
                worst = worst.max((truth - corner).norm());
            }
        }
        assert!(worst < 0.05, "a corner is {worst} pixels off");
        let found = calibrate(&BOARD, &views, 800, 600).expect("a calibration");
        assert!(found.reprojection_rms < 0.02, "{}", found.reprojection_rms);
        assert_eq!(found.misfit, None);
        // A camera at 0.6 m from a board on the table.
        let mut far = cameras[3];
        let aim = Vector3::new(0.105, 0.06, 0.0);
        let view = far.pose.rotation * Vector3::z();
        far.pose.translation.vector = aim - view * 0.6;
        let corners = BOARD.find(&picture(&far, 99)).expect("a board");
        let aim = nalgebra::Point3::from(aim);
        let (pose, _) = board_pose(&BOARD, &corners, &far.lens).expect("a pose");
        let off = (pose * aim - far.pose.inverse() * aim).norm();
        assert!(off < 0.03e-3, "with the true lens the pose is {off} m off");
        // The principal point is the least accurate parameter: here its error is 0.04 pixels,
        // which moves points at a distance of 0.6 m by 0.03 mm.
        assert!(found.lens_deviations[2] < 0.08 && found.lens_deviations[3] < 0.08);
        let (pose, _) = board_pose(&BOARD, &corners, &found.lens).expect("a pose");
        let off = (pose * aim - far.pose.inverse() * aim).norm();
        println!(
            "corners to {worst:.4} px, pose with the lens found to {:.4} mm",
            1e3 * off
        );
        assert!(off < 0.1e-3, "with the lens found the pose is {off} m off");
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
        let view = seen(&slanted_camera());
        let error = calibrate(&BOARD, &[view.clone(), view], 1280, 720).expect_err("two views");
        assert!(error.to_string().contains("three"), "{error}");
    }

    #[test]
    fn a_missing_board_is_reported() {
        let empty = image::RgbImage::from_pixel(200, 100, image::Rgb([128; 3]));
        let error = BOARD.find(&empty).expect_err("no board").to_string();
        assert!(error.contains("the checkerboard was not found"), "{error}");
    }
}
