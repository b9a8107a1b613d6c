//! Free rigid bodies: in flight, sliding, toppling, stacked, and with rods.

use super::*;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{FreeBody, Obstacle, RodDescription, Scene};
use crate::mechanics::test_support::{
    SOFT_MODELS, advance_to, assert_close, assert_close_in, clamp, contact, drag, farthest, fixed,
    fixed_steps, ground, line, obstacle, resumed, run, run_with, section, weight,
};
use crate::mechanics::{UnitQuaternion, Vector3};

pub(super) const GRAVITY: f64 = 9.81;
const DENSITY: f64 = 500.0;
const ROUNDING: f64 = 1e-3;
pub(super) const TOLERANCE: f64 = 1e-5;

/// A uniform box of three sides, m.
pub(super) fn cuboid(name: &str, centre: Vector3, sides: [f64; 3]) -> FreeBody {
    let mass = DENSITY * sides.iter().product::<f64>();
    let squares: f64 = sides.iter().map(|side| side * side).sum();
    let axes = UnitQuaternion::identity();
    FreeBody {
        name: name.into(),
        shape: RigidBody::cuboid(centre, Vector3::from(sides), &axes, ROUNDING),
        mass,
        centre,
        inertia: sides.map(|side| mass * (squares - side * side) / 12.0),
        axes,
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
        friction: None,
        axle: None,
        joints: Vec::new(),
    }
}

/// A body that spins in free fall.
fn thrown() -> Scene {
    let centre = Vector3::new(0.1, -0.2, 0.3);
    let body = FreeBody {
        velocity: Vector3::new(0.4, 0.1, 1.0),
        angular_velocity: Vector3::new(2.0, 9.0, 1.0),
        ..cuboid("box", centre, [0.05, 0.08, 0.12])
    };
    Scene {
        free_bodies: vec![body],
        loads: vec![weight(-GRAVITY * Vector3::z())],
        ..Scene::default()
    }
}

/// Angular momentum about the centre of mass, kg m²/s.
fn spin(simulation: &Simulation) -> Vector3 {
    let [momentum, angular] = simulation.momenta();
    angular - simulation.positions()[0].cross(&momentum)
}

#[test]
fn a_body_in_flight_keeps_its_angular_momentum_and_falls_along_a_parabola() {
    let scene = thrown();
    let body = &scene.free_bodies[0];
    let mut simulation = run(&scene, Scheme::BackwardDifferences, 1e-3, 0.0);
    let (before, energies) = (spin(&simulation), simulation.energies());
    let turning = Vector3::from(body.inertia).component_mul(&body.angular_velocity);
    assert!((before - turning).norm() < 1e-12 * turning.norm());
    advance_to(&mut simulation, 0.5);
    let place = body.centre + body.velocity * 0.5 - Vector3::z() * (0.125 * GRAVITY);
    assert!((simulation.positions()[0] - place).norm() < 1e-6);
    let after = spin(&simulation);
    assert!((after - before).norm() < 1e-5 * before.norm(), "{after}");
    let total = |energies: &Energies| energies.kinetic + energies.gravitational;
    assert_close(total(&simulation.energies()), total(&energies), 1e-5);
    // Its shape is kept exactly.
    let positions = simulation.positions();
    for (x, placed) in positions[1..].iter().zip(&body.shape.vertices) {
        let arms = [x - positions[0], placed - body.centre].map(|arm| arm.norm());
        assert!((arms[0] - arms[1]).abs() < 1e-15, "{arms:?}");
    }
}

#[test]
fn implicit_euler_conserves_angular_momentum_and_does_not_damp_spin() {
    let mut scene = thrown();
    let mut simulation = run(&scene, Scheme::ImplicitEuler, 1e-3, 0.0);
    let before = spin(&simulation);
    for end in [0.1, 0.5] {
        advance_to(&mut simulation, end);
        let lost = (spin(&simulation) - before).norm() / before.norm();
        assert!(lost < 1e-6, "{end} {lost:e}");
    }
    // A body that turns about a principal axis keeps its angular velocity.
    scene.free_bodies[0].angular_velocity = Vector3::y() * 100.0;
    scene.free_bodies[0].velocity = Vector3::zeros();
    let mut simulation = run(&scene, Scheme::ImplicitEuler, 1e-3, 0.01);
    let turning = |simulation: &Simulation| {
        let energies = simulation.energies();
        energies.kinetic
            - 0.5 * scene.free_bodies[0].mass * simulation.velocities()[0].norm_squared()
    };
    let before = turning(&simulation);
    advance_to(&mut simulation, 0.5);
    assert_close(turning(&simulation), before, 1e-9);
}

