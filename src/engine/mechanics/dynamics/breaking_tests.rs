//! Joints that break in motion.

use super::spring_tests::{MASS, STIFFNESS, rod};
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{
    Joint, JointKind, Load, LoadKind, RodNode, Scene, Spring, Strength, TurningStiffness,
};
use crate::mechanics::test_support::{
    advance_to, assert_close_in, at, body, clamp, fixed_steps, hinge, joint, point_force, run,
    spring,
};
use std::f64::consts::PI;

const SPEED: f64 = 0.4;

fn nodes() -> [RodNode; 2] {
    [at(0, 4), at(1, 0)]
}

/// Angular frequency of two such rods joined by a spring, rad/s, and the largest spring force when
/// they separate at [`SPEED`], N.
fn swing() -> (f64, f64) {
    let frequency = (2.0 * STIFFNESS / MASS).sqrt();
    (frequency, STIFFNESS * SPEED / frequency)
}

/// Two collinear rods that move apart. The spring between them is half as strong as the force that
/// would stop them.
fn parting() -> Scene {
    let x = Vector3::x();
    let mut rods = vec![rod("left", -0.15 * x, x), rod("right", 0.05 * x, x)];
    rods[0].velocity = -0.5 * SPEED * x;
    rods[1].velocity = 0.5 * SPEED * x;
    Scene {
        rods,
        springs: vec![Spring {
            strength: Strength::of_force(0.5 * swing().1),
            ..spring("thread", nodes(), STIFFNESS)
        }],
        ..Scene::default()
    }
}

/// A rod that hangs from a held one by a ball joint. A force that grows by 1 N/s pulls it down.
fn hanging() -> Scene {
    let (x, z) = (Vector3::x(), Vector3::z());
    let mut beam = rod("beam", -0.1 * x, x);
    beam.held = true;
    Scene {
        rods: vec![beam, rod("rod", Vector3::zeros(), -z)],
        joints: vec![Joint {
            strength: Strength::of_force(0.1),
            ..joint("hook", nodes(), JointKind::Ball)
        }],
        loads: vec![Load {
            schedule: vec![(0.0, 0.0), (1.0, 1.0)],
            ..point_force(1, 4, -z)
        }],
        ..Scene::default()
    }
}

/// The same rod with a clamped beam and a joint of another kind.
fn hanging_by(kind: JointKind) -> Scene {
    let mut scene = hanging();
    scene.rods[0].held = false;
    scene.rods[0].stiffness.bending = [10.0; 2];
    scene.clamps = vec![clamp(0, 0)];
    scene.joints[0].kind = kind;
    scene
}

/// A clamped rod of two pieces. A force that grows by 1 N/s pushes its end sideways.
fn pushed_aside(kind: JointKind, moment: f64) -> Scene {
    let (x, z) = (Vector3::x(), Vector3::z());
    let mut rods = vec![rod("root", -0.1 * x, x), rod("arm", Vector3::zeros(), x)];
    rods.iter_mut()
        .for_each(|rod| rod.stiffness.bending = [100.0; 2]);
    Scene {
        rods,
        clamps: vec![clamp(0, 0)],
        joints: vec![Joint {
            strength: Strength::of_moment(moment),
            ..joint("weld", nodes(), kind)
        }],
        loads: vec![Load {
            schedule: vec![(0.0, 0.0), (1.0, 1.0)],
            ..point_force(1, 4, z)
        }],
        ..Scene::default()
    }
}

/// Rotation rate of the arm of [`flail`], rad/s, and the time at which it is pushed off its hinge,
/// s.
const SPIN: f64 = 40.0;
const PUSHED: f64 = 0.2;

