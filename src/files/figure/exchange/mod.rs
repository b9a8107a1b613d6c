//! Scenes in motion as files for other programs: glTF, USD and OBJ.
//!
//! | file | what |
//! |---|---|
//! | `frames` | position and orientation of a rod's sections at each output |
//! | `surface` | triangles around a rod at rest or in place, from the mesher of films |
//! | `glb` | glTF 2.0: tubes with a joint for each node |
//! | `usd` | USD text: curves with widths, meshes of bodies |
//! | `obj` | OBJ: the surfaces at one output |
//!
//! Lengths are in metres. glTF prescribes that y is up, so that its scene is turned; USD and OBJ
//! keep the axes of the scenario, with z up.

mod frames;
mod glb;
#[cfg(test)]
mod glb_tests;
mod obj;
mod packed;
mod surface;
mod usd;

pub use glb::glb;
pub use obj::obj;
pub use usd::usda;

use super::motion::{MovieCase, MoviePlane, room};
use nalgebra::Vector3;

/// Speed of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tempo {
    /// Simulated seconds per second of animation.
    pub speed: f64,
}

/// Outputs per second of animation of a path of equilibria, which has no time.
const EQUILIBRIA_PER_SECOND: f64 = 6.0;

/// Reason why a scene cannot be written in a format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExchangeError {
    /// The file would be larger than its format allows.
    #[error(
        "the file would have more than 4 GB, which glTF does not allow; export fewer outputs with --outputs"
    )]
    TooLarge,
    /// A rod has more nodes than a skin may have joints.
    #[error(
        "rod `{name}` has {nodes} nodes; allowed in glTF: at most {}",
        u16::MAX
    )]
    TooManyNodes {
        /// Name of the rod.
        name: String,
        /// Number of its nodes.
        nodes: usize,
    },
}

/// Times of the outputs in the animation, s, from zero on. Outputs at the same time follow each
/// other by a microsecond, because keys must increase.
fn seconds(case: &MovieCase, tempo: Tempo) -> Vec<f64> {
    const LEAST: f64 = 1e-6;
    let first = case.frames.first().map_or(0.0, |frame| frame.time);
    let is_path = case.branches.is_some();
    let mut seconds: Vec<f64> = Vec::with_capacity(case.frames.len());
    for (number, frame) in case.frames.iter().enumerate() {
        let place = if is_path {
            number as f64 / EQUILIBRIA_PER_SECOND
        } else {
            (frame.time - first) / tempo.speed
        };
        let least = seconds.last().map_or(0.0, |before| {
            // Files hold single precision.
            f64::from((*before as f32).next_up()).max(before + LEAST)
        });
        seconds.push(place.max(least));
    }
    seconds
}

