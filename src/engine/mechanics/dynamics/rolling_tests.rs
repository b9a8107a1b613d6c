//! Friction at the surfaces: rods roll, drive each other and walk, against closed forms.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters, FrictionAt};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::{Clamp, Motion, Obstacle, RodDescription, Scene};
use crate::mechanics::test_support::{
    SOFT_MODELS, advance_to, assert_close_in, clamp, fixed, ground, line, obstacle, pin,
    point_force, run_with, straight_rod, weight,
};

const RADIUS: f64 = 5e-3;
const GRAVITY: f64 = 9.81;

fn rubbing(model: ContactModel, friction: f64) -> ContactParameters {
    ContactParameters {
        friction,
        friction_at: FrictionAt::Surface,
        slip_tolerance: 1e-4,
        stiffness_factor: match model {
            ContactModel::IncrementalPotential => 1.0,
            _ => 1e5,
        },
        ..crate::mechanics::test_support::contact(model, 5e-5)
    }
}

/// A rod of two edges along x, its axis at a height, m.
fn rod_at(y: f64, z: f64) -> RodDescription {
    let from = Vector3::new(-0.05, y, z);
    RodDescription {
        centreline: line(from, from + Vector3::x() * 0.1, 2),
        ..straight_rod(2, 0.1)
    }
}

/// A rod on an incline of an angle (rad) that descends along y.
fn on_incline(model: ContactModel, friction: f64, angle: f64) -> Scene {
    Scene {
        rods: vec![rod_at(0.0, RADIUS + 2e-5)],
        loads: vec![weight(
            Vector3::new(0.0, angle.sin(), -angle.cos()) * GRAVITY,
        )],
        planes: vec![ground()],
        contact: Some(rubbing(model, friction)),
        ..Scene::default()
    }
}

/// Velocity of the middle node along y (m/s) and rate of the angle of the first edge, rad/s.
fn rates(simulation: &Simulation) -> [f64; 2] {
    let velocity = &simulation.state.velocity;
    [velocity[STRIDE + 1], velocity[3]]
}

/// Accelerations of these between two times.
fn accelerations(scene: &Scene, [start, end]: [f64; 2]) -> [f64; 2] {
    let mut simulation = run_with(scene, &fixed(5e-4), start);
    let before = rates(&simulation);
    advance_to(&mut simulation, end);
    let after = rates(&simulation);
    std::array::from_fn(|k| (after[k] - before[k]) / (end - start))
}

#[test]
fn a_rod_rolls_down_an_incline_at_two_thirds_of_the_acceleration() {
    for model in SOFT_MODELS {
        let angle = 0.3_f64;
        let [along, spin] = accelerations(&on_incline(model, 0.5, angle), [0.05, 0.25]);
        let expected = 2.0 / 3.0 * GRAVITY * angle.sin();
        assert_close_in(model, along, expected, 1e-4);
        assert_close_in(model, spin, -expected / RADIUS, 1e-4);
    }
}

#[test]
fn on_a_steep_incline_it_slips() {
    for model in SOFT_MODELS {
        // tan α = 1 > 3 μ
        let (angle, friction) = (std::f64::consts::FRAC_PI_4, 0.2);
        let [along, spin] = accelerations(&on_incline(model, friction, angle), [0.05, 0.15]);
        let expected = GRAVITY * (angle.sin() - friction * angle.cos());
        let turning = -2.0 * friction * GRAVITY * angle.cos() / RADIUS;
        assert_close_in(model, along, expected, 1e-4);
        assert_close_in(model, spin, turning, 1e-4);
    }
}

#[test]
fn with_friction_on_the_centreline_nothing_rolls() {
    let mut scene = on_incline(ContactModel::ImplicitContact, 0.5, 0.3);
    scene.contact.as_mut().unwrap().friction_at = FrictionAt::Centreline;
    let simulation = run_with(&scene, &fixed(5e-4), 0.1);
    let [along, spin] = rates(&simulation);
    assert!(spin.abs() < 1e-5, "{spin}");
    assert!(along < 1e-4, "it creeps: {along}");
}

#[test]
fn a_rod_that_slides_rolls_in_the_end_at_two_thirds_of_its_speed() {
    for model in SOFT_MODELS {
        let mut scene = on_incline(model, 0.3, 0.0);
        if model == ContactModel::IncrementalPotential {
            // The gap at which it rests: where it is pushed up first, steps lose more energy.
            scene.rods[0] = rod_at(0.0, RADIUS + 4.3e-5);
        }
        let speed = 0.3;
        scene.rods[0].velocity = Vector3::y() * speed;
        let mut simulation = Simulation::new(&scene, &fixed(5e-5)).unwrap();
        let kinetic = 0.5 * scene.rods[0].mass_per_length * 0.1 * speed * speed;
        let mut lost = 0.0;
        while simulation.time() < 0.1 {
            lost += simulation.advance(0.1).unwrap().exchange.friction_loss;
        }
        let [along, spin] = rates(&simulation);
        assert_close_in(model, along, 2.0 / 3.0 * speed, 1e-4);
        assert_close_in(model, spin, -2.0 / 3.0 * speed / RADIUS, 1e-4);
        // The third that is lost went to friction; implicit Euler takes some of it in its steps.
        assert_close_in(model, lost, kinetic / 3.0, 5e-3);
    }
}

