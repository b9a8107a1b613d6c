//! Balls on rods, at rest on planes and bodies.

use super::*;
use crate::mechanics::contact::ContactModel;
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{Body, LoadKind, RodDescription, Scene};
use crate::mechanics::test_support::{
    SOFT_MODELS, assert_close_in, at, contact, ground, obstacle, run, section, steady,
};
use crate::mechanics::{UnitQuaternion, Vector3};

const RADIUS: f64 = 0.02;
const THIN: f64 = 1e-3;
const MASS: f64 = 0.01;
const GRAVITY: f64 = 9.81;
const TOLERANCE: f64 = 1e-5;

fn rod(name: &str, middle: Vector3, along: Vector3) -> RodDescription {
    let stiffness = section(1e3, [1e-3; 2], 1e-3);
    let nodes = vec![middle - along, middle, middle + along];
    RodDescription::uniform(name, nodes, stiffness, THIN, 1e-3)
}

/// A ball whose centre is at a height above the origin. It encloses its short rod and falls
/// slowly.
fn falling(height: f64, model: ContactModel) -> Scene {
    let (y, z) = (Vector3::y(), Vector3::z());
    let load = |kind: LoadKind| steady(kind);
    Scene {
        rods: vec![rod("core", height * z, 5e-3 * y)],
        bodies: vec![Body::uniform_ball(at(0, 1), MASS, RADIUS)],
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
        contact: Some(contact(model, TOLERANCE)),
        ..Scene::default()
    }
}

/// Position of the ball's centre once it has come to rest, m, and the simulation.
fn rest(scene: &Scene) -> (Vector3, Simulation) {
    let simulation = run(scene, Scheme::ImplicitEuler, 1e-3, 0.3);
    (simulation.positions()[1], simulation)
}

#[test]
fn a_ball_rests_on_a_plane_at_its_radius() {
    for model in SOFT_MODELS {
        let mut scene = falling(RADIUS + 1e-3, model);
        scene.planes = vec![ground()];
        let (middle, simulation) = rest(&scene);
        let gap = middle.z - RADIUS;
        assert!(gap.abs() < 2.0 * TOLERANCE, "{model:?}: {gap:e}");
        let touches = simulation.plane_contacts();
        let touches = touches.iter();
        let pressed: f64 = touches.map(|touch| touch.force[2]).sum();
        let weight = (MASS + 1e-3 * 0.01) * GRAVITY;
        assert_close_in(model, pressed, weight, 1e-3);
    }
}

#[test]
fn a_ball_rests_on_a_sphere_and_on_a_box_at_its_radius() {
    let top = Vector3::z() * -0.05;
    let upright = UnitQuaternion::identity();
    // The contact point is away from the edges between the triangles of the face.
    let centre = top + Vector3::new(0.007, -0.004, 0.0);
    let bodies = [
        RigidBody::sphere(top, 0.05),
        RigidBody::cuboid(centre, Vector3::repeat(0.1), &upright, 1e-3),
    ];
    for body in bodies {
        for model in SOFT_MODELS {
            let mut scene = falling(RADIUS + 1e-3, model);
            scene.obstacles = vec![obstacle("below", body.clone())];
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
    for model in SOFT_MODELS {
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
    for model in SOFT_MODELS {
        let mut scene = falling(RADIUS + 1e-3, model);
        let mut pole = rod("pole", Vector3::z() * -0.03, 5e-3 * Vector3::y());
        pole.held = true;
        scene.rods.push(pole);
        scene.bodies.push(Body {
            at: at(1, 1),
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
