//! Filaments with negligible inertia, against a dense solution of the flow and a static beam.

use super::rods::{clamp, line, round_rod, run, steady};
use super::theory::stokeslet::forces;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Scheme;
use rodlab_engine::mechanics::fluid::FluidModel;
use rodlab_engine::mechanics::scene::{LoadKind, Scene};
use std::f64::consts::PI;

const GLIDING: Expectation = Expectation::new("U = f L/(F/U)", "dense solution of the rigid rod");
const AT_REST: Expectation = Expectation::new("f L⁴/(8 EI)", "Euler–Bernoulli beam");
const LENGTH: f64 = 0.02;
const RADIUS: f64 = 1e-4;
const EDGES: usize = 40;
const VISCOSITY: f64 = 1.0;
/// N/m.
const LOAD: f64 = 1e-3;
const YOUNG: f64 = 1e9;

/// A filament with edges of five radii. Inertia decays within 25 µs, a fortieth of the smaller
/// step; bending within a second.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let nodes = line(Vector3::zeros(), Vector3::x() * LENGTH, EDGES);
    let drag: Vector3 = forces(
        &nodes,
        &vec![Vector3::x(); EDGES + 1],
        1.02 * RADIUS,
        VISCOSITY,
    )
    .iter()
    .sum();
    let mut checks = Vec::new();
    for (name, scheme) in [
        ("implicit Euler", Scheme::ImplicitEuler),
        ("backward differences", Scheme::BackwardDifferences),
    ] {
        let gliding = run(&scene(&nodes, Vector3::x(), false), scheme, 1e-3, 0.02)?;
        let name = format!("filament without inertia pulled along itself, {name}: speed");
        let expected = LOAD * LENGTH / drag.x;
        let got = gliding.velocities()[EDGES / 2].x;
        checks.push(GLIDING.of(name, "m/s").relative(expected, got, 1e-3));
    }
    let clamped = scene(&nodes, Vector3::z(), true);
    let bent = run(&clamped, Scheme::BackwardDifferences, 1e-2, 5.0)?;
    let name = "clamped filament relaxed in a fluid, backward differences: tip";
    let expected = LOAD * LENGTH.powi(4) / (8.0 * YOUNG * 0.25 * PI * RADIUS.powi(4));
    let got = bent.positions()[EDGES].z;
    checks.push(AT_REST.of(name, "m").relative(expected, got, 1e-3));
    Ok(checks)
}

fn scene(nodes: &[Vector3], direction: Vector3, clamped: bool) -> Scene {
    Scene {
        rods: vec![round_rod(nodes.to_vec(), YOUNG, RADIUS)],
        clamps: if clamped { vec![clamp(0)] } else { Vec::new() },
        loads: vec![steady(LoadKind::Distributed {
            rod: None,
            force_per_length: LOAD * direction,
        })],
        fluid: Some(FluidModel::RegularizedStokeslets {
            viscosity: VISCOSITY,
            regularization: 1.02,
            far_field_error: 0.0,
        }),
        ..Scene::default()
    }
}
