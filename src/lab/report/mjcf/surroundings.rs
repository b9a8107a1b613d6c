//! Planes, obstacles and held rods as geoms of the world.

use super::list;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Obstacle, Scene};
use std::fmt::Write;

/// Whether an obstacle consists of balls and capsules at rest, which MuJoCo has, too.
pub(super) fn is_carried_over(obstacle: &Obstacle) -> bool {
    let body = &obstacle.body;
    body.faces.is_empty() && !body.hollow && !obstacle.motion.moves()
}

/// The geoms of a scene.
pub(super) fn surroundings(scene: &Scene) -> String {
    let mut text = String::new();
    let usual = scene
        .contact
        .as_ref()
        .map_or(0.0, |contact| contact.friction);
    for plane in &scene.planes {
        let friction = plane.largest_friction(usual);
        _ = writeln!(
            text,
            "    <geom type=\"plane\" size=\"0 0 0.01\" pos=\"{}\" zaxis=\"{}\" friction=\"{friction} 0.005 0.0001\"/>",
            list(plane.point.iter()),
            list(plane.normal.iter())
        );
    }
    for obstacle in scene.obstacles.iter().filter(|one| is_carried_over(one)) {
        let friction = obstacle.friction.unwrap_or(usual);
        for segment in &obstacle.body.segments {
            let ends = segment.map(|vertex| obstacle.body.vertices[vertex]);
            add_capsule(&mut text, ends, obstacle.body.radius, friction);
        }
    }
    for rod in scene.rods.iter().filter(|rod| rod.held) {
        let nodes = &rod.centreline;
        let edges = nodes.len() - usize::from(!rod.closed);
        for edge in 0..edges {
            let ends = [nodes[edge], nodes[(edge + 1) % nodes.len()]];
            add_capsule(&mut text, ends, rod.radius, usual);
        }
    }
    text
}

fn add_capsule(text: &mut String, [from, to]: [Vector3; 2], radius: f64, friction: f64) {
    let friction = format!("friction=\"{friction} 0.005 0.0001\"");
    _ = if from == to {
        let centre = list(from.iter());
        writeln!(
            text,
            "    <geom type=\"sphere\" size=\"{radius}\" pos=\"{centre}\" {friction}/>"
        )
    } else {
        let ends = list(from.iter().chain(to.iter()));
        writeln!(
            text,
            "    <geom type=\"capsule\" size=\"{radius}\" fromto=\"{ends}\" {friction}/>"
        )
    };
}
