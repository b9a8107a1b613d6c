//! Rods that yield.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{
    Clamp, Load, Motion, RodDescription, Scene, Stiffness, YieldingMaterial,
};
use crate::mechanics::system::System;
use crate::mechanics::test_support::{
    advance_to, assert_close, at_rest, clamp, drag, farthest, fixed, moment_on, resumed, run,
    run_with, section, straight_rod,
};
use std::f64::consts::PI;

const LENGTH: f64 = 0.1;
const EDGES: usize = 20;
const WIDTH: f64 = 4e-3;
const THICKNESS: f64 = 1e-3;
const RADIUS: f64 = 0.5e-3;
/// A yield strain of 0.15 %.
const MATERIAL: YieldingMaterial = YieldingMaterial {
    youngs_modulus: 1e9,
    poissons_ratio: 0.5,
    yield_stress: 1.5e6,
    tangent_modulus: 0.0,
};

/// A strip along x whose thickness is along y: the first director is along y, so that its sides are (thickness, width).
fn strip() -> RodDescription {
    let young = MATERIAL.youngs_modulus;
    let inertia = |across: f64, along: f64| along * across * across * across / 12.0;
    RodDescription {
        stiffness: section(
            young * WIDTH * THICKNESS,
            [
                young * inertia(WIDTH, THICKNESS),
                young * inertia(THICKNESS, WIDTH),
            ],
            1e-4,
        ),
        mass_per_length: 4e-3,
        yielding: Some(MATERIAL.rectangle(THICKNESS, WIDTH)),
        ..straight_rod(EDGES, LENGTH)
    }
}

fn wire() -> RodDescription {
    RodDescription {
        stiffness: Stiffness::circular(MATERIAL.youngs_modulus, 0.5, RADIUS),
        radius: RADIUS,
        mass_per_length: 1e-3,
        rotational_inertia_per_length: 0.5e-3 * RADIUS * RADIUS,
        yielding: Some(MATERIAL.round([RADIUS, 0.0])),
        ..straight_rod(EDGES, LENGTH)
    }
}

/// A cantilever that a moment on its last edge loads slowly, and then unloads.
fn loaded(rod: RodDescription, moment: Vector3) -> Scene {
    let schedule = vec![(0.0, 0.0), (2.0, 1.0), (4.0, 1.0), (6.0, 0.0)];
    Scene {
        rods: vec![rod],
        clamps: vec![clamp(0, 0)],
        loads: vec![
            Load {
                schedule,
                ..moment_on(0, EDGES - 1, moment)
            },
            drag(None, 0.4, 1e-6),
        ],
        ..Scene::default()
    }
}

/// Curvature and twist of the node in the middle, rad/m.
fn middle(simulation: &Simulation) -> [f64; 2] {
    let of_node = simulation.resultants()[EDGES / 2].expect("two edges");
    [of_node.curvature, of_node.twist]
}

/// M = M_y (3 − (κ_y/κ)²)/2, so that κ = κ_y/√(3 − 2M/M_y), and it springs back by M/EI.
#[test]
fn a_strip_springs_back_by_the_elastic_part_of_its_curvature() {
    let limit = MATERIAL.yield_stress / MATERIAL.youngs_modulus / (0.5 * THICKNESS);
    let stiffness = MATERIAL.youngs_modulus * WIDTH * THICKNESS.powi(3) / 12.0;
    for (factor, hardening) in [(1.2, 0.0), (1.3, 0.0), (1.6, 0.25)] {
        // With hardening, M = E_t I κ beside the perfectly plastic part.
        let plastic = 1.0 - hardening;
        let moment = |over: f64| hardening * over + plastic * 0.5 * (3.0 - over.powi(-2));
        let (mut low, mut high) = (1.0, 50.0);
        while high - low > 1e-12 * high {
            let middle = 0.5 * (low + high);
            let side = if moment(middle) < factor {
                &mut low
            } else {
                &mut high
            };
            *side = middle;
        }
        let mut rod = strip();
        let material = YieldingMaterial {
            tangent_modulus: hardening * MATERIAL.youngs_modulus,
            ..MATERIAL
        };
        rod.yielding = Some(material.rectangle(THICKNESS, WIDTH));
        let scene = loaded(rod, Vector3::z() * (factor * stiffness * limit));
        let mut simulation = run_with(&scene, &fixed(0.02), 4.0);
        assert_close(middle(&simulation)[0], low * limit, 5e-3);
        advance_to(&mut simulation, 9.0);
        assert_close(middle(&simulation)[0], (low - factor) * limit, 0.01);
    }
}

