//! Obstacles, placed in the scene.

use super::place::motion_of;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{Obstacle, RodDescription};
use crate::mechanics::{Vector3, rotation};
use crate::scenario::{self, Issue, KeyPath, ObstacleShape};

/// Most that a mesh may be larger than all rods together, or smaller than the radius of the thinnest: by more, and the file is
/// of another unit.
const UNLIKELY: f64 = 100.0;

/// Farthest from the origin that anything of an obstacle may be, m: distances of rods from what is farther are lost to
/// rounding.
const FARTHEST: f64 = 1e6;

/// The obstacle of a scenario among these rods.
///
/// # Errors
/// What is wrong with its mesh.
pub fn place_obstacle(
    obstacle: &scenario::Obstacle,
    rods: &[RodDescription],
    path: &KeyPath,
) -> Result<Obstacle, Issue> {
    let body = match &obstacle.shape {
        ObstacleShape::Sphere { centre, radius } => {
            RigidBody::sphere(Vector3::from(*centre), *radius)
        }
        ObstacleShape::Capsule { start, end, radius } => {
            RigidBody::capsule([Vector3::from(*start), Vector3::from(*end)], *radius)
        }
        ObstacleShape::Tube { start, end, radius } => {
            RigidBody::tube([Vector3::from(*start), Vector3::from(*end)], *radius)
        }
        ObstacleShape::Cylinder {
            point,
            direction,
            radius,
        } => RigidBody::cylinder(Vector3::from(*point), Vector3::from(*direction), *radius),
        ObstacleShape::Box {
            centre,
            size,
            rounding,
            axis,
            angle,
        } => {
            let orientation = rotation::from_vector(Vector3::from(*axis) * *angle);
            let (centre, size) = (Vector3::from(*centre), Vector3::from(*size));
            RigidBody::cuboid(centre, size, &orientation, *rounding)
        }
        ObstacleShape::Mesh {
            vertices,
            triangles,
            closed,
        } => {
            let vertices = vertices.iter().copied().map(Vector3::from).collect();
            let body = RigidBody::of_mesh(vertices, triangles.clone(), *closed);
            let body = body.map_err(|fault| {
                let help = closed.then(|| {
                    "`closed = false` takes it for a sheet, which rods touch from both sides".into()
                });
                Issue::new(path.key("shape"), format!("the mesh cannot be: {fault}"))
                    .with_help(help)
            })?;
            refuse_other_units(&body, rods, path)?;
            body
        }
    };
    let mut coordinates = body.vertices.iter().flat_map(|vertex| vertex.iter());
    if body.radius > FARTHEST || coordinates.any(|coordinate| coordinate.abs() > FARTHEST) {
        let message = format!(
            "it reaches farther than {FARTHEST:e} m from the origin; allowed: at most that"
        );
        return Err(Issue::new(path.key("shape"), message));
    }
    Ok(Obstacle {
        name: obstacle.name.clone(),
        body,
        friction: obstacle.friction,
        motion: motion_of(&obstacle.movement),
    })
}

/// The obstacles of a scenario that has run, for pictures.
pub fn place_obstacles(scenario: &scenario::Scenario) -> Vec<Obstacle> {
    let path = KeyPath::from("obstacles");
    let obstacles = scenario.obstacles.iter();
    obstacles
        .filter_map(|obstacle| place_obstacle(obstacle, &[], &path).ok())
        .collect()
}

fn refuse_other_units(
    body: &RigidBody,
    rods: &[RodDescription],
    path: &KeyPath,
) -> Result<(), Issue> {
    if rods.is_empty() {
        return Ok(());
    }
    let mesh = extent(body.vertices.iter());
    let scene = extent(rods.iter().flat_map(|rod| &rod.centreline));
    let thinnest = rods
        .iter()
        .fold(f64::INFINITY, |least, rod| least.min(rod.radius));
    let (than, size) = if mesh > UNLIKELY * scene {
        ("larger than the rods with their extent", scene)
    } else if mesh * UNLIKELY < thinnest {
        ("smaller than the radius of the thinnest rod", thinnest)
    } else {
        return Ok(());
    };
    let message = format!(
        "the mesh is {mesh:.3e} m wide, over {UNLIKELY} times {than}, {size:.3e} m: its file is probably of another unit"
    );
    let help = "give the unit of the file, for example `unit = \"1 mm\"`".to_owned();
    Err(Issue::new(path.key("shape"), message).with_help(Some(help)))
}

/// Diagonal of the box around points, m.
fn extent<'a>(points: impl Iterator<Item = &'a Vector3> + Clone) -> f64 {
    let corner = |pick: fn(f64, f64) -> f64, start: f64| {
        let start = Vector3::repeat(start);
        points
            .clone()
            .fold(start, |corner, point| corner.zip_map(point, pick))
    };
    (corner(f64::max, f64::NEG_INFINITY) - corner(f64::min, f64::INFINITY)).norm()
}
