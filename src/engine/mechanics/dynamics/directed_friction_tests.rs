//! Friction that depends on the direction of sliding relative to a rod, on inclines.

use super::*;
use crate::mechanics::contact::{
    ContactModel, ContactParameters, DirectedFriction, FrictionAt, Geometry,
};
use crate::mechanics::scene::{Plane, RodDescription, Scene};
use crate::mechanics::test_support::{
    SOFT_MODELS, advance_to, assert_close_in, fixed, ground, line, run_with, straight_rod, weight,
};
use crate::mechanics::{SceneError, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

const RADIUS: f64 = 5e-3;
const GRAVITY: f64 = 9.81;
const SLIP_TOLERANCE: f64 = 1e-4;
const OWN: DirectedFriction = DirectedFriction {
    forwards: 0.1,
    backwards: 0.5,
    sideways: 0.3,
};

fn contact(model: ContactModel) -> ContactParameters {
    ContactParameters {
        slip_tolerance: SLIP_TOLERANCE,
        stiffness_factor: match model {
            ContactModel::IncrementalPotential => 1.0,
            _ => 1e5,
        },
        ..crate::mechanics::test_support::contact(model, 5e-5)
    }
}

/// A rod on an incline of the angle `slope` that descends along x; the rod makes the angle `turn`
/// with x (rad).
fn on_incline(model: ContactModel, slope: f64, turn: f64) -> Scene {
    let (sine, cosine) = libm::sincos(turn);
    let half = Vector3::new(cosine, sine, 0.0) * 0.05;
    let middle = Vector3::z() * (RADIUS + 2e-5);
    let (sine, cosine) = libm::sincos(slope);
    Scene {
        rods: vec![RodDescription {
            centreline: line(middle - half, middle + half, 4),
            ..straight_rod(4, 0.1)
        }],
        loads: vec![weight(Vector3::new(sine, 0.0, -cosine) * GRAVITY)],
        planes: vec![Plane {
            directed_friction: Some(OWN),
            ..ground()
        }],
        contact: Some(contact(model)),
        ..Scene::default()
    }
}

/// Velocity of the middle node, m/s.
fn velocity(simulation: &Simulation) -> Vector3 {
    simulation.velocities()[2]
}

#[test]
fn a_rod_slides_down_by_the_coefficient_of_its_direction() {
    let slope = 0.6;
    let (sine, cosine) = libm::sincos(slope);
    for model in SOFT_MODELS {
        for (turn, coefficient) in [
            (0.0, OWN.forwards),
            (PI, OWN.backwards),
            (FRAC_PI_2, OWN.sideways),
            (-FRAC_PI_2, OWN.sideways),
        ] {
            let scene = on_incline(model, slope, turn);
            let mut simulation = run_with(&scene, &fixed(1e-3), 0.1);
            let before = velocity(&simulation);
            advance_to(&mut simulation, 0.3);
            let found = (velocity(&simulation) - before) / 0.2;
            let expected = GRAVITY * (sine - coefficient * cosine);
            println!("{model:?} {turn:.2}: {found:?} {expected}");
            assert_close_in((model, turn), found.x, expected, 1e-5);
            assert!(found.y.abs() < 1e-5 * expected);
        }
    }
}

/// The incline of tan⁻¹ 0.4 is too shallow to slide backwards, and too steep for the other
/// directions.
#[test]
fn a_rod_that_would_slide_forwards_rests_when_it_is_turned_round() {
    let slope = libm::atan(0.4);
    for model in SOFT_MODELS {
        let [forwards, backwards, sideways] = [0.0, PI, FRAC_PI_2].map(|turn| {
            let simulation = run_with(&on_incline(model, slope, turn), &fixed(1e-3), 0.3);
            velocity(&simulation).x
        });
        println!("{model:?}: {forwards} {backwards} {sideways}");
        // The smoothed law balances 0.8 of the limit at this speed.
        let creep = SLIP_TOLERANCE / 7.5 * libm::atanh(0.8);
        assert_close_in(model, backwards, creep, 0.02);
        assert!(forwards > 0.5 && sideways > 0.2);
    }
}

/// A rod that lies askew on an incline is deflected towards the direction in which it slides more
/// easily. While it does not turn, it slides by Hu's law.
#[test]
fn a_rod_that_lies_askew_leaves_the_line_of_steepest_descent() {
    let (slope, turn) = (0.6, 0.5);
    let scene = on_incline(ContactModel::ImplicitContact, slope, turn);
    let simulation = run_with(&scene, &fixed(1e-4), 0.05);
    let (sine, cosine) = libm::sincos(slope);
    let (y, x) = libm::sincos(turn);
    let tangent = Vector3::new(x, y, 0.0);
    // The direction of sliding is constant from rest: a fixed point of u ∥ g sin α + t(û).
    let mut direction = Vector3::x();
    for _ in 0..200 {
        let along = tangent * direction.dot(&tangent);
        let friction = along * OWN.forwards + (direction - along) * OWN.sideways;
        direction = (Vector3::x() * sine - friction * cosine).normalize();
    }
    let found = velocity(&simulation).normalize();
    println!("{found:?} {direction:?}");
    assert!(direction.y > 0.05);
    assert!((found - direction).xy().norm() < 2e-3);
}

#[test]
fn contact_without_directions_is_refused() {
    let scene = on_incline(ContactModel::ImplicitContact, 0.6, 0.0);
    let changes: [fn(&mut ContactParameters); 3] = [
        |contact| contact.model = ContactModel::Complementarity,
        |contact| contact.friction_at = FrictionAt::Surface,
        |contact| contact.geometry = Geometry::Smooth,
    ];
    for change in changes {
        let mut scene = scene.clone();
        change(scene.contact.as_mut().unwrap());
        let refused = Simulation::new(&scene, &fixed(1e-3)).err();
        assert!(matches!(
            refused,
            Some(SimulationError::BadScene(SceneError::Unsuitable(_)))
        ));
    }
}