/// A rod that spins freely on pins at its ends, its middle pressed along −z, above something at z = 0.
fn pressed(model: ContactModel, height: f64) -> Scene {
    Scene {
        rods: vec![rod_at(0.0, height)],
        clamps: vec![pin(0, 0), pin(0, 2)],
        loads: vec![point_force(0, 1, Vector3::z() * -0.5)],
        contact: Some(rubbing(model, 0.4)),
        ..Scene::default()
    }
}

#[test]
fn rods_drive_each_other_as_gears() {
    for model in SOFT_MODELS {
        let large = 8e-3;
        let mut scene = pressed(model, large + RADIUS + 2e-5);
        let mut driver = rod_at(0.0, 0.0);
        driver.radius = large;
        driver.name = "driver".into();
        scene.rods.push(driver);
        let rate = 3.0;
        let turned = |node| Clamp {
            motion: Motion {
                angular_velocity: rate,
                ..Motion::default()
            },
            ..clamp(1, node)
        };
        scene.clamps.extend([turned(0), turned(2)]);
        let simulation = run_with(&scene, &fixed(1e-3), 1.0);
        let [_, spin] = rates(&simulation);
        let expected = -rate * large / RADIUS;
        assert_close_in(model, spin, expected, 1e-4);
    }
}

#[test]
fn a_roller_that_turns_drives_a_rod() {
    for model in SOFT_MODELS {
        let large = 0.02;
        let mut scene = pressed(model, large + RADIUS + 2e-5);
        let ends = [-1.0, 1.0].map(|side| Vector3::x() * side);
        let rate = -2.0;
        scene.obstacles.push(Obstacle {
            motion: Motion {
                axis: Some(Vector3::x()),
                angular_velocity: rate,
                ..Motion::default()
            },
            ..obstacle("roller", RigidBody::capsule(ends, large))
        });
        let simulation = run_with(&scene, &fixed(1e-3), 1.0);
        let [_, spin] = rates(&simulation);
        let expected = -rate * large / RADIUS;
        assert_close_in(model, spin, expected, 1e-4);
    }
}

#[test]
fn a_rod_on_a_belt_ends_at_a_third_of_its_speed() {
    for model in SOFT_MODELS {
        let speed = 0.1;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corners = corners.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec();
        let sheet = RigidBody::of_mesh(corners, vec![[0, 1, 2], [0, 2, 3]], false).unwrap();
        let scene = Scene {
            rods: vec![rod_at(0.1, RADIUS + 2e-5)],
            loads: vec![weight(Vector3::z() * -GRAVITY)],
            obstacles: vec![Obstacle {
                motion: Motion {
                    translation: vec![(0.0, Vector3::zeros()), (1.0, Vector3::y() * speed)],
                    ..Motion::default()
                },
                ..obstacle("belt", sheet)
            }],
            contact: Some(rubbing(model, 0.4)),
            ..Scene::default()
        };
        let simulation = run_with(&scene, &fixed(5e-4), 0.2);
        let [along, spin] = rates(&simulation);
        assert_close_in(model, along, speed / 3.0, 1e-4);
        assert_close_in(model, spin, 2.0 / 3.0 * speed / RADIUS, 1e-4);
    }
}

#[test]
fn a_twisted_rod_on_a_table_walks() {
    for (model, rate) in SOFT_MODELS.into_iter().zip([4.0, -4.0]) {
        let length = 0.2;
        let from = Vector3::z() * (RADIUS + 2e-5);
        let rod = RodDescription {
            centreline: line(from, from + Vector3::x() * length, 10),
            ..straight_rod(10, length)
        };
        let scene = Scene {
            rods: vec![rod],
            // The frame alone: the end goes where it rolls.
            clamps: vec![Clamp {
                holds_position: false,
                motion: Motion {
                    angular_velocity: rate,
                    ..Motion::default()
                },
                ..clamp(0, 0)
            }],
            loads: vec![weight(Vector3::z() * -GRAVITY)],
            planes: vec![ground()],
            contact: Some(rubbing(model, 0.4)),
            ..Scene::default()
        };
        let simulation = run_with(&scene, &fixed(1e-3), 2.0);
        let way = simulation.positions().iter().map(|x| x.y).sum::<f64>() / 11.0;
        let [along, _] = rates(&simulation);
        // A spin about x moves the lowest points along y, so that it rolls the other way.
        assert_close_in(model, along, -rate * RADIUS, 1e-3);
        assert_close_in(model, way, -rate * RADIUS * 2.0, 0.05);
    }
}