#[test]
fn a_checkpoint_of_free_bodies_is_exact() {
    let mut scene = thrown();
    scene.planes = vec![ground()];
    scene.contact = Some(contact(ContactModel::ImplicitContact, TOLERANCE));
    let parameters = fixed(2e-3);
    let mut simulation = run_with(&scene, &parameters, 0.3);
    let mut copy = resumed(&scene, &parameters, &simulation);
    for simulation in [&mut simulation, &mut copy] {
        advance_to(simulation, 0.6);
    }
    assert_eq!(simulation.positions(), copy.positions());
}

/// A box on the ground, which is tilted by an angle (rad) about y by a tilt of gravity.
pub(super) fn on_incline(model: ContactModel, sides: [f64; 3], friction: f64, angle: f64) -> Scene {
    let centre = Vector3::z() * (0.5 * sides[2] + 0.5 * TOLERANCE);
    let down = Vector3::new(angle.sin(), 0.0, -angle.cos());
    Scene {
        free_bodies: vec![cuboid("box", centre, sides)],
        planes: vec![ground()],
        loads: vec![weight(down * GRAVITY)],
        contact: Some(ContactParameters {
            friction,
            slip_tolerance: 1e-5,
            ..contact(model, TOLERANCE)
        }),
        ..Scene::default()
    }
}

#[test]
fn a_box_slides_down_an_incline_with_the_acceleration_of_coulomb() {
    for model in SOFT_MODELS {
        let (angle, friction) = (0.5_f64, 0.3);
        let scene = on_incline(model, [0.1, 0.08, 0.04], friction, angle);
        let found = acceleration(&scene, Scheme::ImplicitEuler, 1e-3);
        let expected = GRAVITY * (angle.sin() - friction * angle.cos());
        assert_close_in(model, found, expected, 1e-4);
    }
}

/// Acceleration along the incline between 0.1 and 0.3 s, m/s².
pub(super) fn acceleration(scene: &Scene, scheme: Scheme, step: f64) -> f64 {
    let mut simulation = run(scene, scheme, step, 0.1);
    let before = simulation.velocities()[0].x;
    advance_to(&mut simulation, 0.3);
    (simulation.velocities()[0].x - before) / 0.2
}

#[test]
fn a_ball_rolls_down_an_incline_and_slips_on_a_steep_one() {
    let (radius, mass) = (0.02, 0.05);
    let centre = Vector3::z() * (radius + 0.5 * TOLERANCE);
    let ball = FreeBody {
        shape: RigidBody::sphere(centre, radius),
        mass,
        inertia: [0.4 * mass * radius * radius; 3],
        ..cuboid("ball", centre, [radius; 3])
    };
    let on = |model, friction, angle| Scene {
        free_bodies: vec![ball.clone()],
        ..on_incline(model, [1.0; 3], friction, angle)
    };
    for model in SOFT_MODELS {
        let angle = 0.3_f64;
        let rolling = 5.0 / 7.0 * GRAVITY * angle.sin();
        let found = acceleration(&on(model, 0.4, angle), Scheme::ImplicitEuler, 1e-3);
        assert_close_in(model, found, rolling, 1e-3);
        let angle = 0.9_f64;
        let found = acceleration(&on(model, 0.2, angle), Scheme::ImplicitEuler, 1e-3);
        let slipping = GRAVITY * (angle.sin() - 0.2 * angle.cos());
        assert_close_in(model, found, slipping, 1e-4);
    }
    let model = ContactModel::ImplicitContact;
    let found = acceleration(&on(model, 0.4, 0.3), Scheme::BackwardDifferences, 1e-3);
    assert_close(found, 5.0 / 7.0 * GRAVITY * 0.3_f64.sin(), 1e-3);
}

#[test]
fn a_body_with_its_own_friction_slides_with_the_geometric_mean() {
    let angle = 0.5_f64;
    let plate = RigidBody::cuboid(
        Vector3::new(0.3, 0.0, -0.05),
        Vector3::new(1.0, 0.3, 0.1),
        &UnitQuaternion::identity(),
        0.0,
    );
    for model in SOFT_MODELS {
        for (own, friction) in [(Some(0.4), 0.2), (None, 0.1)] {
            let mut on_plane = on_incline(model, [0.1, 0.08, 0.04], 0.5, angle);
            on_plane.free_bodies[0].friction = Some(0.1);
            let mut on_plate = on_plane.clone();
            on_plane.planes[0].friction = own;
            on_plate.planes.clear();
            on_plate.obstacles.push(Obstacle {
                friction: own,
                ..obstacle("plate", plate.clone())
            });
            for scene in [on_plane, on_plate] {
                let found = acceleration(&scene, Scheme::ImplicitEuler, 1e-3);
                let expected = GRAVITY * (angle.sin() - friction * angle.cos());
                assert_close_in((model, friction), found, expected, 1e-3);
            }
        }
    }
}

#[test]
fn a_box_sticks_below_the_angle_of_friction() {
    for model in SOFT_MODELS {
        let scene = on_incline(model, [0.1, 0.08, 0.04], 0.3, 0.25);
        let simulation = run_with(&scene, &fixed(1e-3), 0.3);
        let speed = simulation.velocities()[0].norm();
        assert!(speed < 1e-5, "{model:?}: {speed:e}");
    }
}

