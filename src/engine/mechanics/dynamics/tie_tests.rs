//! Springs that act only in tension or compression.

use super::spring_tests::{MASS, STIFFNESS, rod};
use super::*;
use crate::mechanics::scene::{RodDescription, Scene, Spring, SpringForce};
use crate::mechanics::test_support::{
    MODELS, assert_close, assert_close_in, at, contact, drag, fixed_steps, gravity, ground, run,
    short_path, spring,
};
use crate::mechanics::{SceneError, Vector3};
use std::f64::consts::PI;

/// Distance between the rods of [`pair`], m.
const GAP: f64 = 0.02;

fn one_sided(only: SpringForce, rest_length: f64) -> Spring {
    Spring {
        rest_length: Some(rest_length),
        only: Some(only),
        ..spring("tie", [at(0, 4), at(1, 0)], STIFFNESS)
    }
}

/// Two collinear rods that move apart at a relative speed (m/s), with a spring between their ends.
fn pair(spring: Spring, speed: f64) -> Scene {
    let x = Vector3::x();
    let moving = |rod: RodDescription, speed: f64| RodDescription {
        velocity: x * speed,
        ..rod
    };
    Scene {
        rods: vec![
            moving(rod("left", -0.11 * x, x), -0.5 * speed),
            moving(rod("right", 0.01 * x, x), 0.5 * speed),
        ],
        springs: vec![spring],
        ..Scene::default()
    }
}

/// The rods are 5 mm from the place where the spring acts, bounce in half a period, and come back
/// with the opposite velocity.
#[test]
fn rods_bounce_on_ties_and_bumpers_as_in_theory() {
    let (speed, way) = (0.4, 5e-3);
    let frequency = (2.0 * STIFFNESS / MASS).sqrt();
    let half_period = PI / frequency;
    let end = 2.0 * way / speed + half_period;
    for (only, sign) in [
        (SpringForce::Tension, 1.0),
        (SpringForce::Compression, -1.0),
    ] {
        let scene = pair(one_sided(only, GAP + sign * way), sign * speed);
        for (scheme, bound) in [
            (Scheme::ImplicitMidpoint, 1e-3),
            (Scheme::BackwardDifferences, 1e-3),
            (Scheme::ImplicitEuler, 3e-2),
        ] {
            let step = half_period / 1000.0;
            let mut simulation = Simulation::new(&scene, &fixed_steps(scheme, step)).unwrap();
            let mut farthest = 0.0_f64;
            while simulation.time() < end {
                simulation.advance(end).unwrap();
                let positions = simulation.positions();
                farthest = farthest.max(sign * (positions[5].x - positions[4].x - GAP));
                let [momentum, _] = simulation.momenta();
                assert!(momentum.norm() < 1e-12, "{momentum}");
            }
            let deepest = way + speed / frequency;
            assert_close(farthest / deepest, 1.0, bound);
            let [left, right] = [4, 5].map(|node| simulation.velocities()[node].x);
            assert_close((right - left) / (sign * speed), -1.0, bound);
            let [left, right] = [4, 5].map(|node| simulation.positions()[node].x);
            assert!((right - left - GAP).abs() < bound * deepest);
            assert_eq!(simulation.spring_force(0), 0.0);
        }
    }
}

#[test]
fn a_slack_tie_leaves_a_motion_unchanged() {
    let speed = -0.1;
    let tied = pair(one_sided(SpringForce::Tension, GAP), speed);
    let mut free = tied.clone();
    free.springs.clear();
    for scheme in [
        Scheme::ImplicitMidpoint,
        Scheme::BackwardDifferences,
        Scheme::ImplicitEuler,
    ] {
        let [tied, free] = [&tied, &free].map(|scene| run(scene, scheme, 1e-3, 0.05));
        for (a, b) in tied.positions().iter().zip(free.positions()) {
            assert!((a - b).norm() < 1e-12);
        }
    }
}

/// A rod of 1 g hangs on two ties between a beam above and a beam below, all without slack as
/// placed: the weight stretches the upper ties, and the lower ones are slack.
#[test]
fn a_weight_between_ties_hangs_on_the_upper_ones() {
    let (x, z) = (Vector3::x(), Vector3::z());
    let held = |mut rod: RodDescription| {
        rod.held = true;
        rod
    };
    let tie = |beam: usize, node: usize| Spring {
        only: Some(SpringForce::Tension),
        ..spring("tie", [at(beam, node), at(2, node)], STIFFNESS)
    };
    let mut scene = Scene {
        rods: vec![
            held(rod("above", z * 0.05, x)),
            held(rod("below", z * -0.05, x)),
            rod("rod", Vector3::zeros(), x),
        ],
        springs: vec![tie(0, 0), tie(0, 4), tie(1, 0), tie(1, 4)],
        loads: vec![gravity(9.81)],
        ..Scene::default()
    };
    let fall = MASS * 9.81 / (2.0 * STIFFNESS);
    let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-3);
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    simulation.find_equilibrium().unwrap();
    assert_close(simulation.positions()[10].z / -fall, 1.0, 1e-3);
    assert_eq!(simulation.spring_force(2), 0.0);
    assert_close(simulation.spring_force(0), 0.5 * MASS * 9.81, 1e-4);
    // In motion, drag brings it to the same place, and to the ground with any contact model.
    scene.loads.push(drag(Some(2), 0.5, 0.0));
    let damped = run(&scene, Scheme::BackwardDifferences, 1e-3, 1.0);
    assert_close(damped.positions()[10].z / -fall, 1.0, 1e-3);
    for model in MODELS {
        let mut grounded = scene.clone();
        grounded.planes = vec![ground()];
        grounded.planes[0].point.z = -2e-3 - 0.5 * fall;
        grounded.contact = Some(contact(model, 1e-5));
        grounded.rods.remove(1);
        grounded.springs.truncate(2);
        for spring in &mut grounded.springs {
            spring.nodes[1].rod = 1;
        }
        grounded.loads.truncate(1);
        grounded.loads.push(drag(Some(1), 0.5, 0.0));
        let simulation = run(&grounded, Scheme::ImplicitEuler, 1e-3, 0.5);
        let pressed: f64 = (simulation.plane_contacts().iter())
            .map(|touch| touch.force[2])
            .sum();
        // What the ties do not carry.
        let positions = simulation.positions();
        let carried = -STIFFNESS * (positions[5].z + positions[9].z);
        let expected = MASS * 9.81 - carried;
        assert!((expected / (MASS * 9.81) - 0.5).abs() < 0.02, "{expected}");
        assert_close_in(model, pressed, expected, 1e-3);
    }
}

#[test]
fn paths_of_equilibria_refuse_one_sided_springs() {
    let scene = pair(one_sided(SpringForce::Tension, GAP), 0.0);
    let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-3);
    let simulation = Simulation::new(&scene, &parameters).unwrap();
    let refused = simulation.path(short_path()).err();
    assert!(
        matches!(&refused, Some(SimulationError::BadScene(SceneError::Unsuitable(reason))) if reason.contains("only in tension")),
        "{refused:?}"
    );
}
