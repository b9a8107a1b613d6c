//! Resolving obstacles.

use super::movement::movement;
use super::triangle_mesh::triangle_mesh;
use crate::scenario::resolved::{Obstacle, ObstacleShape};
use crate::scenario::section::{FINITE, Section};
use crate::scenario::typed;
use std::f64::consts::FRAC_PI_4;

/// Default crease angle of smooth meshes, rad.
const CREASE_ANGLE: f64 = FRAC_PI_4;

/// Maximum number of heights along a side of a grid.
const MOST_HEIGHTS: usize = 1000;

/// Resolves all obstacles.
pub fn obstacles(top: &Section<'_>, typed: &[typed::Obstacle]) -> Vec<Obstacle> {
    let mut resolved: Vec<Obstacle> = Vec::with_capacity(typed.len());
    for (index, (below, typed)) in top.elements("obstacles", typed).enumerate() {
        let name = typed.name.clone();
        let name = name.unwrap_or_else(|| format!("obstacle {index}"));
        if resolved.iter().any(|other| other.name == name) {
            below.fault("name", format!("another obstacle is called `{name}`"));
        }
        let Some(of_shape) = &typed.shape else {
            below.missing(
                "shape",
                "a table such as { kind = \"sphere\", centre = [0, 0, 0], radius = \"5 cm\" }",
            );
            continue;
        };
        let Some(shape) = shape(&below.below("shape"), of_shape) else {
            continue;
        };
        resolved.push(Obstacle {
            name,
            shape,
            friction: typed.friction(&below),
            movement: movement(&below, &typed.movement(&below)),
        });
    }
    resolved
}

/// Resolves a shape; `None` after a fault that prevents further checks.
fn shape(section: &Section<'_>, typed: &typed::ObstacleShape) -> Option<ObstacleShape> {
    Some(match typed {
        typed::ObstacleShape::Sphere(sphere) => ObstacleShape::Sphere {
            centre: sphere.centre(section),
            radius: sphere.radius(section),
        },
        typed::ObstacleShape::Capsule(capsule) => {
            let ([start, end], radius) = segment(section, capsule);
            ObstacleShape::Capsule { start, end, radius }
        }
        typed::ObstacleShape::Tube(tube) => {
            let ([start, end], radius) = segment(section, tube);
            ObstacleShape::Tube { start, end, radius }
        }
        typed::ObstacleShape::Cylinder(cylinder) => ObstacleShape::Cylinder {
            point: cylinder.point(section),
            direction: cylinder.direction(section),
            radius: cylinder.radius(section),
        },
        typed::ObstacleShape::Box(typed) => cuboid(section, typed),
        typed::ObstacleShape::Mesh(typed) => return mesh(section, typed),
        typed::ObstacleShape::Heights(typed) => return heights(section, typed),
    })
}

fn segment(section: &Section<'_>, typed: &typed::Capsule) -> ([[f64; 3]; 2], f64) {
    let start = typed.start(section);
    let end = typed.end(section);
    if start == end {
        section.fault(
            "end",
            "`start` and `end` are the same: there is no axis between them",
        );
    }
    let radius = typed.radius(section);
    ([start, end], radius)
}

fn cuboid(section: &Section<'_>, typed: &typed::Cuboid) -> ObstacleShape {
    let size = typed.size(section);
    let rounding = typed.rounding(section);
    let shortest = size.iter().copied().fold(f64::INFINITY, f64::min);
    if shortest > 0.0 && rounding >= 0.5 * shortest {
        let allowed = format!(
            "less than half of the shortest side, {:?} m",
            0.5 * shortest
        );
        section.out_of_range("rounding", rounding, allowed);
    }
    ObstacleShape::Box {
        centre: typed.centre(section),
        size,
        rounding,
        axis: typed.axis(section),
        angle: typed.angle(section),
    }
}

fn mesh(section: &Section<'_>, typed: &typed::Mesh) -> Option<ObstacleShape> {
    let mesh = triangle_mesh(section, &typed.file, &typed.vertices, &typed.triangles)?;
    let unit = typed.unit(section);
    let position = typed.position(section);
    let axis = typed.axis(section);
    let angle = typed.angle(section);
    let smooth = typed.smooth(section);
    let crease_angle = typed.crease_angle(section);
    if crease_angle.is_some() && !smooth {
        section.fault("crease_angle", "it applies to a mesh with `smooth = true`");
    }
    let placed = |vertex: &[f64; 3]| {
        let turned = turned(vertex.map(|coordinate| coordinate * unit), axis, angle);
        std::array::from_fn(|k| turned[k] + position[k])
    };
    Some(ObstacleShape::Mesh {
        vertices: mesh.vertices.iter().map(placed).collect(),
        triangles: mesh.triangles,
        closed: typed.closed(section),
        smooth,
        crease_angle: smooth.then(|| crease_angle.unwrap_or(CREASE_ANGLE)),
    })
}

/// A vector rotated about a unit vector by an angle (Rodrigues); exactly the same vector for angle
/// 0.
fn turned(vector: [f64; 3], axis: [f64; 3], angle: f64) -> [f64; 3] {
    if angle == 0.0 {
        return vector;
    }
    let (sine, cosine) = libm::sincos(angle);
    let along: f64 = (0..3).map(|k| axis[k] * vector[k]).sum();
    std::array::from_fn(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        let across = axis[l] * vector[m] - axis[m] * vector[l];
        vector[k] * cosine + across * sine + axis[k] * along * (1.0 - cosine)
    })
}

/// A grid of heights as a mesh with two triangles per cell.
fn heights(section: &Section<'_>, typed: &typed::Heights) -> Option<ObstacleShape> {
    let origin = typed.origin(section);
    let spacing = typed.spacing(section);
    let smooth = typed.smooth(section);
    let Some(rows) = &typed.heights else {
        section.missing(
            "heights",
            "rows of heights, such as [[0, 0, 0], [0, 0.01, 0]]",
        );
        return None;
    };
    let (count, length) = (rows.len(), rows.first().map_or(0, Vec::len));
    let allowed = 2..=MOST_HEIGHTS;
    if !allowed.contains(&count) || !allowed.contains(&length) {
        let message = format!(
            "a grid of {length} by {count} heights; allowed: 2 to {MOST_HEIGHTS} along either side"
        );
        section.fault("heights", message);
        return None;
    }
    let below = section.below("heights");
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for (row, heights) in rows.iter().enumerate() {
        if heights.len() != length {
            let message = format!(
                "{} heights, where the first row has {length}",
                heights.len()
            );
            below.fault(&row.to_string(), message);
            return None;
        }
        let of_row = below.below(&row.to_string());
        for (column, height) in heights.iter().enumerate() {
            let height = of_row.number(&column.to_string(), height, FINITE);
            let place = [column as f64 * spacing, row as f64 * spacing, height];
            vertices.push(std::array::from_fn(|k| origin[k] + place[k]));
        }
    }
    for row in 0..count - 1 {
        for column in 0..length - 1 {
            let [a, b] = [row, row + 1].map(|row| row * length + column);
            triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
        }
    }
    Some(ObstacleShape::Mesh {
        vertices,
        triangles,
        closed: false,
        smooth,
        crease_angle: smooth.then_some(CREASE_ANGLE),
    })
}