#[test]
fn a_tall_box_topples_where_its_weight_leaves_its_foot() {
    // It stands on its rounded edges.
    let sides = [0.04, 0.04, 0.12];
    let foot = 0.5 * sides[0] - ROUNDING;
    let height = 0.5 * sides[2];
    let limit = (foot / height).atan();
    for (angle, topples) in [(0.98 * limit, false), (1.02 * limit, true)] {
        let scene = on_incline(ContactModel::ImplicitContact, sides, 0.8, angle);
        let simulation = run_with(&scene, &fixed(1e-3), 0.5);
        let moved = simulation.positions()[0] - scene.free_bodies[0].centre;
        assert_eq!(moved.norm() > 2e-3, topples, "{angle}: {moved}");
    }
}

#[test]
fn boxes_rest_on_each_other() {
    for model in SOFT_MODELS {
        let sides = [0.1, 0.08, 0.04];
        let mut scene = on_incline(model, sides, 0.5, 0.0);
        for (level, shift) in [(1.0, 0.013), (2.0, -0.011)] {
            let centre = Vector3::new(shift, shift, 0.5 * sides[2])
                + Vector3::z() * (level * (sides[2] + TOLERANCE) + 0.5 * TOLERANCE);
            scene.free_bodies.push(cuboid("next", centre, sides));
        }
        let mut simulation = run_with(&scene, &fixed(1e-3), 0.0);
        let (mut steps, mut iterations) = (0, 0);
        while simulation.time() < 0.3 {
            let report = simulation.advance(0.3).unwrap();
            steps += 1;
            iterations += report.newton_iterations;
        }
        // None is repeated, and at rest few need more than one iteration.
        let most = match model {
            ContactModel::ImplicitContact => 1,
            _ => 8,
        };
        assert!(
            steps == 300 && iterations <= most * steps,
            "{model:?} {steps} {iterations}"
        );
        for (body, range) in scene.free_bodies.iter().zip(simulation.rod_ranges()) {
            let moved = simulation.positions()[range.first_node] - body.centre;
            assert!(moved.norm() < 4.0 * TOLERANCE, "{model:?}: {moved}");
        }
        // The floor carries them all.
        let carried: f64 = (simulation.plane_contacts().iter())
            .map(|touch| touch.force[2])
            .sum();
        let mass: f64 = scene.free_bodies.iter().map(|body| body.mass).sum();
        assert_close_in(model, carried, mass * GRAVITY, 1e-3);
    }
}

#[test]
fn a_body_turned_in_flight_begins_again_where_it_ended() {
    let apart = |step: f64| {
        let mut scene = thrown();
        let parameters = fixed_steps(Scheme::ImplicitEuler, step);
        let mut simulation = run_with(&scene, &parameters, 0.2);
        scene.start = Some(simulation.as_start());
        let mut next = run_with(&scene, &parameters, 0.0);
        assert!(farthest(simulation.positions(), next.positions()) < 1e-12);
        advance_to(&mut simulation, 0.4);
        advance_to(&mut next, 0.2);
        farthest(simulation.positions(), next.positions())
    };
    // The velocities of steps are chords, those of a start tangents.
    let [coarse, fine] = [1e-3, 5e-4].map(apart);
    assert!(coarse < 2e-4 && fine < 0.55 * coarse, "{coarse:e} {fine:e}");
}

#[test]
fn a_rod_bends_under_the_box_that_falls_on_it() {
    let stiffness = section(1e4, [2e-2; 2], 1e-2);
    let rod = RodDescription::uniform(
        "beam",
        line(Vector3::x() * -0.1, Vector3::x() * 0.1, 20),
        stiffness,
        2e-3,
        0.02,
    );
    for model in SOFT_MODELS {
        let centre = Vector3::z() * (0.02 + 2e-3 + TOLERANCE);
        let scene = Scene {
            rods: vec![rod.clone()],
            clamps: vec![clamp(0, 0), clamp(0, 20)],
            free_bodies: vec![cuboid("load", centre, [0.02, 0.06, 0.04])],
            loads: vec![weight(-GRAVITY * Vector3::z()), drag(Some(0), 2.0, 1e-4)],
            contact: Some(ContactParameters {
                friction: 0.4,
                ..contact(model, TOLERANCE)
            }),
            ..Scene::default()
        };
        let simulation = run_with(&scene, &fixed(1e-3), 1.0);
        let body = simulation.positions()[21];
        let force = simulation.reaction(0).z + simulation.reaction(20).z;
        let expected = (scene.free_bodies[0].mass + 0.2 * 0.02) * GRAVITY;
        assert_close_in(model, force, expected, 1e-3);
        assert!(body.z < centre.z, "{model:?} {body}");
    }
}
