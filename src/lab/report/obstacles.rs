//! Obstacles of a scenario, for pictures.

use crate::experiment::place_obstacles;
use crate::scenario::Scenario;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::rigid_body::neighbourhood;
use rodlab_engine::mechanics::scene::Obstacle;
use rodlab_engine::mechanics::system::obstacle_poses;
use rodlab_files::figure::{Body, MovieObstacle};

/// Maximum number of triangles of an obstacle in pictures.
const MOST_TRIANGLES: usize = 200_000;

/// The obstacles of a scenario; none if the scenario could not be read.
pub fn obstacles_of(scenario: Option<&Scenario>) -> Vec<Obstacle> {
    scenario.map(place_obstacles).unwrap_or_default()
}

/// Surfaces of obstacles at time zero, as triangles. Of infinite surfaces only the part near
/// `points`.
pub fn surfaces<'a>(
    obstacles: &[Obstacle],
    points: impl Iterator<Item = &'a Vector3> + Clone,
) -> Vec<Vec<[Vector3; 3]>> {
    let (centre, reach) = neighbourhood(points);
    let bodies = obstacles.iter().map(|obstacle| &obstacle.body);
    let surfaces = bodies.map(|body| body.surface(&centre, reach));
    surfaces
        .map(|mut triangles| {
            triangles.truncate(MOST_TRIANGLES);
            triangles
        })
        .collect()
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
        .map(|(index, triangles)| MovieObstacle {
            triangles,
            poses: if obstacles[index].motion.moves() {
                poses.iter().map(|poses| poses[index].matrix()).collect()
            } else {
                Vec::new()
            },
            hollow: obstacles[index].body.hollow,
            is_carried: false,
        })
        .collect()
}

/// Obstacles for figures at a time, s.
pub fn bodies_at(obstacles: &[Obstacle], surfaces: &[Vec<[Vector3; 3]>], time: f64) -> Vec<Body> {
    let poses = obstacle_poses(obstacles, time);
    let placed = obstacles.iter().zip(surfaces).zip(&poses);
    placed
        .map(|((obstacle, triangles), pose)| Body {
            triangles: (triangles.iter())
                .map(|corners| corners.map(|corner| pose.of(&corner)))
                .collect(),
            hollow: obstacle.body.hollow,
        })
        .collect()
}
