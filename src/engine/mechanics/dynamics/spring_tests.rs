//! Rods joined by springs, in motion and in contact.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::ContactModel;
use crate::mechanics::scene::{RodDescription, Scene, Spring, TurningStiffness};
use crate::mechanics::test_support::{
    MODELS, assert_close_in, at, contact, drag, fixed_steps, gravity, ground, joint, run, section,
    spring, sprung_hinge,
};
use std::f64::consts::TAU;

pub(super) const MASS: f64 = 1e-3;
pub(super) const STIFFNESS: f64 = 2.0;

/// A rod of 1 g and four edges, 10 cm long.
pub(super) fn rod(name: &str, start: Vector3, along: Vector3) -> RodDescription {
    let stiffness = section(1e4, [1e-2; 2], 1e-2);
    let node = |k: i32| start + along * (0.025 * f64::from(k));
    RodDescription::uniform(name, (0..=4).map(node).collect(), stiffness, 2e-3, 1e-2)
}

fn tie(nodes: [[usize; 2]; 2], rest_length: Option<f64>) -> Spring {
    Spring {
        rest_length,
        ..spring("spring", nodes.map(|[rod, node]| at(rod, node)), STIFFNESS)
    }
}

/// Two collinear rods, 2 cm apart, with a spring 5 mm longer than its rest length.
fn pair() -> Scene {
    let x = Vector3::x();
    Scene {
        rods: vec![rod("left", -0.11 * x, x), rod("right", 0.01 * x, x)],
        springs: vec![tie([[0, 4], [1, 0]], Some(0.015))],
        ..Scene::default()
    }
}

/// Largest deviation of the gap between the rods of [`pair`] from the exact cosine within two
/// periods, m.
fn error_of_gap(scheme: Scheme, step: f64) -> f64 {
    let frequency = (2.0 * STIFFNESS / MASS).sqrt();
    let end = 2.0 * TAU / frequency;
    let mut simulation = Simulation::new(&pair(), &fixed_steps(scheme, step)).unwrap();
    let mut worst = 0.0_f64;
    while simulation.time() < end {
        simulation.advance(end).unwrap();
        let gap = simulation.positions()[5].x - simulation.positions()[4].x;
        let exact = 0.015 + 0.005 * libm::cos(frequency * simulation.time());
        worst = worst.max((gap - exact).abs());
        let [momentum, _] = simulation.momenta();
        assert!(momentum.norm() < 1e-12, "{momentum}");
    }
    worst
}

#[test]
fn two_rods_swing_against_each_other_as_in_theory() {
    let period = TAU / (2.0 * STIFFNESS / MASS).sqrt();
    for (scheme, bound) in [
        (Scheme::ImplicitMidpoint, 2e-3),
        (Scheme::BackwardDifferences, 2e-3),
        (Scheme::ImplicitEuler, 0.1),
    ] {
        let error = error_of_gap(scheme, period / 1000.0) / 0.005;
        assert!(error < bound, "{scheme:?}: {error}");
    }
    let [whole, half] =
        [500.0, 1000.0].map(|steps| error_of_gap(Scheme::ImplicitEuler, period / steps));
    assert!((1.8..2.2).contains(&(whole / half)), "{whole} {half}");
}

#[test]
fn the_energy_of_springs_is_in_the_balance() {
    let mut simulation =
        Simulation::new(&pair(), &fixed_steps(Scheme::ImplicitMidpoint, 1e-4)).unwrap();
    let start = simulation.energies();
    assert!((start.stretching / (0.5 * STIFFNESS * 25e-6) - 1.0).abs() < 1e-9);
    let mut kinetic = 0.0_f64;
    while simulation.time() < 0.2 {
        simulation.advance(0.2).unwrap();
        let energies = simulation.energies();
        kinetic = kinetic.max(energies.kinetic);
        let change = (energies.total() / start.total() - 1.0).abs();
        assert!(change < 1e-4, "{change}");
    }
    assert!(kinetic > 0.99 * start.total());
}

#[test]
fn a_sprung_hinge_keeps_angular_momentum_and_its_energy() {
    let (x, y) = (Vector3::x(), Vector3::y());
    let origin = Vector3::zeros();
    let stiffness = 0.02;
    // The rods hardly bend, so that their share of the energy is negligible.
    let stiff = |mut rod: RodDescription| {
        rod.stiffness.bending = [1.0; 2];
        rod
    };
    let scene = Scene {
        rods: vec![stiff(rod("one", origin, x)), stiff(rod("other", origin, y))],
        joints: vec![joint(
            "hinge",
            [at(0, 0), at(1, 0)],
            sprung_hinge(Vector3::z(), stiffness, 0.3),
        )],
        ..Scene::default()
    };
    let parameters = fixed_steps(Scheme::BackwardDifferences, 5e-5);
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    let start = simulation.energies();
    assert!((start.bending / (0.5 * stiffness * 0.09) - 1.0).abs() < 1e-9);
    let angle = |simulation: &Simulation| {
        let positions = simulation.positions();
        let [one, other] = [4, 9].map(|end| positions[end] - positions[0]);
        libm::atan2(one.cross(&other).z, one.dot(&other)) - 0.25 * TAU
    };
    let mut farthest = 0.0_f64;
    while simulation.time() < 0.05 {
        simulation.advance(0.05).unwrap();
        farthest = farthest.max(angle(&simulation));
        let [momentum, angular] = simulation.momenta();
        assert!(momentum.norm() < 1e-10, "{momentum}");
        assert!(angular.norm() < 1e-10, "{angular}");
        let change = (simulation.energies().total() / start.total() - 1.0).abs();
        assert!(change < 1e-2, "{change}");
    }
    // The hinge swings through its rest angle, where the moment vanishes, to the other side.
    assert!((farthest - 0.6).abs() < 0.02, "{farthest}");
}

