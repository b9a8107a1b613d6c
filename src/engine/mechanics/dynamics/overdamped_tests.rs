//! Rods in a flow whose drag makes their inertia negligible.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::fluid::{Filament, FlowOperator, FluidModel};
use crate::mechanics::scene::{RodDescription, Scene, Stiffness};
use crate::mechanics::test_support::{
    SCHEMES, at, clamp, distributed, fixed_steps, line, run, section, spring, straight_rod,
};
use std::f64::consts::PI;

const LENGTH: f64 = 0.02;
const RADIUS: f64 = 1e-4;
const VISCOSITY: f64 = 1.0;
const LOAD: f64 = 1e-3;

/// A filament of 1 GPa, 200 radii long, in a fluid of 1 Pa s, with a load of 1 mN/m in a given
/// direction. Motions decay within 25 µs.
fn filament(edges: usize, direction: Vector3) -> Scene {
    let area = PI * RADIUS * RADIUS;
    let mut rod = straight_rod(edges, LENGTH);
    rod.radius = RADIUS;
    rod.mass_per_length = 1000.0 * area;
    rod.rotational_inertia_per_length = 0.5 * rod.mass_per_length * RADIUS * RADIUS;
    rod.stiffness = Stiffness::circular(1e9, 0.5, RADIUS);
    Scene {
        rods: vec![rod],
        loads: vec![distributed(None, LOAD * direction)],
        fluid: Some(FluidModel::RegularizedStokeslets {
            viscosity: VISCOSITY,
            regularization: 1.02,
            far_field_error: 0.0,
        }),
        ..Scene::default()
    }
}

/// Speed at which the load moves the filament, m/s, from a dense solution for the flow of a rigid
/// rod.
fn gliding_speed(edges: usize) -> f64 {
    let filament = Filament {
        first_node: 0,
        nodes: edges + 1,
        closed: false,
        radius: RADIUS,
    };
    let edge = LENGTH / edges as f64;
    let nodes: Vec<_> = (0..=edges)
        .map(|k| k as f64 * edge * Vector3::x())
        .collect();
    let mut operator = FlowOperator::new(&[filament], 1.02);
    operator.assemble(&nodes);
    let matrix = nalgebra::DMatrix::from_fn(edges + 1, edges + 1, |row, column| {
        operator.block(row, column)[(0, 0)]
    });
    let densities = matrix
        .lu()
        .solve(&nalgebra::DVector::from_element(edges + 1, 1.0))
        .unwrap();
    let lengths = densities.sum() - 0.5 * (densities[0] + densities[edges]);
    LOAD * LENGTH / (8.0 * PI * VISCOSITY * edge * lengths)
}

#[test]
fn filaments_glide_at_the_speed_of_the_dense_solution_with_every_scheme_and_step() {
    for edges in [10, 40] {
        let speed = gliding_speed(edges);
        let scene = filament(edges, Vector3::x());
        for scheme in SCHEMES {
            for step in [1e-2, 1e-4] {
                let glided = run(&scene, scheme, step, 60.0 * step);
                let way = glided.positions()[edges / 2].x - 0.5 * LENGTH;
                // The filament accelerates within the first step.
                let error = way / (speed * 60.0 * step) - 1.0;
                assert!(error.abs() < 0.02, "{scheme:?} {edges} {step}: {error}");
                // The midpoint rule does not damp motions that its steps do not resolve.
                if scheme != Scheme::ImplicitMidpoint {
                    let error = glided.velocities()[edges / 2].x / speed - 1.0;
                    assert!(error.abs() < 1e-4, "{scheme:?} {edges} {step}: {error}");
                }
            }
        }
    }
}

#[test]
fn a_clamped_filament_relaxes_as_with_small_steps_of_implicit_euler() {
    let edges = 20;
    let mut scene = filament(edges, Vector3::z());
    scene.clamps.push(clamp(0, 0));
    let end = 0.04;
    let reference = run(&scene, Scheme::ImplicitEuler, 5e-5, end);
    let tip = reference.positions()[edges].z;
    let stiffness = scene.rods[0].stiffness.bending[0];
    let rest = LOAD * LENGTH.powi(4) / (8.0 * stiffness);
    assert!(tip > 0.05 * rest && tip < 0.5 * rest, "{}", tip / rest);
    for (scheme, bound) in [
        (Scheme::ImplicitEuler, 0.03),
        (Scheme::BackwardDifferences, 0.004),
    ] {
        let found = run(&scene, scheme, 1e-3, end);
        let [other, velocity] = [
            found.positions()[edges].z / tip,
            found.velocities()[edges].z / reference.velocities()[edges].z,
        ];
        assert!((other - 1.0).abs() < bound, "{scheme:?}: {other}");
        assert!((velocity - 1.0).abs() < bound, "{scheme:?}: {velocity}");
    }
}