/// Corners of a square on a plane, anticlockwise as seen from above: below the middle of the scene,
/// with twice its extent to each side.
fn square(case: &MovieCase, plane: &MoviePlane) -> [Vector3<f64>; 4] {
    let [lower, extent] = room(case);
    let normal = Vector3::from(plane.normal);
    let middle = lower + 0.5 * extent;
    let foot = middle - normal * normal.dot(&(middle - Vector3::from(plane.point)));
    let other = if normal.z.abs() < 0.8 {
        Vector3::z()
    } else {
        Vector3::x()
    };
    let first = (other - normal * normal.dot(&other)).normalize() * extent.norm();
    let second = normal.cross(&first);
    [
        -first - second,
        first - second,
        first + second,
        second - first,
    ]
    .map(|side| foot + side)
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::motion::{MovieFrame, MovieObstacle, MovieRod, Strip};
    use super::super::view::View;
    use super::*;

    /// A tapered rod that bends, a ring, a sheet, a moving body and a table, at three times.
    pub fn scene() -> MovieCase {
        let rod = |name: &str, nodes: usize, closed: bool| MovieRod {
            name: name.into(),
            nodes,
            closed,
            radius: 2e-3,
            radii: Vec::new(),
            held: false,
            straight: false,
            strip: None,
        };
        let straight: Vec<Vector3<f64>> = (0..5)
            .map(|k| Vector3::new(0.0, 0.1, 0.02 * k as f64))
            .collect();
        let rods = vec![
            MovieRod {
                radii: vec![2e-3, 1.75e-3, 1.5e-3, 1.25e-3, 1e-3],
                ..rod("tip \"a\"", 5, false)
            },
            rod("2nd ring", 8, true),
            MovieRod {
                strip: Some(Strip::placed(0.04, 1e-4, &Vector3::y(), &straight, false)),
                ..rod("sheet", 5, false)
            },
        ];
        let at = |time: f64| {
            let bend = 0.4 * time;
            let arc = (0..5).map(|k| {
                let angle = bend * k as f64;
                Vector3::new(0.02 * angle.sin(), 0.01 * time, 0.02 * k as f64)
            });
            let ring = (0..8).map(|k| {
                let angle = std::f64::consts::TAU * k as f64 / 8.0;
                Vector3::new(
                    0.05 * angle.cos(),
                    0.05 * angle.sin(),
                    0.03 * time * angle.sin(),
                )
            });
            let sheet =
                (0..5).map(|k| Vector3::new(0.01 * time * (k * k) as f64, 0.1, 0.02 * k as f64));
            MovieFrame {
                time,
                positions: arc.chain(ring).chain(sheet).collect(),
                contacts: Vec::new(),
            }
        };
        let pose = |x: f64| {
            [
                0., 1., 0., 0., -1., 0., 0., 0., 0., 0., 2., 0., x, 0., 0.5, 1.,
            ]
        };
        let corner = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        MovieCase {
            name: "case".into(),
            distinction: Vec::new(),
            parameters: Vec::new(),
            rods,
            planes: vec![MoviePlane {
                point: [0.0, 0.0, -0.1],
                normal: [0.0, 0.0, 1.0],
            }],
            obstacles: vec![MovieObstacle {
                triangles: vec![
                    [
                        corner(0., 0., 0.),
                        corner(0.01, 0., 0.),
                        corner(0., 0.01, 0.),
                    ],
                    [
                        corner(0., 0., 0.),
                        corner(0., 0.01, 0.),
                        corner(0., 0., 0.01),
                    ],
                ],
                poses: vec![pose(0.0), pose(0.1), pose(0.2)],
                hollow: false,
                is_carried: false,
            }],
            view: View::oblique(),
            frames: vec![at(0.0), at(0.5), at(2.0)],
            fields: Vec::new(),
            series: Vec::new(),
            branches: None,
        }
    }

    #[test]
    fn keys_are_at_the_scaled_times_of_outputs_and_increase() {
        let mut case = scene();
        assert_eq!(seconds(&case, Tempo { speed: 0.1 }), [0.0, 5.0, 20.0]);
        case.branches = Some(vec![0, 0, 1]);
        let path = seconds(&case, Tempo { speed: 0.1 });
        assert_eq!(path, [0.0, 1.0 / 6.0, 2.0 / 6.0]);
        case.branches = None;
        case.frames.iter_mut().for_each(|frame| frame.time = 3.0);
        for speed in [1.0, 1e-4] {
            let mut still = case.clone();
            still.frames[0].time = 0.0;
            let keys = seconds(&still, Tempo { speed });
            assert!(
                keys.is_sorted_by(|a, b| (*a as f32) < *b as f32),
                "{keys:?}"
            );
        }
    }

    #[test]
    fn a_plane_is_a_square_below_the_scene_that_faces_up() {
        let case = scene();
        let [a, b, c, _] = square(&case, &case.planes[0]);
        assert!((b - a).cross(&(c - b)).z > 0.0);
        assert!(
            [a, b, c]
                .iter()
                .all(|corner| (corner.z + 0.1).abs() < 1e-12)
        );
        assert!(a.x < -0.05 && c.x > 0.05 && a.y < -0.05 && c.y > 0.1);
    }
}
