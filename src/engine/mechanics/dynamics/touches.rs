//! Contacts of the last step with their places and forces.

use super::Simulation;
use crate::mechanics::Vector3;
use crate::mechanics::rod::topology::position;

/// A place at which two surfaces press on each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    /// Names of the rods, free bodies or obstacles; the second may be `plane 0`, `plane 1`, ...
    pub names: [String; 2],
    /// Nodes at which the edges in contact begin, or that touch; `None` for bodies, obstacles and
    /// planes.
    pub nodes: [Option<usize>; 2],
    /// The place on the surface of the first, m.
    pub place: Vector3,
    /// Unit normal, towards the first.
    pub normal: Vector3,
    /// Distance between the surfaces, m.
    pub gap: f64,
    /// Normal force, N.
    pub normal_force: f64,
    /// Friction on the first, N.
    pub friction: Vector3,
}

impl Simulation {
    /// The contacts of the last step with a force. Where rods touch as smooth curves, nodes are
    /// those of the edges in which they touch.
    pub fn touches(&self) -> Vec<Touch> {
        let system = &self.system;
        let Some(contact) = system.contact() else {
            return Vec::new();
        };
        let assembly = &system.assembly;
        let surface = contact.surface();
        let of_node = |node: usize| {
            let (rod, along) = assembly.locate(contact.node_of(node));
            let is_rod = !assembly.rods.rods[rod].rigid;
            (assembly.names[rod].clone(), is_rod.then_some(along))
        };
        let of_body = |index: usize| match surface.obstacle_of(index) {
            Some(obstacle) => (assembly.obstacles[obstacle].clone(), None),
            None => of_node(surface.first_node_of(index)),
        };
        let unknowns = &self.state.unknowns;
        let place_of = |node: usize| {
            let mut place = Vector3::zeros();
            contact.spread(node, [1.0; 3], |node, part| {
                place += position(unknowns, node).component_mul(&Vector3::from(part));
            });
            place
        };
        let pairs = contact.contacts().iter().filter_map(|one| {
            if one.normal_force <= 0.0 {
                return None;
            }
            let pair = contact.candidates().get(one.candidate)?;
            let normal = one.normal.normalize();
            let (forces, _) = one.force.as_chunks::<3>();
            let mut first = one.nodes.iter().zip(forces).take(one.first_body).peekable();
            first.peek()?;
            let (mut force, mut place) = (Vector3::zeros(), Vector3::zeros());
            for (node, own) in first {
                let own = Vector3::from(*own);
                force += own;
                place += place_of(*node) * own.dot(&normal);
            }
            let pressed = force.dot(&normal);
            let radius = surface.edges()[pair.edges[0]].radius;
            let [of_first, (other, to)] = pair.edges.map(of_body);
            // A node that touches may be the last one, at which no edge begins.
            let (one_name, from) = match one.first_body {
                1 => of_node(one.nodes[0]),
                _ => of_first,
            };
            Some(Touch {
                names: [one_name, other],
                nodes: [from, to],
                place: place / pressed - normal * radius,
                normal,
                gap: one.distance - one.threshold,
                normal_force: pressed,
                friction: force - normal * pressed,
            })
        });
        let planes = contact.plane_contacts().iter().map(|one| {
            let normal = contact.planes()[one.plane].normal;
            let force = Vector3::from(one.force);
            let (name, node) = of_node(one.node);
            let pressed = force.dot(&normal);
            Touch {
                names: [name, format!("plane {}", one.plane)],
                nodes: [node, None],
                place: place_of(one.node) - normal * one.threshold,
                normal,
                gap: one.distance - one.threshold,
                normal_force: pressed,
                friction: force - normal * pressed,
            }
        });
        pairs.chain(planes).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::UnitQuaternion;
    use crate::mechanics::contact::{ContactModel, ContactParameters};
    use crate::mechanics::rigid_body::RigidBody;
    use crate::mechanics::scene::{RodDescription, Scene};
    use crate::mechanics::test_support::{
        assert_close, contact, drag, fixed, ground, line, obstacle, run_with, section, weight,
    };

    #[test]
    fn nodes_on_a_face_have_their_own_numbers() {
        let section = section(1e3, [1e-3; 2], 1e-3);
        let nodes = line(Vector3::zeros(), Vector3::x() * 0.1, 4);
        let sides = Vector3::new(1.0, 1.0, 0.1);
        let middle = -Vector3::z() * (0.05 + 1e-3);
        let table = RigidBody::cuboid(middle, sides, &UnitQuaternion::identity(), 0.0);
        let scene = Scene {
            rods: vec![RodDescription::uniform("rod", nodes, section, 1e-3, 0.05)],
            obstacles: vec![obstacle("table", table)],
            loads: vec![weight(-9.81 * Vector3::z())],
            contact: Some(contact(ContactModel::ImplicitContact, 1e-5)),
            ..Scene::default()
        };
        let touches = run_with(&scene, &fixed(1e-3), 5e-3).touches();
        let nodes: Vec<_> = touches.iter().map(|one| one.nodes[0]).collect();
        assert_eq!(nodes, [0, 1, 2, 3, 4].map(Some));
    }

    #[test]
    fn places_and_forces_of_contacts_carry_a_rod() {
        let radius = 1e-3;
        let stiffness = section(1e3, [1e-3; 2], 1e-3);
        // One end lies on the ground, the other on a ball.
        let ball = RigidBody::sphere(Vector3::new(0.08, 0.0, 0.0), 0.02);
        let height = 1.002 * radius;
        let nodes = line(
            Vector3::new(-0.1, 0.0, height),
            Vector3::new(0.1, 0.0, 0.0255),
            8,
        );
        let rod = RodDescription::uniform("rod", nodes, stiffness, radius, 0.05);
        let scene = Scene {
            rods: vec![rod],
            planes: vec![ground()],
            obstacles: vec![obstacle("ball", ball)],
            loads: vec![weight(-9.81 * Vector3::z()), drag(None, 2.0, 0.0)],
            contact: Some(ContactParameters {
                friction: 0.8,
                slip_tolerance: 1e-4,
                ..contact(ContactModel::ImplicitContact, 1e-5)
            }),
            ..Scene::default()
        };
        let simulation = run_with(&scene, &fixed(1e-3), 1.0);
        let touches = simulation.touches();
        let force: Vector3 = (touches.iter())
            .map(|one| one.normal * one.normal_force + one.friction)
            .sum();
        let mass = 0.05 * (0.2_f64.powi(2) + (0.0255 - height).powi(2)).sqrt();
        assert_close(force.z, mass * 9.81, 1e-3);
        let on_ball = touches.iter().find(|one| one.names[1] == "ball").unwrap();
        assert_eq!(on_ball.names[0], "rod");
        assert!(on_ball.nodes[0].is_some() && on_ball.nodes[1].is_none());
        // On the rod, near the ball, and across it.
        let away = on_ball.place - Vector3::new(0.08, 0.0, 0.0);
        assert!((away.norm() - 0.02).abs() < 1e-4, "{away}");
        assert!(on_ball.gap.abs() < 1e-4 && on_ball.friction.dot(&on_ball.normal).abs() < 1e-9);
        let on_ground = (touches.iter()).find(|one| one.names[1] == "plane 0");
        let on_ground = on_ground.unwrap();
        assert_eq!(on_ground.nodes[0], Some(0));
        assert!(on_ground.place.z.abs() < 2e-5, "{}", on_ground.place);
    }
}