#[test]
fn a_coupled_step_that_is_interrupted_continues_bit_for_bit() {
    let scene = filament(12, Vector3::new(1.0, 0.0, 0.5));
    let parameters = IntegrationParameters {
        scheme: Scheme::BackwardDifferences,
        ..IntegrationParameters::default()
    };
    let steps = |simulation: &mut Simulation, count| {
        for _ in 0..count {
            simulation.advance(1.0).unwrap();
        }
    };
    let mut whole = Simulation::new(&scene, &parameters).unwrap();
    steps(&mut whole, 20);
    let state = whole.state();
    steps(&mut whole, 20);
    let mut restored = Simulation::new(&scene, &parameters).unwrap();
    restored.restore(state).unwrap();
    steps(&mut restored, 20);
    assert_eq!(whole.positions(), restored.positions());
    assert_eq!(whole.velocities(), restored.velocities());
}

#[test]
fn velocities_that_ring_are_reported() {
    let scene = filament(10, Vector3::x());
    let remarks = |scheme| {
        let simulation = run(&scene, scheme, 1e-3, 0.01);
        simulation.remarks().join("\n")
    };
    assert!(remarks(Scheme::ImplicitMidpoint).contains("midpoint"));
    assert!(!remarks(Scheme::BackwardDifferences).contains("midpoint"));
}

/// A rod of a radius (m), modulus (Pa) and density (kg/m³) between two points.
fn rod_between(
    name: &str,
    [start, end]: [Vector3; 2],
    edges: usize,
    [radius, modulus, density]: [f64; 3],
) -> RodDescription {
    let area = PI * radius * radius;
    let bending = modulus * 0.25 * area * radius * radius;
    let stiffness = section(modulus * area, [bending; 2], bending / 1.5);
    let nodes = line(start, end, edges);
    RodDescription::uniform(name, nodes, stiffness, radius, density * area)
}

/// Two rods in a fluid; one of them is loaded.
fn pair(rods: Vec<RodDescription>, loaded: usize, load: Vector3, viscosity: f64) -> Scene {
    Scene {
        rods,
        loads: vec![distributed(Some(loaded), load)],
        fluid: Some(FluidModel::RegularizedStokeslets {
            viscosity,
            regularization: 1.02,
            far_field_error: 0.0,
        }),
        ..Scene::default()
    }
}

#[test]
fn a_free_filament_floats_along_with_one_that_is_pulled() {
    // The rods are four radii apart, with edges of 11 radii: the drag on the free rod is almost
    // zero.
    let edges = 8;
    let numbers = [2.845_715_466e-8, 1.364_960e6, 1588.0];
    let line = [Vector3::zeros(), 2.536_960_667e-6 * Vector3::x()];
    let shift = Vector3::new(5.073_921_335e-7, 1.187_161_019e-7, 0.0);
    let other = line.map(|place| place + shift);
    let rods = vec![
        rod_between("pulled", line, edges, numbers),
        rod_between("free", other, edges, numbers),
    ];
    let load = 1e-6 * Vector3::new(-1.896, 1.514, 1.189);
    let scene = pair(rods, 0, load, 0.177_123_345);
    let step = 6.725_380_85e-5;
    let [one, other] = [Scheme::BackwardDifferences, Scheme::ImplicitEuler].map(|scheme| {
        let end = run(&scene, scheme, step, 16.0 * step);
        end.positions()[edges + 1 + edges / 2] - scene.rods[1].centreline[edges / 2]
    });
    let error = (one - other).norm() / other.norm();
    assert!(error < 0.01, "{error}");
}

#[test]
fn overlapping_rods_end_a_run_instead_of_leaping_apart() {
    // A load pushes the end of one filament, which a spring ties to the end of the other, past that end.
    let edges = 32;
    let numbers = [1.850_902_429e-5, 8.000_606e5, 1350.34];
    let end = 8.498_376_396e-3 * Vector3::x();
    let far = Vector3::new(1.413_728_943e-2, -6.358_070_552e-3, 0.0);
    let rods = vec![
        rod_between("clamped", [Vector3::zeros(), end], edges, numbers),
        rod_between("pushed", [end, far], edges, numbers),
    ];
    let load = Vector3::new(-4.905_599_66e-6, 5.358_673_07e-5, 6.286_189_42e-5);
    let mut scene = pair(rods, 1, load, 1.738_397_645e-2);
    scene.clamps.push(clamp(0, 0));
    scene.springs.push(spring(
        "spring",
        [[0, edges], [1, 0]].map(|[rod, node]| at(rod, node)),
        8.274_793_265e-4,
    ));
    let step = 3.105_050_228e-3;
    let parameters = IntegrationParameters {
        minimum_step: 1e-6 * step,
        ..fixed_steps(Scheme::BackwardDifferences, step)
    };
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    while simulation.time() < 16.0 * step {
        if let Err(error) = simulation.advance(16.0 * step) {
            assert!(error.to_string().contains("overlap"), "{error}");
            return;
        }
        let [one, other] = [edges, edges + 1].map(|node| simulation.positions()[node]);
        let gap = (one - other).norm() / numbers[0];
        assert!(gap < 1.5, "{gap} radii at {}", simulation.time());
    }
}
