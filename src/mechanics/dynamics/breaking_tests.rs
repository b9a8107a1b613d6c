//! Joints that break in motion.

use super::spring_tests::{MASS, STIFFNESS, parameters, rod};
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{Joint, JointKind, Load, LoadKind, RodNode, Scene, Spring};
use std::f64::consts::PI;

const SPEED: f64 = 0.4;

fn nodes() -> [RodNode; 2] {
    [RodNode { rod: 0, node: 4 }, RodNode { rod: 1, node: 0 }]
}

/// Angular frequency of two such rods that a spring ties, rad/s, and the largest force on it when they part at [`SPEED`], N.
fn swing() -> (f64, f64) {
    let frequency = (2.0 * STIFFNESS / MASS).sqrt();
    (frequency, STIFFNESS * SPEED / frequency)
}

/// Two rods in a line that part, the spring between them half as strong as the force that would stop them.
fn parting() -> Scene {
    let x = Vector3::x();
    let mut rods = vec![rod("left", -0.15 * x, x), rod("right", 0.05 * x, x)];
    rods[0].velocity = -0.5 * SPEED * x;
    rods[1].velocity = 0.5 * SPEED * x;
    Scene {
        rods,
        springs: vec![Spring {
            name: "thread".into(),
            nodes: nodes(),
            stiffness: STIFFNESS,
            rest_length: None,
            strength: Some(0.5 * swing().1),
        }],
        ..Scene::default()
    }
}

/// A rod that hangs from a held one by a ball joint, pulled down by a force that grows by 1 N/s.
fn hanging() -> Scene {
    let (x, z) = (Vector3::x(), Vector3::z());
    let mut beam = rod("beam", -0.1 * x, x);
    beam.held = true;
    Scene {
        rods: vec![beam, rod("rod", Vector3::zeros(), -z)],
        joints: vec![Joint {
            name: "hook".into(),
            nodes: nodes(),
            kind: JointKind::Ball,
            strength: Some(0.1),
        }],
        loads: vec![Load {
            kind: LoadKind::Force {
                rod: 1,
                node: 4,
                force: -z,
            },
            schedule: vec![(0.0, 0.0), (1.0, 1.0)],
        }],
        ..Scene::default()
    }
}

fn run(scene: &Scene, scheme: Scheme, step: f64, end: f64) -> Simulation {
    let mut simulation = Simulation::new(scene, &parameters(scheme, step)).unwrap();
    while simulation.time() < end {
        simulation.advance(end).unwrap();
    }
    simulation
}

#[test]
fn a_spring_breaks_when_its_force_is_passed_and_lets_go() {
    let (frequency, largest) = swing();
    let step = 1e-3 / frequency;
    // sin ωt = ½.
    let expected = PI / 6.0 / frequency;
    for (scheme, bound) in [
        (Scheme::ImplicitMidpoint, 2e-3),
        (Scheme::BackwardDifferences, 2e-3),
        (Scheme::ImplicitEuler, 1e-2),
    ] {
        let simulation = run(&parting(), scheme, step, 2.0 * expected);
        let [Some(Break { time, force })] = simulation.breaks()[..] else {
            panic!("{:?}", simulation.breaks());
        };
        assert!(
            (time - expected).abs() < 1.5 * step + bound * expected,
            "{scheme:?}: {time} {expected}"
        );
        assert!(force > 0.5 * largest && force < 0.505 * largest, "{force}");
        let mean = |rod: usize| {
            let velocities = &simulation.velocities()[5 * rod..5 * rod + 5];
            let inner: Vector3 = velocities[1..4].iter().sum();
            ((velocities[0] + velocities[4]) * 0.5 + inner) / 4.0
        };
        let apart = (mean(1) - mean(0)).x / SPEED;
        assert!(
            (apart - 0.75_f64.sqrt()).abs() < bound,
            "{scheme:?}: {apart}"
        );
        let remarks = simulation.remarks();
        assert!(
            remarks
                .iter()
                .any(|remark| remark.contains("joint `thread` broke at t = ")),
            "{remarks:?}"
        );
        let [momentum, _] = simulation.momenta();
        assert!(momentum.norm() < 1e-12, "{momentum}");
    }
}

#[test]
fn a_spring_that_bears_the_force_holds() {
    let mut scene = parting();
    scene.springs[0].strength = Some(1.01 * swing().1);
    let (frequency, _) = swing();
    let end = 2.0 * PI / frequency;
    let simulation = run(&scene, Scheme::ImplicitMidpoint, 1e-3 * end, end);
    assert_eq!(simulation.breaks(), [None]);
}

#[test]
fn a_ball_joint_breaks_at_the_force_that_holds_the_rod_and_lets_it_fall() {
    let expected = 0.1;
    for scheme in [
        Scheme::ImplicitEuler,
        Scheme::BackwardDifferences,
        Scheme::ImplicitMidpoint,
    ] {
        let step = 2e-4;
        let simulation = run(&hanging(), scheme, step, expected + 0.02);
        let [Some(Break { time, force })] = simulation.breaks()[..] else {
            panic!("{:?}", simulation.breaks());
        };
        assert!(
            (time - expected).abs() < 0.01 * expected,
            "{scheme:?}: {time}"
        );
        assert!(force > 0.1 && force < 0.102, "{scheme:?}: {force}");
        // It goes with the force, free from the beam.
        let positions = simulation.positions();
        assert_eq!(positions[4], Vector3::zeros());
        let whole = run(&hanging(), scheme, step, time);
        assert!(whole.positions()[5].norm() < 1e-12);
        let fallen = -(positions[5].z + 3.0 * positions[7].z + positions[9].z) / 5.0 - 0.05;
        let free = simulation.time() - time;
        let acceleration = (time + free / 3.0) / MASS;
        let expected = 0.5 * acceleration * free * free;
        assert!(
            (fallen / expected - 1.0).abs() < 0.02,
            "{scheme:?}: {fallen} of {expected}"
        );
    }
}

#[test]
fn what_broke_is_broken_after_a_checkpoint_and_goes_on_bit_for_bit() {
    for scheme in [Scheme::BackwardDifferences, Scheme::ImplicitMidpoint] {
        for (scene, end) in [(parting(), 0.02), (hanging(), 0.12)] {
            let parameters = parameters(scheme, 2e-4);
            let mut whole = Simulation::new(&scene, &parameters).unwrap();
            let mut states = vec![whole.state()];
            while whole.time() < end {
                whole.advance(end).unwrap();
                let is_first = states.len() == 1;
                if is_first && whole.breaks()[0].is_some() {
                    states.push(whole.state());
                }
            }
            assert_eq!(states.len(), 2, "it never broke");
            for state in states {
                let mut resumed = Simulation::new(&scene, &parameters).unwrap();
                resumed.restore(state).unwrap();
                while resumed.time() < end {
                    resumed.advance(end).unwrap();
                }
                assert_eq!(whole.positions(), resumed.positions());
                assert_eq!(whole.breaks(), resumed.breaks());
                assert_eq!(whole.remarks(), resumed.remarks());
            }
        }
    }
}
