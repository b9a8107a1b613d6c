//! Obstacles of a scenario, for pictures.

use crate::experiment::place_obstacles;
use crate::scenario::Scenario;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::rigid_body::neighbourhood;
use rodlab_engine::mechanics::scene::Obstacle;
use rodlab_engine::mechanics::system::obstacle_poses;
use rodlab_files::figure::{Body, MovieObstacle};
use std::f64::consts::PI;

/// Maximum number of triangles of an obstacle in pictures.
const MOST_TRIANGLES: usize = 200_000;
/// Number of points for which it is determined whether a sheet is around them.
const SAMPLES: usize = 64;
/// Turns of a sheet around a point from which on the point is inside: a wide wall has a half.
const AROUND: f64 = 0.75;

/// The surface of an obstacle at time zero.
#[derive(Debug)]
pub struct Surface {
    triangles: Vec<[Vector3; 3]>,
    /// Whether rods are inside, so that it is drawn translucent.
    hollow: bool,
}

/// The obstacles of a scenario; none if the scenario could not be read.
pub fn obstacles_of(scenario: Option<&Scenario>) -> Vec<Obstacle> {
    scenario.map(place_obstacles).unwrap_or_default()
}

/// Surfaces of obstacles. Of infinite surfaces only the part near `points`.
pub fn surfaces<'a>(
    obstacles: &[Obstacle],
    points: impl Iterator<Item = &'a Vector3> + Clone,
) -> Vec<Surface> {
    let (centre, reach) = neighbourhood(points.clone());
    let surface = |obstacle: &Obstacle| {
        let body = &obstacle.body;
        let mut triangles = body.surface(&centre, reach);
        triangles.truncate(MOST_TRIANGLES);
        let is_sheet = !body.faces.is_empty() && !body.closed;
        let hollow = body.hollow || is_sheet && is_around(&triangles, points.clone());
        Surface { triangles, hollow }
    };
    obstacles.iter().map(surface).collect()
}

/// Whether triangles enclose some of the points, such as the wall of a vessel.
fn is_around<'a>(
    triangles: &[[Vector3; 3]],
    points: impl Iterator<Item = &'a Vector3> + Clone,
) -> bool {
    let every = points.clone().count().div_ceil(SAMPLES).max(1);
    points.step_by(every).any(|point| {
        let angles = triangles.iter().map(|corners| solid_angle(corners, point));
        angles.sum::<f64>().abs() > AROUND * 4.0 * PI
    })
}

/// Solid angle of a triangle as seen from a point, with the sign of its orientation (A. van Oosterom
/// and J. Strackee 1983, IEEE Trans. Biomed. Eng. 30, 125).
fn solid_angle(corners: &[Vector3; 3], point: &Vector3) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - point);
    let [r, s, t] = [a.norm(), b.norm(), c.norm()];
    let below = r * s * t + a.dot(&b) * t + b.dot(&c) * r + c.dot(&a) * s;
    2.0 * libm::atan2(a.dot(&b.cross(&c)), below)
}

/// Obstacles for the 3-D page at these times, s.
pub fn movie_obstacles<'a>(
    obstacles: &[Obstacle],
    times: &[f64],
    points: impl Iterator<Item = &'a Vector3> + Clone,
) -> Vec<MovieObstacle> {
    let poses: Vec<_> = (times.iter())
        .map(|time| obstacle_poses(obstacles, *time))
        .collect();
    let surfaces = surfaces(obstacles, points).into_iter().enumerate();
    surfaces
        .map(|(index, surface)| MovieObstacle {
            triangles: surface.triangles,
            poses: if obstacles[index].motion.moves() {
                poses.iter().map(|poses| poses[index].matrix()).collect()
            } else {
                Vec::new()
            },
            hollow: surface.hollow,
            is_carried: false,
        })
        .collect()
}

/// Obstacles for figures at a time, s.
pub fn bodies_at(obstacles: &[Obstacle], surfaces: &[Surface], time: f64) -> Vec<Body> {
    let poses = obstacle_poses(obstacles, time);
    let placed = surfaces.iter().zip(&poses);
    placed
        .map(|(surface, pose)| Body {
            triangles: (surface.triangles.iter())
                .map(|corners| corners.map(|corner| pose.of(&corner)))
                .collect(),
            hollow: surface.hollow,
            convex: false,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tube of triangles along x from 0 to 1, of radius 0.1.
    fn tube() -> Vec<[Vector3; 3]> {
        let corner = |x: f64, side: usize| {
            let (sin, cos) = libm::sincos(PI * side as f64 / 8.0);
            Vector3::new(x, 0.1 * cos, 0.1 * sin)
        };
        let side = |k: usize| {
            let [a, b] = [corner(0.0, k), corner(0.0, k + 1)];
            let [c, d] = [corner(1.0, k), corner(1.0, k + 1)];
            [[a, b, d], [a, d, c]]
        };
        (0..16).flat_map(side).collect()
    }

    #[test]
    fn a_tube_of_triangles_is_around_points_inside_and_no_wall_is() {
        let points = [Vector3::new(0.5, 0.02, 0.0), Vector3::new(0.5, 0.2, 0.0)];
        assert!(is_around(&tube(), points[..1].iter()));
        assert!(is_around(&tube(), points.iter()));
        assert!(!is_around(&tube(), points[1..].iter()));
        let corner = |x: f64, y: f64| Vector3::new(x, y, 0.0);
        let wall = [corner(-99.0, -99.0), corner(99.0, -99.0), corner(0.0, 99.0)];
        assert!(!is_around(&[wall], [Vector3::z() * 0.1].iter()));
    }
}
