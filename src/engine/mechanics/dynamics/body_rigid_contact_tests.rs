//! Contact of free bodies by complementarity: exact sticking, sliding and rolling, stacks, momenta,
//! agreement with the implicit contact model.

use super::free_body_tests::{GRAVITY, TOLERANCE, acceleration, cuboid, on_incline};
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{BodyJoint, FreeBody, JointKind, RodDescription, Scene};
use crate::mechanics::test_support::{
    assert_close, assert_close_in, at, clamp, contact, drag, farthest, fixed, line, run_with,
    section, weight,
};

const RIGID: ContactModel = ContactModel::Complementarity;
const SIDES: [f64; 3] = [0.1, 0.08, 0.04];

/// Places the bodies of a scene on the ground, without the gap that other models leave.
fn lowered(mut scene: Scene) -> Scene {
    for body in &mut scene.free_bodies {
        let by = Vector3::z() * (-0.5 * TOLERANCE);
        body.centre += by;
        body.shape
            .vertices
            .iter_mut()
            .for_each(|vertex| *vertex += by);
    }
    scene
}

#[test]
fn a_box_on_an_incline_sticks_and_slides_exactly_by_coulomb() {
    let friction = 0.3_f64;
    let limit = friction.atan();
    let sticking = lowered(on_incline(RIGID, SIDES, friction, limit - 1e-3));
    let simulation = run_with(&sticking, &fixed(1e-3), 0.3);
    let speed = simulation.velocities()[0].norm();
    println!("sticking: {speed:.1e} m/s");
    assert!(speed < 1e-12, "{speed:e}");
    for angle in [limit + 1e-3, 0.5] {
        let scene = lowered(on_incline(RIGID, SIDES, friction, angle));
        let found = acceleration(&scene, Scheme::ImplicitEuler, 1e-3);
        let expected = GRAVITY * (angle.sin() - friction * angle.cos());
        println!("{angle:.4}: {found:.9} of {expected:.9} m/s²");
        assert!(
            (found - expected).abs() < 1e-6 * GRAVITY,
            "{found} {expected}"
        );
    }
}

fn ball(centre: Vector3, radius: f64) -> FreeBody {
    let mass = 0.05;
    FreeBody {
        shape: RigidBody::sphere(centre, radius),
        mass,
        inertia: [0.4 * mass * radius * radius; 3],
        ..cuboid("ball", centre, [radius; 3])
    }
}

#[test]
fn a_ball_rolls_down_an_incline_and_slips_on_a_steep_one() {
    let radius = 0.02;
    let on = |friction, angle| Scene {
        free_bodies: vec![ball(Vector3::z() * radius, radius)],
        ..on_incline(RIGID, [1.0; 3], friction, angle)
    };
    for (friction, angle) in [(0.4, 0.3_f64), (0.2, 0.9)] {
        let scene = on(friction, angle);
        // In a step of 1 ms a ball turns by up to 0.05 rad, with an error of the square of that.
        let found = acceleration(&scene, Scheme::ImplicitEuler, 2e-4);
        let rolling = 5.0 / 7.0 * GRAVITY * angle.sin();
        let slipping = GRAVITY * (angle.sin() - friction * angle.cos());
        let expected = rolling.max(slipping);
        println!("{angle}: {found:.9} of {expected:.9} m/s²");
        assert_close(found, expected, 1e-5);
        // The spin of a ball that slips follows from the moment of its friction.
        let simulation = run_with(&scene, &fixed(2e-4), 0.1);
        let motion = simulation.body_motion(0);
        let spin = if rolling > slipping {
            rolling / radius
        } else {
            2.5 * friction * GRAVITY * angle.cos() / radius
        };
        let turned = motion.turn.norm();
        assert_close(turned, 0.5 * spin * 0.1 * 0.1002, 1e-5);
    }
}

#[test]
fn boxes_rest_on_each_other_without_creep() {
    let mut scene = lowered(on_incline(RIGID, SIDES, 0.5, 0.1));
    for (level, shift) in [(1.0, 0.013), (2.0, -0.011)] {
        let centre = Vector3::new(shift, shift, (0.5 + level) * SIDES[2]);
        scene.free_bodies.push(cuboid("next", centre, SIDES));
    }
    let simulation = run_with(&scene, &fixed(1e-3), 0.3);
    for (body, range) in scene.free_bodies.iter().zip(simulation.rod_ranges()) {
        let moved = simulation.positions()[range.first_node] - body.centre;
        let speed = simulation.velocities()[range.first_node].norm();
        println!("moved {:.1e} m, {speed:.1e} m/s", moved.norm());
        assert!(moved.norm() < 1e-9, "{moved}");
        assert!(speed < 1e-10, "{speed:e}");
    }
    let touches = simulation.plane_contacts();
    let carried: f64 = touches.iter().map(|touch| touch.normal_force).sum();
    let mass: f64 = scene.free_bodies.iter().map(|body| body.mass).sum();
    assert_close(carried, mass * GRAVITY * 0.1_f64.cos(), 1e-6);
}