/// The equilibrium of a rod that is loaded in one go is that of the slow motion.
#[test]
fn a_loaded_strip_has_the_curvature_of_the_closed_form_in_equilibrium() {
    let limit = MATERIAL.yield_stress / MATERIAL.youngs_modulus / (0.5 * THICKNESS);
    let stiffness = MATERIAL.youngs_modulus * WIDTH * THICKNESS.powi(3) / 12.0;
    let factor: f64 = 1.3;
    let scene = Scene {
        loads: vec![moment_on(
            0,
            EDGES - 1,
            Vector3::z() * (factor * stiffness * limit),
        )],
        ..loaded(strip(), Vector3::zeros())
    };
    let expected = limit / (3.0 - 2.0 * factor).sqrt();
    assert_close(middle(&at_rest(&scene))[0], expected, 5e-3);
}

/// T = T_y (4 − (τ_y/τ)³)/3.
#[test]
fn a_wire_keeps_the_plastic_part_of_its_twist() {
    let shear_modulus = MATERIAL.youngs_modulus / 3.0;
    let stiffness = shear_modulus * 0.5 * PI * RADIUS.powi(4);
    let limit = MATERIAL.yield_stress / 3.0_f64.sqrt() / (shear_modulus * RADIUS);
    let factor: f64 = 1.2;
    let over = libm::pow(4.0 - 3.0 * factor, -1.0 / 3.0);
    let scene = loaded(wire(), Vector3::x() * (factor * stiffness * limit));
    let mut simulation = run_with(&scene, &fixed(0.02), 4.0);
    assert_close(middle(&simulation)[1].abs(), over * limit, 5e-3);
    advance_to(&mut simulation, 9.0);
    assert_close(middle(&simulation)[1].abs(), (over - factor) * limit, 0.01);
}

#[test]
fn a_wire_below_its_yield_moment_is_elastic() {
    let stiffness = wire().stiffness.bending[0];
    let limit = MATERIAL.yield_stress / MATERIAL.youngs_modulus / RADIUS;
    let scene = loaded(wire(), Vector3::z() * (0.99 * stiffness * limit));
    let mut elastic = scene.clone();
    elastic.rods[0].yielding = None;
    let [yielding, elastic] =
        [scene, elastic].map(|scene| run(&scene, Scheme::ImplicitEuler, 0.05, 3.0));
    assert!(farthest(yielding.positions(), elastic.positions()) < 1e-12 * LENGTH);
}

/// The wire is bent by a moment in an oblique direction: a round section has no preferred one.
#[test]
fn round_wires_bend_alike_in_every_direction() {
    let moment = 1.4 * wire().stiffness.bending[0] * MATERIAL.yield_stress
        / MATERIAL.youngs_modulus
        / RADIUS;
    let bent = |angle: f64| {
        let axis = Vector3::new(0.0, angle.sin(), angle.cos());
        let scene = loaded(wire(), axis * moment);
        middle(&run_with(&scene, &fixed(0.05), 7.0))[0]
    };
    let straight = bent(0.0);
    assert!(straight > 0.1, "{straight}");
    assert_close(bent(0.7), straight, 1e-6);
}

/// A cantilever whose tip is moved sideways and half of the way back; it bends without being stretched.
fn pushed(rod: RodDescription) -> Scene {
    let translation = vec![
        (0.0, Vector3::zeros()),
        (1.0, Vector3::new(-0.012, 0.035, 0.0)),
        (2.0, Vector3::new(-0.006, 0.015, 0.0)),
    ];
    let tip = Clamp {
        holds_frame: false,
        motion: Motion {
            translation,
            ..Motion::default()
        },
        ..clamp(0, EDGES)
    };
    Scene {
        rods: vec![rod],
        clamps: vec![clamp(0, 0), tip],
        ..Scene::default()
    }
}

#[test]
fn work_becomes_energy_and_plastic_loss() {
    let balance = |step: f64| {
        let mut simulation = Simulation::new(&pushed(wire()), &fixed(step)).unwrap();
        let energy = |simulation: &Simulation| {
            let energies = simulation.energies();
            energies.kinetic + energies.stretching + energies.bending + energies.twisting
        };
        let (before, mut sum) = (energy(&simulation), Exchange::default());
        while simulation.time() < 2.0 {
            sum += simulation.advance(2.0).unwrap().exchange;
        }
        let gain = energy(&simulation) - before;
        assert!(sum.drag_loss > 0.3 * sum.clamp_work, "{sum:?}");
        (sum.clamp_work - gain - sum.drag_loss) / sum.clamp_work
    };
    let [coarse, fine] = [0.01, 0.005].map(balance);
    assert!(
        fine.abs() < 0.02 && fine.abs() < 0.7 * coarse.abs(),
        "{coarse} {fine}"
    );
}

