//! Rigid contact by complementarity: exact sticking and sliding, agreement with the implicit contact model,
//! balance of forces.

use super::barrier_tests::{BARRIER, DIAMETER, RADIUS, TOLERANCE, crossing, pressed, rod};
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::scene::{RodDescription, Scene};
use crate::mechanics::test_support::{contact, fixed, ground, run_with, weight};

const RIGID: ContactModel = ContactModel::Complementarity;

/// Speed and acceleration of a rod that lies across a slope of `angle`, after sliding down for
/// `time` seconds.
fn slide(angle: f64, friction: f64, time: f64) -> (f64, f64) {
    let speed = slide_on(angle, friction, time, Vector3::zeros());
    (speed, speed / time)
}

/// Speed of this rod along the slope after `time` seconds, if it starts with `velocity`.
fn slide_on(angle: f64, friction: f64, time: f64, velocity: Vector3) -> f64 {
    let gravity = 9.81;
    let lying = RodDescription {
        velocity,
        ..rod("rod", Vector3::z() * RADIUS, Vector3::y())
    };
    let scene = Scene {
        rods: vec![lying],
        planes: vec![ground()],
        loads: vec![weight(
            Vector3::new(angle.sin(), 0.0, -angle.cos()) * gravity,
        )],
        contact: Some(ContactParameters {
            friction,
            ..contact(RIGID, TOLERANCE)
        }),
        ..Scene::default()
    };
    let simulation = run_with(&scene, &fixed(1e-3), time);
    let lowest = simulation.positions().iter().map(|x| x.z);
    assert!(lowest.fold(f64::INFINITY, f64::min) > RADIUS - 1e-3 * TOLERANCE);
    simulation.velocities()[5].x
}

#[test]
fn a_rod_on_an_incline_sticks_and_slides_exactly_by_coulomb() {
    for friction in [0.2, 0.5, 1.0_f64] {
        let limit = friction.atan();
        let (speed, _) = slide(limit - 1e-3, friction, 0.1);
        println!("below tan α = {friction}: {speed:.1e} m/s");
        // The rod does not creep; with the smoothed law it creeps at ln((1+f)/(1−f)) ν/15.
        assert!(speed.abs() < 1e-9);
        for angle in [limit + 1e-3, limit + 0.2] {
            let (_, acceleration) = slide(angle, friction, 0.1);
            let expected = 9.81 * (angle.sin() - friction * angle.cos());
            println!("{friction}, {angle:.4}: {acceleration:.6e} of {expected:.6e} m/s²");
            // Newton's method leaves a residual of a millionth of the weight.
            assert!((acceleration - expected).abs() < 1e-6 * 9.81);
        }
    }
}

/// Found when friction started from the force of the previous step: a rod that had slid and stuck
/// kept moving at the speed that its last correction would have removed, 4e-10 m/s.
#[test]
fn a_rod_that_comes_to_stick_does_not_creep_on() {
    for down in [1e-3, 0.02, 0.1] {
        let velocity = Vector3::new(down, 0.3 * down, -0.1 * down);
        let speed = slide_on(0.35, 0.5, 0.2, velocity);
        println!("after {down} m/s: {speed:.1e} m/s");
        assert!(speed.abs() < 1e-14);
    }
}

#[test]
fn rigid_contact_agrees_with_a_barrier_on_pressed_rods() {
    for friction in [0.0, 0.3] {
        let (rigid, barrier) = (pressed(RIGID, friction), pressed(BARRIER, friction));
        let nodes = rigid.positions().iter().zip(barrier.positions());
        let apart = nodes.fold(0.0, |most, (a, b)| f64::max(most, (a - b).norm()));
        let total =
            |simulation: &Simulation| -> Vector3 { simulation.contact_forces()[11..].iter().sum() };
        let (of_rigid, of_barrier) = (total(&rigid), total(&barrier));
        let difference = (of_rigid - of_barrier).norm() / of_barrier.norm();
        println!("friction {friction}: {apart:.2e} m, forces {difference:.1e} of {of_barrier:?}");
        assert!((rigid.minimum_distance() / DIAMETER - 1.0).abs() < 1e-5);
        assert!(apart < TOLERANCE);
        assert!(difference < TOLERANCE / 3e-3);
    }
}

#[test]
fn rigid_contacts_conserve_momentum_and_take_energy() {
    let mut scene = crossing(RIGID, 0.002, 0.3);
    scene.clamps.clear();
    scene.rods[1].velocity = Vector3::new(0.3, 0.1, -1.0);
    let mut simulation = Simulation::new(&scene, &fixed(5e-4)).unwrap();
    let momentum = |simulation: &Simulation| simulation.momenta()[0];
    let energy = |simulation: &Simulation| {
        let e = simulation.energies();
        e.kinetic + e.elastic()
    };
    let (before, mut last) = (momentum(&simulation), energy(&simulation));
    let mut touched = 0;
    for _ in 0..60 {
        touched += simulation.advance(1.0).unwrap().contacts;
        let forces: Vector3 = simulation.contact_forces().iter().sum();
        assert!(forces.norm() < 1e-10);
        let now = energy(&simulation);
        assert!(now <= last * (1.0 + 1e-9), "{now:e} after {last:e}");
        last = now;
        assert!(simulation.minimum_distance() > (1.0 - 1e-4) * DIAMETER);
    }
    assert!(touched > 0);
    assert!((momentum(&simulation) - before).norm() < 1e-6 * before.norm());
}

#[test]
fn rigid_contact_is_for_implicit_euler() {
    let scene = crossing(RIGID, 0.002, 0.0);
    let midpoint = IntegrationParameters {
        scheme: Scheme::ImplicitMidpoint,
        ..fixed(1e-3)
    };
    assert!(Simulation::new(&scene, &midpoint).is_err());
    let mut simulation = Simulation::new(&scene, &fixed(1e-3)).unwrap();
    assert!(simulation.find_equilibrium().is_err());
}
