//! Places obstacles in the scene.

use super::place::motion_of;
use crate::scenario::{self, Issue, KeyPath, ObstacleShape};
use rodlab_engine::mechanics::rigid_body::RigidBody;
use rodlab_engine::mechanics::scene::{Obstacle, RodDescription};
use rodlab_engine::mechanics::{Vector3, rotation};

/// Largest ratio of the size of a mesh to that of all rods, or of the radius of the thinnest rod
/// to the size of the mesh. Beyond it the file is probably in another unit.
const UNLIKELY: f64 = 100.0;

/// Largest distance of any part of an obstacle from the origin, over the radius of the thinnest
/// rod. Distances of rods from farther parts would be lost to rounding.
const FARTHEST: f64 = 1e9;

/// Largest depth to which an edge of a rod may dip into a smooth mesh between two nodes that touch
/// it, over the radius of the rod.
const DEEPEST_DIP: f64 = 0.5;

/// Half the length of a cylinder without ends, over the distance of the farthest node from its
/// point. No rod reaches its ends, and little is lost to rounding.
const ENDLESS: f64 = 1e2;

/// The obstacle of a scenario among these rods.
///
/// # Errors
/// The fault of its mesh.
pub fn place_obstacle(
    obstacle: &scenario::Obstacle,
    rods: &[RodDescription],
    path: &KeyPath,
) -> Result<Obstacle, Issue> {
    let farthest = FARTHEST * thinnest_radius(rods);
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
        } => {
            let (point, direction) = (Vector3::from(*point), Vector3::from(*direction));
            let half_length = endless(&point, *radius, rods).min(0.5 * farthest);
            RigidBody::cylinder(point, direction, *radius, half_length)
        }
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
            crease_angle,
            ..
        } => {
            let vertices = vertices.iter().copied().map(Vector3::from).collect();
            let body = RigidBody::of_mesh(vertices, triangles.clone(), *closed);
            let body = body.map_err(|fault| {
                let help = closed.then(|| {
                    "`closed = false` treats it as a sheet, which rods touch from both sides".into()
                });
                Issue::new(path.key("shape"), format!("invalid mesh: {fault}")).with_help(help)
            })?;
            refuse_other_units(&body, rods, path)?;
            match crease_angle {
                Some(angle) => {
                    let body = body.smoothed(*angle);
                    refuse_long_edges(&body, rods, path)?;
                    body
                }
                None => body,
            }
        }
    };
    let mut coordinates = body.vertices.iter().flat_map(|vertex| vertex.iter());
    if body.radius > farthest || coordinates.any(|coordinate| coordinate.abs() > farthest) {
        let message = format!(
            "it reaches too far from the origin; allowed: at most {farthest:e} m, {FARTHEST:e} times the radius of the thinnest rod"
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

/// The obstacles of a finished scenario, for pictures.
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
    let thinnest = thinnest_radius(rods);
    let (than, size) = if mesh > UNLIKELY * scene {
        ("larger than the rods with their extent", scene)
    } else if mesh * UNLIKELY < thinnest {
        ("smaller than the radius of the thinnest rod", thinnest)
    } else {
        return Ok(());
    };
    let message = format!(
        "the mesh is {mesh:.3e} m wide, over {UNLIKELY} times {than}, {size:.3e} m: its file is \
         probably in another unit"
    );
    let help = "give the unit of the file, for example `unit = \"1 mm\"`".to_owned();
    Err(Issue::new(path.key("shape"), message).with_help(Some(help)))
}

/// Refuses edges of rods that would dip far into a smooth body between two nodes that touch it.
///
/// On a surface of the curvature κ a rod of radius h lies on a curve of radius 1/κ + h, and the
/// middle of an edge of length L is L²κ/(8 (1 + κh)) below its ends.
fn refuse_long_edges(
    body: &RigidBody,
    rods: &[RodDescription],
    path: &KeyPath,
) -> Result<(), Issue> {
    let curvature = if body.closed {
        body.largest_curvature()
    } else {
        0.0
    };
    for rod in rods {
        let edges = rod.centreline.windows(2);
        let longest = edges.map(|ends| (ends[1] - ends[0]).norm());
        let longest = longest.fold(0.0, f64::max);
        let radius = rod.least_radius();
        let dip = longest * longest * curvature / (8.0 * (1.0 + curvature * radius));
        if dip > DEEPEST_DIP * radius {
            let message = format!(
                "the edges of rod `{}`, {longest:.3e} m long, would dip {dip:.3e} m into this smooth \
                 mesh, which has bends of radius {:.3e} m; allowed: half the radius of the rod, \
                 {:.3e} m",
                rod.name,
                1.0 / curvature,
                DEEPEST_DIP * radius,
            );
            let help = "only nodes touch smooth meshes: give the rod shorter edges, or leave out \
                        `smooth`";
            return Err(Issue::new(path.key("shape"), message).with_help(Some(help.to_owned())));
        }
    }
    Ok(())
}

/// Radius of the thinnest rod, m; infinite without rods.
fn thinnest_radius(rods: &[RodDescription]) -> f64 {
    rods.iter()
        .fold(f64::INFINITY, |least, rod| least.min(rod.least_radius()))
}

/// Half the length (m) of a cylinder around a line through `point` that counts as infinite.
/// Without rods, as for pictures, it exceeds everything shown.
fn endless(point: &Vector3, radius: f64, rods: &[RodDescription]) -> f64 {
    if rods.is_empty() {
        return FARTHEST * radius;
    }
    let nodes = rods.iter().flat_map(|rod| &rod.centreline);
    ENDLESS * nodes.fold(radius, |most, x| most.max((x - point).norm()))
}

/// Diagonal of the bounding box of points, m.
fn extent<'a>(points: impl Iterator<Item = &'a Vector3> + Clone) -> f64 {
    let corner = |pick: fn(f64, f64) -> f64, start: f64| {
        let start = Vector3::repeat(start);
        points
            .clone()
            .fold(start, |corner, point| corner.zip_map(point, pick))
    };
    (corner(f64::max, f64::NEG_INFINITY) - corner(f64::min, f64::INFINITY)).norm()
}
