//! Balls on rods in a fluid, and rods that spin in a fluid.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::{Body, Clamp, LoadKind, Motion, RodDescription, Scene, Stiffness};
use crate::mechanics::test_support::{assert_close_in, at, clamp, run, steady};
use std::f64::consts::PI;

const BALL: f64 = 5e-3;
const MASS: f64 = 2e-4;
const RADIUS: f64 = 2e-4;
const VISCOSITY: f64 = 1.0;
const STOKESLETS: FluidModel = FluidModel::RegularizedStokeslets {
    viscosity: VISCOSITY,
    regularization: 1.02,
    far_field_error: 0.0,
};

fn rod(edges: usize, length: f64, radius: f64) -> RodDescription {
    let stiffness = Stiffness::circular(1e6, 0.5, radius);
    let nodes = (0..=edges).map(|k| Vector3::z() * (length * k as f64 / edges as f64));
    RodDescription::uniform(
        "rod",
        nodes.collect(),
        stiffness,
        radius,
        1000.0 * PI * radius * radius,
    )
}

/// A ball on the first node of a rod in a fluid, under one load.
fn scene(rod: RodDescription, load: LoadKind) -> Scene {
    Scene {
        rods: vec![rod],
        bodies: vec![Body::uniform_ball(at(0, 0), MASS, BALL)],
        loads: vec![steady(load)],
        fluid: Some(STOKESLETS),
        spin_drag: true,
        ..Scene::default()
    }
}

#[test]
fn a_ball_turns_in_a_fluid_at_the_rate_of_the_moment_on_it() {
    // The ball encloses the rod, which turns with it about its axis and has no drag of its own.
    let moment = 1e-6;
    let load = LoadKind::Moment {
        rod: 0,
        edge: 0,
        moment: Vector3::z() * moment,
    };
    let scene = scene(rod(2, 0.8 * BALL, RADIUS), load);
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        let turned = run(&scene, scheme, 1e-3, 0.1);
        let expected = moment / (8.0 * PI * VISCOSITY * BALL.powi(3));
        let spin = turned.as_start().spins[0];
        assert_close_in(scheme, spin, expected, 1e-4);
    }
}

#[test]
fn a_ball_with_a_tail_sinks_alike_with_all_schemes_and_steps() {
    let load = LoadKind::Gravity {
        acceleration: Vector3::z() * -9.81,
    };
    let scene = scene(rod(6, 0.02, RADIUS), load);
    let speed = |scheme, step| -run(&scene, scheme, step, 0.1).velocities()[0].z;
    let fine = speed(Scheme::ImplicitEuler, 1e-3);
    for (scheme, step) in [
        (Scheme::ImplicitEuler, 0.02),
        (Scheme::BackwardDifferences, 2e-3),
    ] {
        let found = speed(scheme, step);
        assert_close_in((scheme, step), found, fine, 1e-3);
    }
    // The ball with its tail is slower than the ball alone.
    let alone = MASS * 9.81 / (6.0 * PI * VISCOSITY * BALL);
    assert!((0.85..1.0).contains(&(fine / alone)), "{}", fine / alone);
}

#[test]
fn a_rod_that_spins_drags_its_neighbour_around() {
    let (radius, speed) = (1e-3, 10.0);
    let stiff = || {
        let mut rod = rod(20, 0.1, radius);
        // In a soft rod the twist would spread slowly.
        rod.stiffness.twisting *= 1e3;
        rod
    };
    let mut neighbour = stiff();
    for x in &mut neighbour.centreline {
        x.x += 6e-3;
    }
    let scene = Scene {
        rods: vec![stiff(), neighbour],
        clamps: vec![Clamp {
            motion: Motion {
                axis: Some(Vector3::z()),
                angular_velocity: speed,
                ..Motion::default()
            },
            ..clamp(0, 0)
        }],
        fluid: Some(STOKESLETS),
        spin_drag: true,
        ..Scene::default()
    };
    let spun = run(&scene, Scheme::ImplicitEuler, 1e-3, 0.01);
    let moment = spun.reaction_moment(0).z;
    let expected = 4.0 * PI * VISCOSITY * radius * radius * 0.1 * speed;
    assert!((moment / expected - 1.0).abs() < 1e-3, "{moment}");
    // Near a long rod the velocity is ω r²/d. Its mean along a rod of length L is this times
    // (√(L² + d²) − d)/L.
    let mean: Vector3 = spun.velocities()[21..].iter().sum::<Vector3>() / 21.0;
    let (length, distance) = (0.1f64, 6e-3f64);
    let part = ((length * length + distance * distance).sqrt() - distance) / length;
    let beside = speed * radius * radius / distance * part;
    assert!((mean.y / beside - 1.0).abs() < 0.05, "{mean} {beside}");
}