#[test]
fn bodies_that_collide_keep_their_momenta() {
    let mut first = cuboid("first", Vector3::zeros(), SIDES);
    first.angular_velocity = Vector3::new(0.3, 1.0, -0.5);
    let mut second = cuboid(
        "second",
        Vector3::new(0.03, 0.02, 0.047),
        [0.05, 0.05, 0.05],
    );
    second.velocity = Vector3::new(0.1, -0.05, -0.4);
    let third = FreeBody {
        velocity: Vector3::new(-0.2, 0.3, -0.5),
        ..ball(Vector3::new(-0.03, -0.01, 0.045), 0.02)
    };
    let scene = Scene {
        free_bodies: vec![first, second, third],
        contact: Some(ContactParameters {
            friction: 0.3,
            ..contact(RIGID, TOLERANCE)
        }),
        ..Scene::default()
    };
    let changes = [1e-3, 5e-4].map(|step| {
        let mut simulation = Simulation::new(&scene, &fixed(step)).unwrap();
        let before = simulation.momenta();
        let mut touched = 0;
        let mut last = simulation.energies().kinetic;
        while simulation.time() < 0.1 - 0.5 * step {
            touched += simulation.advance(0.1).unwrap().contacts;
            let now = simulation.energies().kinetic;
            // Spin in flight keeps its energy to second order in the step.
            assert!(now <= last * (1.0 + 1e-7), "{now:e} after {last:e}");
            last = now;
        }
        assert!(touched > 3, "{touched}");
        let after = simulation.momenta();
        let change = [0, 1].map(|k| (after[k] - before[k]).norm() / before[k].norm());
        println!(
            "{step}: {:.1e} {:.1e}, {touched} contacts",
            change[0], change[1]
        );
        change
    });
    let [[linear, coarse], [_, fine]] = changes;
    assert!(linear < 1e-9, "{linear:e}");
    // Bodies turn within the step of an impact.
    assert!(coarse < 5e-3 && fine < 0.7 * coarse, "{changes:?}");
}

/// A beam between clamps under a box, in which a second rod is fixed.
fn loaded_beam(model: ContactModel) -> Scene {
    let stiffness = section(1e4, [2e-2; 2], 1e-2);
    let rod = |name: &str, nodes: Vec<Vector3>| {
        RodDescription::uniform(name, nodes, stiffness, 2e-3, 0.02)
    };
    let ends = Vector3::x() * 0.1;
    let centre = Vector3::new(0.003, 0.0, 0.02 + 2e-3 + 0.1 * TOLERANCE);
    let top = centre + Vector3::z() * 0.02;
    let load = FreeBody {
        joints: vec![BodyJoint {
            at: at(1, 0),
            kind: JointKind::Rigid,
        }],
        ..cuboid("load", centre, [0.02, 0.06, 0.04])
    };
    Scene {
        rods: vec![
            rod("beam", line(-ends, ends, 20)),
            rod("mast", line(top, top + Vector3::z() * 0.05, 5)),
        ],
        clamps: vec![clamp(0, 0), clamp(0, 20)],
        free_bodies: vec![load],
        loads: vec![
            weight(-GRAVITY * Vector3::z()),
            drag(Some(0), 2.0, 1e-4),
            drag(Some(1), 0.5, 1e-4),
        ],
        contact: Some(ContactParameters {
            friction: 0.4,
            slip_tolerance: 1e-5,
            ..contact(model, TOLERANCE)
        }),
        ..Scene::default()
    }
}

#[test]
fn a_beam_bends_under_a_body_as_with_the_implicit_model() {
    let run = |model| run_with(&loaded_beam(model), &fixed(1e-3), 1.0);
    let [rigid, soft] = [RIGID, ContactModel::ImplicitContact].map(run);
    let apart = farthest(rigid.positions(), soft.positions());
    println!("{apart:.1e} m from the implicit model");
    let scene = loaded_beam(RIGID);
    let force = rigid.reaction(0).z + rigid.reaction(20).z;
    let expected = (scene.free_bodies[0].mass + 0.25 * 0.02) * GRAVITY;
    assert_close_in("weight", force, expected, 1e-3);
    assert!(apart < TOLERANCE, "{apart:e}");
}
