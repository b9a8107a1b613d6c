//! Planes, obstacles and held rods, as half spaces and capsules.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{LoadKind, Obstacle, Scene};

/// Whether an obstacle consists of balls and capsules at rest, which other simulators have, too.
pub(super) fn is_carried_over(obstacle: &Obstacle) -> bool {
    let body = &obstacle.body;
    body.faces.is_empty() && !body.hollow && !obstacle.motion.moves()
}

/// A half space at rest.
pub(super) struct HalfSpace {
    pub point: Vector3,
    pub normal: Vector3,
    pub friction: f64,
}

/// A capsule at rest; a ball if its ends coincide.
pub(super) struct Capsule {
    pub ends: [Vector3; 2],
    pub radius: f64,
    pub friction: f64,
}

/// Friction coefficient of the contact model.
pub(super) fn friction(scene: &Scene) -> f64 {
    let contact = scene.contact.as_ref();
    contact.map_or(0.0, |contact| contact.friction)
}

/// The planes of a scene.
pub(super) fn half_spaces(scene: &Scene) -> impl Iterator<Item = HalfSpace> {
    let usual = friction(scene);
    scene.planes.iter().map(move |plane| HalfSpace {
        point: plane.point,
        normal: plane.normal,
        friction: plane.own_friction().unwrap_or(usual),
    })
}

/// The obstacles that models have, and the edges of held rods.
pub(super) fn capsules(scene: &Scene) -> Vec<Capsule> {
    let usual = friction(scene);
    let mut capsules = Vec::new();
    for obstacle in scene.obstacles.iter().filter(|one| is_carried_over(one)) {
        for segment in &obstacle.body.segments {
            capsules.push(Capsule {
                ends: segment.map(|vertex| obstacle.body.vertices[vertex]),
                radius: obstacle.body.radius,
                friction: obstacle.friction.unwrap_or(usual),
            });
        }
    }
    for rod in scene.rods.iter().filter(|rod| rod.held) {
        let nodes = &rod.centreline;
        let edges = nodes.len() - usize::from(!rod.closed);
        for edge in 0..edges {
            capsules.push(Capsule {
                ends: [nodes[edge], nodes[(edge + 1) % nodes.len()]],
                radius: rod.radius,
                friction: usual,
            });
        }
    }
    capsules
}

/// Sum of the gravity of a scene at time zero, m/s².
pub(super) fn gravity(scene: &Scene) -> Vector3 {
    let mut sum = Vector3::zeros();
    for load in &scene.loads {
        if let LoadKind::Gravity { acceleration } = &load.kind {
            let factor = load.schedule.first().map_or(1.0, |(_, factor)| *factor);
            sum += *acceleration * factor;
        }
    }
    sum
}
