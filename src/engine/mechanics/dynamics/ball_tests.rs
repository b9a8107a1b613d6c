//! Balls that rods carry, at rest on what they touch.

use super::*;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{
    Body, Load, LoadKind, Obstacle, Plane, RodDescription, RodNode, Scene, Stiffness,
};
use crate::mechanics::{UnitQuaternion, Vector3};

const RADIUS: f64 = 0.02;
const THIN: f64 = 1e-3;
const MASS: f64 = 0.01;
const GRAVITY: f64 = 9.81;
const TOLERANCE: f64 = 1e-5;

fn rod(name: &str, middle: Vector3, along: Vector3) -> RodDescription {
    let stiffness = Stiffness {
        stretching: 1e3,
        bending: [1e-3; 2],
        twisting: 1e-3,
    };
    let nodes = vec![middle - along, middle, middle + along];
    RodDescription::uniform(name, nodes, stiffness, THIN, 1e-3)
}

/// A ball whose middle is at a height above the origin, on a short rod that it hides; it falls slowly.
fn falling(height: f64, model: ContactModel) -> Scene {
    let (y, z) = (Vector3::y(), Vector3::z());
    let load = |kind: LoadKind| Load {
        kind,
        schedule: Vec::new(),
    };
    Scene {
        rods: vec![rod("core", height * z, 5e-3 * y)],
        bodies: vec![Body::uniform_ball(
            RodNode { rod: 0, node: 1 },
            MASS,
            RADIUS,
        )],
        loads: vec![
            load(LoadKind::Gravity {
                acceleration: -GRAVITY * z,
            }),
            load(LoadKind::Drag {
                rod: Some(0),
                translation: 50.0,
                rotation: 1e-4,
            }),
        ],
        contact: Some(ContactParameters {
            model,
            distance_tolerance: TOLERANCE,
            ..ContactParameters::default()
        }),
        ..Scene::default()
    }
}

/// Where the middle of the ball comes to rest, m, and the simulation.
fn rest(scene: &Scene) -> (Vector3, Simulation) {
    let parameters = IntegrationParameters {
        scheme: Scheme::ImplicitEuler,
        step: StepSize::Fixed(1e-3),
        ..IntegrationParameters::default()
    };
    let mut simulation = Simulation::new(scene, &parameters).unwrap();
    while simulation.time() < 0.3 {
        simulation.advance(0.3).unwrap();
    }
    (simulation.positions()[1], simulation)
}

const MODELS: [ContactModel; 2] = [
    ContactModel::ImplicitContact,
    ContactModel::IncrementalPotential,
];

#[test]
fn a_ball_rests_on_a_plane_at_its_radius() {
    for model in MODELS {
        let mut scene = falling(RADIUS + 1e-3, model);
        scene.planes = vec![Plane {
            point: Vector3::zeros(),
            normal: Vector3::z(),
            friction: None,
        }];
        let (middle, simulation) = rest(&scene);
        let gap = middle.z - RADIUS;
        assert!(gap.abs() < 2.0 * TOLERANCE, "{model:?}: {gap:e}");
        let touches = simulation.plane_contacts().iter();
        let pressed: f64 = touches.map(|touch| touch.force[2]).sum();
        let weight = (MASS + 1e-3 * 0.01) * GRAVITY;
        assert!(
            (pressed / weight - 1.0).abs() < 1e-3,
            "{model:?}: {pressed}"
        );
    }
}

#[test]
fn a_ball_rests_on_a_sphere_and_on_a_box_at_its_radius() {
    let top = Vector3::z() * -0.05;
    let upright = UnitQuaternion::identity();
    // Away from where the triangles of the face meet.
    let centre = top + Vector3::new(0.007, -0.004, 0.0);
    let bodies = [
        RigidBody::sphere(top, 0.05),
        RigidBody::cuboid(centre, Vector3::repeat(0.1), &upright, 1e-3),
    ];
    for body in bodies {
        for model in MODELS {
            let mut scene = falling(RADIUS + 1e-3, model);
            scene.obstacles = vec![Obstacle {
                name: "below".into(),
                body: body.clone(),
                ..Obstacle::default()
            }];
            let (middle, _) = rest(&scene);
            let gap = middle.z - RADIUS;
            assert!(gap.abs() < 2.0 * TOLERANCE, "{model:?}: {gap:e}");
        }
    }
}

#[test]
fn a_ball_rests_between_two_rails() {
    let half = 0.6 * (RADIUS + THIN);
    let rail = |name: &str, side: f64| {
        let mut rail = rod(name, Vector3::x() * side * half, 0.1 * Vector3::y());
        rail.held = true;
        rail
    };
    for model in MODELS {
        let height = 0.8 * (RADIUS + THIN);
        let mut scene = falling(height + 1e-3, model);
        scene.rods.extend([rail("left", -1.0), rail("right", 1.0)]);
        let (middle, _) = rest(&scene);
        let gap = middle.z - height;
        assert!(gap.abs() < 3.0 * TOLERANCE, "{model:?}: {gap:e}");
        assert!(middle.xy().norm() < TOLERANCE, "{middle}");
    }
}

#[test]
fn a_ball_rests_on_a_ball_that_is_held() {
    for model in MODELS {
        let mut scene = falling(RADIUS + 1e-3, model);
        let mut pole = rod("pole", Vector3::z() * -0.03, 5e-3 * Vector3::y());
        pole.held = true;
        scene.rods.push(pole);
        scene.bodies.push(Body {
            at: RodNode { rod: 1, node: 1 },
            inertia: None,
            ball: Some(0.03),
            ..scene.bodies[0].clone()
        });
        let (middle, _) = rest(&scene);
        let gap = middle.z - RADIUS;
        assert!(gap.abs() < 2.0 * TOLERANCE, "{model:?}: {gap:e}");
    }
}

#[test]
fn balls_that_overlap_as_placed_are_named() {
    let mut scene = falling(0.5 * RADIUS, ContactModel::ImplicitContact);
    let mut rail = rod("rail", Vector3::zeros(), 0.1 * Vector3::x());
    rail.held = true;
    scene.rods.push(rail);
    let error = Simulation::new(&scene, &IntegrationParameters::default());
    let error = error.err().unwrap().to_string();
    assert!(
        error.contains("the ball at node 1 of rod `core`"),
        "{error}"
    );
}