#[test]
fn two_rods_that_a_spring_turns_keep_momenta_and_energy() {
    let (x, z) = (Vector3::x(), Vector3::z());
    let (stiffness, inertia) = (0.02, 1e-7);
    let stiff = |mut rod: RodDescription| {
        rod.stiffness.bending = [1.0; 2];
        rod.stiffness.twisting = 1.0;
        rod.rotational_inertia_per_length = inertia;
        rod
    };
    for (rest_rotation, spins) in [
        (Vector3::new(0.0, 0.0, 0.9), false),
        (Vector3::new(0.5, -0.8, 0.4), true),
    ] {
        // The spring acts neither at the ends of the rods nor at a common point.
        let scene = Scene {
            rods: vec![
                stiff(rod("one", Vector3::zeros(), x)),
                stiff(rod("other", 0.02 * z, Vector3::new(0.6, 0.8, 0.0))),
            ],
            springs: vec![Spring {
                stiffness: 0.0,
                turning: Some(TurningStiffness {
                    stiffness,
                    rest_rotation,
                }),
                ..tie([[0, 1], [1, 4]], None)
            }],
            ..Scene::default()
        };
        let parameters = fixed_steps(Scheme::BackwardDifferences, 5e-5);
        let mut simulation = Simulation::new(&scene, &parameters).unwrap();
        let start = simulation.energies().total();
        let energy = 0.5 * stiffness * rest_rotation.norm_squared();
        assert!((start / energy - 1.0).abs() < 1e-9);
        // The momenta are those of the nodes. Rods of 10 cm also have angular momentum by spinning
        // about themselves, at most `spin` if this takes all the energy. Rods rotated about an
        // axis perpendicular to both do not spin.
        let spin = (2.0 * 0.1 * inertia * energy).sqrt();
        let bound = if spins { spin } else { 1e-10 };
        let mut kinetic = 0.0_f64;
        while simulation.time() < 0.05 {
            simulation.advance(0.05).unwrap();
            let [momentum, angular] = simulation.momenta();
            assert!(momentum.norm() < 1e-10, "{momentum}");
            assert!(angular.norm() < bound, "{angular}");
            let energies = simulation.energies();
            kinetic = kinetic.max(energies.kinetic);
            let change = (energies.total() / start - 1.0).abs();
            assert!(change < 1e-2, "{change}");
        }
        assert!(kinetic > 0.9 * energy, "{kinetic} of {energy}");
    }
}

/// A rod on the ground under its weight; two springs to a beam above carry half of it.
#[test]
fn springs_carry_what_the_ground_does_not() {
    let (radius, acceleration) = (2e-3, 9.81);
    let (x, z) = (Vector3::x(), Vector3::z());
    let weight = MASS * acceleration;
    let length = 0.25 * weight / STIFFNESS;
    let mut beam = rod("beam", z * 0.05, x);
    beam.held = true;
    let rest_length = Some(0.05 - radius - length);
    for model in MODELS {
        let scene = Scene {
            rods: vec![rod("rod", z * radius, x), beam.clone()],
            springs: vec![
                tie([[0, 0], [1, 0]], rest_length),
                tie([[1, 4], [0, 4]], rest_length),
            ],
            loads: vec![gravity(acceleration), drag(Some(0), 0.5, 0.0)],
            planes: vec![ground()],
            contact: Some(contact(model, 1e-5)),
            ..Scene::default()
        };
        // With a barrier, bodies must not touch at the start.
        let scene = if model == ContactModel::IncrementalPotential {
            let mut raised = scene;
            let nodes = raised.rods[0].centreline.iter_mut();
            nodes.for_each(|node| node.z += 5e-6);
            raised
        } else {
            scene
        };
        let simulation = run(&scene, Scheme::ImplicitEuler, 1e-3, 0.5);
        let touches = simulation.plane_contacts();
        let touches = touches.iter();
        let pressed: f64 = touches.map(|touch| touch.force[2]).sum();
        let positions = simulation.positions();
        let pulls = [0, 4].map(|node| 0.05 - positions[node].z - (0.05 - radius - length));
        let expected = weight - STIFFNESS * pulls.iter().sum::<f64>();
        assert!((expected / weight - 0.5).abs() < 0.02, "{expected}");
        assert_close_in(model, pressed, expected, 1e-3);
    }
}