/// An arm with a body that turns on a hinge at the end of a post until a force along the axis
/// pushes it off.
fn flail() -> Scene {
    let (x, z) = (Vector3::x(), Vector3::z());
    let mut rods = vec![rod("post", -0.1 * z, z), rod("arm", Vector3::zeros(), x)];
    for rod in &mut rods {
        rod.stiffness.bending = [10.0; 2];
        rod.stiffness.twisting = 10.0;
    }
    rods[1].angular_velocity = SPIN * z;
    rods[1].velocity = SPIN * z.cross(&(0.05 * x));
    let centripetal = MASS * SPIN * SPIN * 0.05;
    Scene {
        rods,
        clamps: vec![clamp(0, 0)],
        joints: vec![Joint {
            name: "hinge".into(),
            nodes: nodes(),
            kind: hinge(z),
            // At first twice the centripetal force acts, because the arm oscillates along its
            // length.
            strength: Strength::of_force(3.0 * centripetal),
        }],
        bodies: vec![body("hub", nodes()[1], MASS, Some([2e-6, 3e-6, 4e-6]))],
        loads: vec![Load {
            // The force acts on arm and body alike, so that it does not turn the free arm.
            kind: LoadKind::Gravity {
                acceleration: z * (4.0 * centripetal / (2.0 * MASS)),
            },
            schedule: vec![(PUSHED, 0.0), (PUSHED + 1e-3, 1.0)],
        }],
        ..Scene::default()
    }
}

/// Time and load at which the only joint or spring of a scene broke.
fn only_break(simulation: &Simulation) -> Break {
    let [Some(found)] = simulation.breaks()[..] else {
        panic!("{:?}", simulation.breaks());
    };
    found
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
        let Break { time, force, .. } = only_break(&simulation);
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
fn a_turning_spring_breaks_at_its_moment() {
    let mut scene = pushed_aside(JointKind::Ball, 0.0);
    scene.joints[0].strength = Strength::default();
    scene.springs = vec![Spring {
        turning: Some(TurningStiffness {
            stiffness: 10.0,
            rest_rotation: Vector3::zeros(),
        }),
        strength: Strength::of_moment(2e-3),
        ..spring("coil", nodes(), 0.0)
    }];
    let simulation = run(&scene, Scheme::BackwardDifferences, 2e-5, 0.024);
    let Break { time, moment, .. } = only_break(&simulation);
    assert!((time - 0.02).abs() < 1e-3, "{time}");
    assert!(moment > 2e-3 && moment < 2.02e-3, "{moment}");
    let start = simulation.energies();
    // No moment is left that turns the arm back.
    assert!(start.kinetic > 10.0 * start.bending, "{start:?}");
}

#[test]
fn welds_and_hinges_break_at_the_force_that_holds_the_rod_and_let_it_fall() {
    let expected = 0.1;
    for kind in [JointKind::Rigid, hinge(Vector3::y())] {
        for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
            let scene = hanging_by(kind);
            let simulation = run(&scene, scheme, 2e-4, expected + 0.02);
            let Break { time, force, .. } = only_break(&simulation);
            assert!((time - expected).abs() < 0.01 * expected, "{time}");
            assert!(force > 0.1 && force < 0.102, "{kind:?} {scheme:?}: {force}");
            let positions = simulation.positions();
            assert!(positions[4].norm() < 1e-4, "{}", positions[4]);
            let fallen = -(positions[5].z + 3.0 * positions[7].z + positions[9].z) / 5.0 - 0.05;
            let free = simulation.time() - time;
            let expected = 0.5 * (time + free / 3.0) / MASS * free * free;
            assert_close_in((kind, scheme), fallen, expected, 0.02);
        }
    }
}

#[test]
fn welds_and_hinges_break_at_the_moment_that_bends_the_rod() {
    for kind in [JointKind::Rigid, hinge(Vector3::z())] {
        let scene = pushed_aside(kind, 2e-3);
        let simulation = run(&scene, Scheme::BackwardDifferences, 2e-5, 0.024);
        let Break {
            time,
            force,
            moment,
        } = only_break(&simulation);
        assert!((time - 0.02).abs() < 4e-4, "{kind:?}: {time}");
        assert!(moment > 2e-3 && moment < 2.02e-3, "{kind:?}: {moment}");
        assert!((force / 0.02 - 1.0).abs() < 0.1, "{kind:?}: {force}");
        let remarks = simulation.remarks();
        let is_told = |remark: &String| remark.contains("`weld` broke") && remark.ends_with("N m");
        assert!(remarks.iter().any(is_told), "{remarks:?}");
        // The free end flies off with the impulse of the force; the centre of the arm accelerates
        // by F/m.
        let free = simulation.time() - time;
        let velocities = &simulation.velocities()[5..10];
        let mean = 0.25
            * (0.5 * (velocities[0] + velocities[4]) + velocities[1..4].iter().sum::<Vector3>());
        let expected = (time + 0.5 * free) * free / MASS;
        assert!((mean.z / expected - 1.0).abs() < 0.05, "{mean} {expected}");
    }
}