#[test]
fn an_interrupted_run_continues_with_the_same_plastic_strains() {
    let scene = pushed(wire());
    let parameters = fixed(0.02);
    let mut whole = run_with(&scene, &parameters, 0.8);
    let mut second = resumed(&scene, &parameters, &whole);
    for simulation in [&mut whole, &mut second] {
        advance_to(simulation, 1.6);
    }
    assert_eq!(whole.positions(), second.positions());
}

/// The Jacobian of yielding rods against differences of the residual, and the residual against
/// differences of the incremental potential; rings and clamps on either side.
#[test]
fn forces_and_jacobian_are_derivatives_of_the_incremental_potential() {
    let ring = |k: usize| {
        let angle = 2.0 * PI * k as f64 / 9.0;
        Vector3::new(
            libm::cos(angle),
            libm::sin(angle),
            0.1 * libm::sin(2.0 * angle),
        ) * 0.03
    };
    let closed = RodDescription {
        closed: true,
        centreline: (0..9).map(ring).collect(),
        ..wire()
    };
    for (rod, closes) in [(strip(), false), (wire(), false), (closed, true)] {
        let scene = Scene {
            clamps: match closes {
                true => Vec::new(),
                false => vec![clamp(0, 0), clamp(0, EDGES)],
            },
            rods: vec![rod],
            ..Scene::default()
        };
        let mut system = System::new(&scene).unwrap();
        let held = system.assembly.held.clone();
        let free: Vec<_> = (0..held.len()).filter(|&k| !held[k]).collect();
        let placed = system.assembly.unknowns.clone();
        let moved = |seed: f64| {
            let mut unknowns = placed.clone();
            for &k in &free {
                let size = if k % 4 == 3 { 0.05 } else { 3e-5 };
                unknowns[k] += size * libm::sin(7.3 * k as f64 + seed);
            }
            unknowns
        };
        system.evaluate(&moved(1.0), None);
        assert!(system.plastic_loss() > 0.0);
        system.accept();
        assert_eq!(system.plastic_loss(), 0.0);
        let unknowns = moved(2.0);
        system.linearize(&unknowns, None);
        assert!(system.plastic_loss() > 0.0);
        let (residual, jacobian) = (system.residual.clone(), system.dense_matrix());
        let largest = residual
            .iter()
            .fold(0.0_f64, |most, own| most.max(own.abs()));
        assert!((&jacobian - jacobian.transpose()).amax() < 1e-12 * jacobian.amax());
        for &column in &free {
            let shift = if column % 4 == 3 { 1e-7 } else { 1e-10 };
            let [ahead, behind] = [shift, -shift].map(|shift| {
                let mut shifted = unknowns.clone();
                shifted[column] += shift;
                system.evaluate(&shifted, None);
                (system.elastic_energy().total(), system.residual.clone())
            });
            let force = (ahead.0 - behind.0) / (2.0 * shift);
            let scale = if column % 4 == 3 { 1e-3 } else { 1.0 };
            let error = (force - residual[column]).abs();
            assert!(
                error < 1e-4 * scale * largest,
                "{column}: {force} {}",
                residual[column]
            );
            let scale = free.iter().fold(0.0_f64, |most, &row| {
                most.max(jacobian[(row, column)].abs())
            });
            for &row in &free {
                let slope = (ahead.1[row] - behind.1[row]) / (2.0 * shift);
                let error = (slope - jacobian[(row, column)]).abs();
                assert!(
                    error < 1e-4 * scale,
                    "{row} {column}: {slope} {}",
                    jacobian[(row, column)]
                );
            }
        }
    }
}

#[test]
fn what_rods_that_yield_do_not_support_is_rejected() {
    let mut viscous = pushed(wire());
    viscous.rods[0].retardation_time = 0.1;
    let start = Simulation::new(&pushed(wire()), &fixed(0.02))
        .unwrap()
        .as_start();
    let mut started = pushed(wire());
    started.start = Some(start);
    for (scene, scheme, expected) in [
        (viscous, Scheme::ImplicitEuler, "viscosity"),
        (started, Scheme::ImplicitEuler, "another run"),
        (pushed(wire()), Scheme::ImplicitMidpoint, "time.scheme"),
    ] {
        let parameters = IntegrationParameters {
            scheme,
            ..fixed(0.02)
        };
        let error = Simulation::new(&scene, &parameters)
            .err()
            .unwrap()
            .to_string();
        assert!(error.contains(expected), "{error}");
    }
}
