//! The order in time of each scheme: how the error at a given time decreases with the step.

use super::super::*;
use crate::mechanics::Vector3;
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::Scene;
use crate::mechanics::test_support::{
    clamp, fixed_steps, gravity, run_with, section, straight_rod,
};

/// A clamped rod of three soft edges that falls from the horizontal. All steps resolve its fastest
/// mode of 160 rad/s.
fn soft_cantilever() -> Scene {
    let mut rod = straight_rod(3, 0.3);
    rod.stiffness = section(5.0, [1e-3, 2e-3], 1e-3);
    rod.angular_velocity = Vector3::new(0.0, 1.0, 2.0);
    Scene {
        rods: vec![rod],
        clamps: vec![clamp(0, 0)],
        loads: vec![gravity(9.81)],
        ..Scene::default()
    }
}

/// A light cantilever that sinks in a viscous fluid while its clamp turns steadily.
fn cantilever_in_honey() -> Scene {
    let mut rod = straight_rod(10, 1.0);
    rod.mass_per_length *= 1e-3;
    rod.rotational_inertia_per_length *= 1e-3;
    let mut turning = clamp(0, 0);
    turning.motion.angular_velocity = 2.0;
    Scene {
        rods: vec![rod],
        clamps: vec![turning],
        loads: vec![gravity(9.81e3)],
        fluid: Some(FluidModel::Resistive { viscosity: 10.0 }),
        ..Scene::default()
    }
}

/// Positions of all nodes at `end` (s).
fn positions(scene: &Scene, scheme: Scheme, step: f64, end: f64) -> Vec<Vector3> {
    let parameters = IntegrationParameters {
        force_tolerance: 1e-11,
        displacement_tolerance: 1e-9,
        ..fixed_steps(scheme, step)
    };
    let simulation = run_with(scene, &parameters, end);
    simulation.positions().to_vec()
}

/// Orders of convergence from two successive halvings of the step.
fn orders(scene: &Scene, scheme: Scheme, step: f64, end: f64, exact: &[Vector3]) -> [f64; 2] {
    let errors = [1.0, 0.5, 0.25].map(|part| {
        let found = positions(scene, scheme, part * step, end);
        let apart = found.iter().zip(exact).map(|(a, b)| (a - b).norm());
        apart.fold(0.0, f64::max)
    });
    println!("{scheme:?}: errors {errors:?} m");
    [
        (errors[0] / errors[1]).log2(),
        (errors[1] / errors[2]).log2(),
    ]
}

#[test]
fn euler_is_of_first_order_and_the_others_of_second_where_inertia_rules() {
    let (scene, end) = (soft_cantilever(), 0.1);
    let exact = positions(&scene, Scheme::ImplicitMidpoint, 1e-5, end);
    for (scheme, step, expected) in [
        (Scheme::ImplicitEuler, 4e-4, 1.0),
        (Scheme::ImplicitMidpoint, 2e-3, 2.0),
        (Scheme::BackwardDifferences, 2e-3, 2.0),
    ] {
        for order in orders(&scene, scheme, step, end, &exact) {
            assert!((order - expected).abs() < 0.2, "{scheme:?}: {order}");
        }
    }
}

#[test]
fn backward_differences_are_of_third_order_where_drag_rules() {
    let (scene, end) = (cantilever_in_honey(), 1.0);
    let exact = positions(&scene, Scheme::BackwardDifferences, 1.25e-3, end);
    for order in orders(&scene, Scheme::BackwardDifferences, 40e-3, end, &exact) {
        assert!((order - 3.0).abs() < 0.4, "{order}");
    }
}