#[test]
fn a_rod_leaves_its_hinge_as_it_moves_and_turns() {
    const STEP: f64 = 2e-4;
    let scene = flail();
    let parameters = fixed_steps(Scheme::BackwardDifferences, STEP);
    let end = PUSHED + 0.05;
    let mut whole = Simulation::new(&scene, &parameters).unwrap();
    let mut states = Vec::new();
    while whole.time() < end {
        whole.advance(end).unwrap();
        // States after more than a turn: one before and one after breaking.
        let counts = [whole.time() > 0.9 * PUSHED, whole.breaks()[0].is_some()];
        if states.len() < counts.iter().filter(|it| **it).count() {
            states.push(whole.state());
        }
    }
    assert_eq!(states.len(), 2);
    let Break { time, .. } = only_break(&whole);
    assert!(time > PUSHED && time < PUSHED + 1e-3, "{time}");
    let [hub, tip] = [5, 9].map(|node| whole.velocities()[node]);
    let arm = whole.positions()[9] - whole.positions()[5];
    let (turning, turned) = (tip - hub, SPIN * end);
    assert!((turning.xy().norm() / (0.1 * SPIN) - 1.0).abs() < 1e-3);
    let angle = (libm::atan2(arm.y, arm.x) - turned).rem_euclid(2.0 * PI);
    assert!(angle.min(2.0 * PI - angle) < 5e-3, "{angle}");
    // Half of the mass is at the hub; the other half, that of the arm, is centred at its middle.
    let velocity = hub + turning * 0.25;
    let (sine, cosine) = libm::sincos(SPIN * time);
    let expected = Vector3::new(-sine, cosine, 0.0) * (0.025 * SPIN);
    let error = (velocity - expected).xy().norm() / expected.norm();
    // The time of breaking is accurate to one step; the tolerance is the rotation of the arm in
    // one step.
    assert!(error < SPIN * STEP, "{velocity} {expected}");
    for state in states {
        let mut resumed = Simulation::new(&scene, &parameters).unwrap();
        resumed.restore(state).unwrap();
        advance_to(&mut resumed, end);
        assert_eq!(whole.positions(), resumed.positions());
        assert_eq!(whole.breaks(), resumed.breaks());
    }
}

#[test]
fn a_spring_that_bears_the_force_holds() {
    let mut scene = parting();
    scene.springs[0].strength = Strength::of_force(1.01 * swing().1);
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
        let Break { time, force, .. } = only_break(&simulation);
        assert!(
            (time - expected).abs() < 0.01 * expected,
            "{scheme:?}: {time}"
        );
        assert!(force > 0.1 && force < 0.102, "{scheme:?}: {force}");
        // The rod moves with the force, free from the beam.
        let positions = simulation.positions();
        assert_eq!(positions[4], Vector3::zeros());
        let whole = run(&hanging(), scheme, step, time);
        assert!(whole.positions()[5].norm() < 1e-12);
        let fallen = -(positions[5].z + 3.0 * positions[7].z + positions[9].z) / 5.0 - 0.05;
        let free = simulation.time() - time;
        let acceleration = (time + free / 3.0) / MASS;
        let expected = 0.5 * acceleration * free * free;
        assert_close_in(scheme, fallen, expected, 0.02);
    }
}

#[test]
fn broken_joints_stay_broken_after_a_checkpoint_bit_for_bit() {
    for scheme in [Scheme::BackwardDifferences, Scheme::ImplicitMidpoint] {
        let mut scenes = vec![(parting(), 0.02), (hanging(), 0.12)];
        if scheme == Scheme::BackwardDifferences {
            scenes.push((hanging_by(JointKind::Rigid), 0.12));
            scenes.push((hanging_by(hinge(Vector3::y())), 0.12));
        }
        for (scene, end) in scenes {
            let parameters = fixed_steps(scheme, 2e-4);
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
                advance_to(&mut resumed, end);
                assert_eq!(whole.positions(), resumed.positions());
                assert_eq!(whole.breaks(), resumed.breaks());
                assert_eq!(whole.remarks(), resumed.remarks());
            }
        }
    }
}
