//! Rods on obstacles that carry them along by friction.

use super::*;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{Motion, Obstacle, Scene};
use crate::mechanics::test_support::{
    MODELS, SOFT_MODELS, advance_to, assert_close_in, contact, fixed, gravity, obstacle,
    straight_rod,
};
use crate::mechanics::{UnitQuaternion, Vector3};

const FRICTION: f64 = 0.3;
const FALL: f64 = 9.81;
const LENGTH: f64 = 0.2;
const TOLERANCE: f64 = 1e-4;

/// A rod along x about the origin, on a table that moves.
fn on_table(model: ContactModel, motion: Motion) -> Scene {
    let mut rod = straight_rod(8, LENGTH);
    let shift = Vector3::new(-0.5 * LENGTH, 0.0, rod.radius + 0.5 * TOLERANCE);
    rod.centreline.iter_mut().for_each(|node| *node += shift);
    let sides = Vector3::new(1.0, 1.0, 0.1);
    let table = RigidBody::cuboid(
        Vector3::z() * -0.05,
        sides,
        &UnitQuaternion::identity(),
        0.0,
    );
    Scene {
        rods: vec![rod],
        loads: vec![gravity(FALL)],
        obstacles: vec![Obstacle {
            motion,
            ..obstacle("table", table)
        }],
        contact: Some(ContactParameters {
            friction: FRICTION,
            slip_tolerance: 1e-3,
            ..contact(model, TOLERANCE)
        }),
        ..Scene::default()
    }
}

/// Lets a rod slide for 0.02 s on a surface with this velocity (m/s), and compares its momentum
/// with the impulse of the friction.
#[track_caller]
fn slid(scene: &Scene, model: ContactModel, surface: Vector3) -> Simulation {
    const STEP: f64 = 5e-4;
    let mass = scene.rods[0].mass_per_length * LENGTH;
    let mut simulation = Simulation::new(scene, &fixed(STEP)).unwrap();
    let mut expected = 0.0;
    while simulation.time() < 0.02 {
        simulation.advance(0.02).unwrap();
        let contacts = simulation.contacts();
        let pressure = contacts.iter().map(|pair| pair.normal_force);
        expected += FRICTION * pressure.sum::<f64>() * STEP / mass;
    }
    let mean = simulation.velocities().iter().sum::<Vector3>() / 9.0;
    let along = mean.dot(&surface.normalize());
    assert!(along < 0.9 * surface.norm(), "{model:?}: {along}");
    assert_close_in(model, along, expected, 0.02);
    simulation
}

/// While the rod slides, friction of μ times the pressure moves it, until it has the speed of the table.
#[test]
fn a_table_that_moves_takes_a_rod_along() {
    const SPEED: f64 = 0.1;
    for model in SOFT_MODELS {
        let motion = Motion {
            translation: vec![(0.0, Vector3::zeros()), (1.0, Vector3::y() * SPEED)],
            ..Motion::default()
        };
        let scene = on_table(model, motion);
        let mut simulation = slid(&scene, model, Vector3::y() * SPEED);
        advance_to(&mut simulation, 0.15);
        assert_close_in(model, simulation.velocities()[4].y, SPEED, 0.01);
    }
}

#[test]
fn a_table_that_turns_turns_a_rod_at_its_rate() {
    const RATE: f64 = 1.5;
    for model in SOFT_MODELS {
        let motion = Motion {
            axis: Some(Vector3::z()),
            angular_velocity: RATE,
            pivot: Some(Vector3::zeros()),
            ..Motion::default()
        };
        let mut simulation = Simulation::new(&on_table(model, motion), &fixed(1e-3)).unwrap();
        advance_to(&mut simulation, 0.15);
        let velocities = simulation.velocities();
        let rate = (velocities[8] - velocities[0]).norm() / LENGTH;
        assert_close_in(model, rate, RATE, 0.01);
    }
}

/// A rod along x on two rollers along y, which turn about their own axes at a rate, rad/s.
fn on_rollers(model: ContactModel, radius: f64, rate: f64) -> Scene {
    let mut scene = on_table(model, Motion::default());
    scene.obstacles = [-0.06, 0.06]
        .map(|x| {
            let centre = Vector3::new(x, 0.0, -radius);
            let motion = Motion {
                axis: Some(Vector3::y()),
                angular_velocity: rate,
                pivot: Some(centre),
                ..Motion::default()
            };
            let body = RigidBody::cylinder(centre, Vector3::y(), radius, 1.0);
            Obstacle {
                motion,
                ..obstacle("roller", body)
            }
        })
        .into();
    scene
}

/// The surfaces of round obstacles move with them, although their centrelines are at rest.
#[test]
fn rollers_take_a_rod_along() {
    const RADIUS: f64 = 0.03;
    const SPEED: f64 = 0.1;
    for model in MODELS {
        let scene = on_rollers(model, RADIUS, SPEED / RADIUS);
        let mut simulation = slid(&scene, model, Vector3::x() * SPEED);
        advance_to(&mut simulation, 0.15);
        assert_close_in(model, simulation.velocities()[4].x, SPEED, 0.01);
    }
}

/// Stages of backward differences are shorter than steps.
#[test]
fn backward_differences_take_rods_along_at_the_speed_of_surfaces() {
    const SPEED: f64 = 0.1;
    let motion = Motion {
        translation: vec![(0.0, Vector3::zeros()), (1.0, Vector3::x() * SPEED)],
        ..Motion::default()
    };
    for model in SOFT_MODELS {
        for mut scene in [
            on_table(model, motion.clone()),
            on_rollers(model, 0.03, SPEED / 0.03),
        ] {
            // Out of the reach of the contact, so that none presses at the start.
            let nodes = scene.rods[0].centreline.iter_mut();
            nodes.for_each(|node| node.z += TOLERANCE);
            let parameters = IntegrationParameters {
                scheme: Scheme::BackwardDifferences,
                ..fixed(5e-5)
            };
            let mut simulation = Simulation::new(&scene, &parameters).unwrap();
            advance_to(&mut simulation, 0.15);
            let mean = simulation.velocities().iter().sum::<Vector3>().x / 9.0;
            assert_close_in(model, mean, SPEED, 0.01);
        }
    }
}

#[test]
fn a_tube_that_spins_takes_a_rod_in_it_along() {
    const RADIUS: f64 = 0.3;
    const SPEED: f64 = 0.1;
    for model in MODELS {
        let mut scene = on_table(model, Motion::default());
        let axis = Vector3::z() * RADIUS;
        let body = RigidBody::tube([axis - Vector3::x(), axis + Vector3::x()], RADIUS);
        let motion = Motion {
            axis: Some(Vector3::x()),
            angular_velocity: SPEED / RADIUS,
            pivot: Some(axis),
            ..Motion::default()
        };
        scene.obstacles = vec![Obstacle {
            motion,
            ..obstacle("tube", body)
        }];
        slid(&scene, model, Vector3::y() * SPEED);
    }
}
