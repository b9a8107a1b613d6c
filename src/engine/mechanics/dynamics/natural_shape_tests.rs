//! Equilibria of rods with designed natural shapes.

use super::{IntegrationParameters, Simulation};
use crate::mechanics::Vector3;
use crate::mechanics::scene::{
    Clamp, Load, LoadKind, Motion, NaturalShape, RodDescription, Scene, Stiffness,
};
use crate::mechanics::statics::{DesignError, Designed, natural_strains};

const EDGES: usize = 60;
const LENGTH: f64 = 0.3;
const GRAVITY: f64 = 9.81;

/// A rod along a curve over 0 to 1, clamped at some nodes, under gravity along −z.
fn scene(curve: impl Fn(f64) -> Vector3, clamps: &[(usize, bool, bool)]) -> Scene {
    let nodes = (0..=EDGES)
        .map(|k| curve(k as f64 / EDGES as f64))
        .collect();
    let stiffness = Stiffness {
        stretching: 200.0,
        bending: [4e-5, 9e-5],
        twisting: 5e-5,
    };
    let clamp = |&(node, holds_position, holds_frame): &(usize, bool, bool)| Clamp {
        rod: 0,
        node,
        holds_position,
        holds_frame,
        motion: Motion::default(),
    };
    Scene {
        rods: vec![RodDescription::uniform("rod", nodes, stiffness, 1e-3, 3e-3)],
        clamps: clamps.iter().map(clamp).collect(),
        loads: vec![Load {
            kind: LoadKind::Gravity {
                acceleration: Vector3::new(0.0, 0.0, -GRAVITY),
            },
            schedule: Vec::new(),
        }],
        ..Scene::default()
    }
}

fn line(part: f64) -> Vector3 {
    Vector3::new(LENGTH * part, 0.0, 0.0)
}

fn helix(part: f64) -> Vector3 {
    let (sin, cos) = libm::sincos(5.0 * part);
    Vector3::new(0.04 * cos, 0.04 * sin, -0.2 * part)
}

/// Finds the natural strains and the equilibrium nearby. Returns its largest distance from the
/// curve, relative to the length, and the number of directions in which it is unstable.
fn distance(mut scene: Scene) -> (Designed, f64, usize) {
    let designed = natural_strains(&scene, 0).unwrap();
    scene.rods[0].natural_shape = NaturalShape::Strains(designed.natural.clone());
    let parameters = IntegrationParameters {
        force_tolerance: 1e-11,
        ..IntegrationParameters::default()
    };
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    let unstable = simulation.find_nearby_equilibrium().unwrap();
    let pairs = simulation.positions().iter().zip(&scene.rods[0].centreline);
    let largest = pairs
        .map(|(one, other)| (one - other).norm())
        .fold(0.0, f64::max);
    (designed, largest / LENGTH, unstable)
}

#[test]
fn a_beam_that_is_level_under_its_weight_has_the_curvature_of_the_closed_form() {
    let (designed, distance, unstable) = distance(scene(line, &[(0, true, true)]));
    assert!(distance < 1e-10 && unstable == 0, "{distance:e}");
    let weight = 3e-3 * GRAVITY;
    for (node, curvature) in designed.natural.curvature.iter().enumerate().skip(1) {
        // With weights lumped at nodes, the moment of the weights of the nodes beyond.
        let beyond = LENGTH * (1.0 - node as f64 / EDGES as f64);
        let stiffness = [4e-5, 9e-5];
        let moment = libm::hypot(stiffness[0] * curvature[0], stiffness[1] * curvature[1]);
        let expected = 0.5 * weight * beyond * beyond;
        assert!(
            (moment - expected).abs() < 1e-10 * weight * LENGTH * LENGTH,
            "{node}"
        );
        assert!(designed.natural.twist[node].abs() < 1e-9);
    }
    assert!(designed.largest_strain < 1e-9);
}

#[test]
fn curves_in_space_are_equilibria_with_one_or_two_clamps() {
    let ends: [&[(usize, bool, bool)]; 5] = [
        &[(0, true, true)],
        &[(EDGES, true, true)],
        &[(0, true, true), (EDGES, true, true)],
        &[(0, true, true), (EDGES, true, false)],
        &[(0, true, false), (EDGES, true, true)],
    ];
    for clamps in ends {
        let (designed, distance, unstable) = distance(scene(helix, clamps));
        println!(
            "{clamps:?}: distance {distance:.1e} L, unstable {unstable}, residual {:.1e} of {:.2e} N, strain {:.1e}",
            designed.residual, designed.force, designed.largest_strain
        );
        assert!(designed.residual < 1e-10 * designed.force, "{clamps:?}");
        assert!(distance < 1e-10, "{clamps:?}: {distance:e}");
        // Clamped at its lower end only, the rod stands upright and is too long to be stable.
        assert_eq!(unstable > 0, clamps == [(EDGES, true, true)]);
    }
}

#[test]
fn a_free_rod_and_an_inner_clamp_are_refused() {
    let free = natural_strains(&scene(helix, &[]), 0).unwrap_err();
    assert!(matches!(free, DesignError::Unbalanced { .. }), "{free}");
    let hinged = natural_strains(&scene(line, &[(0, true, false)]), 0).unwrap_err();
    assert!(matches!(hinged, DesignError::Unbalanced { .. }), "{hinged}");
    let inner = natural_strains(&scene(helix, &[(3, true, true)]), 0).unwrap_err();
    assert!(inner.to_string().contains("at their ends only"));
}
