//! Position of the camera during the film: it turns about the scene and shows all of the motion, or
//! follows a rod.

use super::super::motion::{MovieCase, Outline, centre, outline};
use super::FilmOptions;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Number of directions for the size of a scene with a turning camera.
const DIRECTIONS: usize = 25;

/// The axes of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axes {
    pub right: Vector3<f64>,
    pub up: Vector3<f64>,
    pub eye: Vector3<f64>,
}

impl Axes {
    /// Axes of a view from an azimuth, which is zero at the front (−y) and grows towards the right
    /// (+x), and an elevation, rad.
    pub fn from(azimuth: f64, elevation: f64) -> Self {
        let (sa, ca) = libm::sincos(azimuth);
        let (se, ce) = libm::sincos(elevation);
        let eye = Vector3::new(sa * ce, -ca * ce, se);
        let right = Vector3::new(ca, sa, 0.0);
        Self {
            right,
            up: eye.cross(&right),
            eye,
        }
    }

    /// A vector along them.
    pub fn of(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.right.dot(vector),
            self.up.dot(vector),
            self.eye.dot(vector),
        )
    }
}

/// The camera at one time. The projection is orthographic, so that lengths across the view are true
/// everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Camera {
    pub axes: Axes,
    /// Point in the middle of the free part of the picture, m.
    pub target: Vector3<f64>,
    /// Position of the target in the picture, samples.
    pub middle: [f64; 2],
    /// Samples per metre.
    pub scale: f64,
}

impl Camera {
    /// Position of a point in samples: to the right, downwards, towards the eye.
    pub fn place(&self, point: &Vector3<f64>) -> [f32; 3] {
        let seen = self.axes.of(&(point - self.target)) * self.scale;
        [
            (self.middle[0] + seen.x) as f32,
            (self.middle[1] - seen.y) as f32,
            seen.z as f32,
        ]
    }

    /// Components of a direction along the same axes.
    pub fn turn(&self, vector: &Vector3<f64>) -> [f32; 3] {
        let seen = self.axes.of(vector);
        [seen.x as f32, -seen.y as f32, seen.z as f32]
    }
}

/// The part of a picture that labels leave free, samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreePart {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

/// The camera at all times.
#[derive(Clone, Debug)]
pub(super) struct CameraPath {
    azimuth: f64,
    elevation: f64,
    turn: f64,
    /// Target of the camera, m; relative to the middle of the followed rod, if there is one.
    target: Vector3<f64>,
    /// Vector from the target to the middle of the picture, along right and up, m.
    shift: [f64; 2],
    middle: [f64; 2],
    scale: f64,
    /// The nodes of the followed rod.
    follow: Option<std::ops::Range<usize>>,
}

impl CameraPath {
    /// The path that shows the whole motion in the free part of the picture.
    pub fn around(case: &MovieCase, options: &FilmOptions, free: FreePart) -> Self {
        let eye = case.view.eye();
        // In a view from above or below, x runs to the right.
        let is_upright = libm::hypot(eye.x, eye.y) < 1e-6;
        let azimuth = if is_upright {
            0.0
        } else {
            libm::atan2(eye.x, -eye.y)
        };
        let own = [azimuth, libm::asin(eye.z.clamp(-1.0, 1.0))];
        let [azimuth, elevation] = options.from.unwrap_or(own);
        let follow = options.follow.map(|rod| nodes_of(case, rod));
        let outline = outline(case, follow.as_ref());
        let target = outline.middle();
        let count = if options.turn == 0.0 { 1 } else { DIRECTIONS };
        let directions: Vec<Axes> = (0..count)
            .map(|k| azimuth + options.turn * k as f64 / (count - 1).max(1) as f64)
            .map(|azimuth| Axes::from(azimuth, elevation))
            .collect();
        let [low, high] = extent(case, &outline, follow.as_ref(), &target, &directions);
        let [mut x, y] = [0, 1].map(|k| [low[k], high[k]]);
        if options.turn != 0.0 {
            // The axis about which the camera turns stays in the middle.
            let reach = x[1].max(-x[0]);
            x = [-reach, reach];
        }
        let [width, height] = [x, y].map(|[low, high]| (high - low).max(f64::MIN_POSITIVE));
        let scale = ((free.right - free.left) / width).min((free.bottom - free.top) / height);
        Self {
            azimuth,
            elevation,
            turn: options.turn,
            target,
            shift: [x, y].map(|[low, high]| 0.5 * (low + high)),
            middle: [
                0.5 * (free.left + free.right),
                0.5 * (free.top + free.bottom),
            ],
            scale: scale * options.zoom,
            follow,
        }
    }

    /// Samples per metre.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The camera at a fraction (0 to 1) of the film, with the nodes at these positions.
    pub fn at(&self, part: f64, positions: &[Vector3<f64>]) -> Camera {
        let axes = Axes::from(self.azimuth + part * self.turn, self.elevation);
        let followed = self
            .follow
            .as_ref()
            .map(|nodes| centre(&positions[nodes.clone()]));
        let target = self.target + followed.unwrap_or_else(Vector3::zeros);
        Camera {
            axes,
            target: target + axes.right * self.shift[0] + axes.up * self.shift[1],
            middle: self.middle,
            scale: self.scale,
        }
    }
}

fn nodes_of(case: &MovieCase, rod: usize) -> std::ops::Range<usize> {
    let first: usize = case.rods[..rod].iter().map(|rod| rod.nodes).sum();
    first..first + case.rods[rod].nodes
}

/// The smallest and the largest visible position along right and up, relative to the target, m.
fn extent(
    case: &MovieCase,
    outline: &Outline,
    follow: Option<&std::ops::Range<usize>>,
    target: &Vector3<f64>,
    directions: &[Axes],
) -> [[f64; 2]; 2] {
    let none = || [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let wider = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
        let least = [0, 1].map(|k| a[0][k].min(b[0][k]));
        [least, [0, 1].map(|k| a[1][k].max(b[1][k]))]
    };
    let frames = case.frames.par_iter().enumerate();
    let of_frame = |(frame, _): (usize, _)| {
        let mut extent = none();
        outline.visit(case, frame, follow, &mut |point, reach| {
            let from = point - target;
            for axes in directions {
                let [x, y] = [axes.right.dot(&from), axes.up.dot(&from)];
                extent = wider(extent, [[x - reach, y - reach], [x + reach, y + reach]]);
            }
        });
        extent
    };
    frames.map(of_frame).reduce(none, wider)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuth_and_elevation_set_the_camera_direction() {
        let near = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() < 1e-12;
        let quarter = std::f64::consts::FRAC_PI_2;
        let front = Axes::from(0.0, 0.0);
        assert!(near(front.eye, -Vector3::y()) && near(front.up, Vector3::z()));
        let right = Axes::from(quarter, 0.0);
        assert!(near(right.eye, Vector3::x()) && near(right.right, Vector3::y()));
        let above = Axes::from(0.0, quarter);
        assert!(near(above.eye, Vector3::z()) && near(above.up, Vector3::y()));
    }
}
