//! Drag in viscous fluid, against quadrature and a dense solution.

use super::filaments::{forces_on, open_filament};
use super::rods::line;
use super::theory::stokeslet::{adaptive_segment_integral, forces};
use super::{Check, Expectation, GroupError, flow, flow_wall};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::SimulationError;
use rodlab_engine::mechanics::fluid::{Fluid, FluidError, FluidModel, segment_integral};
use std::f64::consts::TAU;

const SEGMENT: Expectation = Expectation::new("∫ S(x − y(s)) f(s) ds", "adaptive quadrature");
const DENSE: Expectation =
    Expectation::new("8πη u(xᵢ) = Σ ∫ S f ds", "Cortez 2001, dense solution");
/// Regularisation in rod radii (thesis sec. 2.4.1).
const REGULARIZATION: f64 = 1.02;
const BOUND: f64 = 1e-3;

/// Checks the segment integral, a straight rod, the helix of the thesis, joined and held rods, and
/// a filament near a wall.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = vec![segment_check()];
    checks.extend(straight_rod()?);
    checks.extend(helix()?);
    checks.extend(flow::checks()?);
    checks.extend(flow_wall::checks()?);
    Ok(checks)
}

/// Largest relative error of the closed form over 1000 pairs of a point and a segment: far apart,
/// close together, on the axis, and touching.
fn segment_check() -> Check {
    let mut numbers = rodlab_engine::random::uniform_numbers(2023);
    let mut vector = || Vector3::from_fn(|_, _| 2.0 * numbers() - 1.0);
    let mut worst = 0.0_f64;
    for pair in 0..1000 {
        let (start, end, x) = (vector(), vector(), vector());
        let place = vector().x;
        let x = match pair % 5 {
            0 => x * 5.0,
            1 => start + (end - start) * (1.5 * place),
            2 => start + x * 1e-3,
            3 => end,
            _ => x,
        };
        let regularization = libm::pow(10f64, -2.0 - 1.5 * place.abs());
        let expected = adaptive_segment_integral(&x, &start, &end, regularization);
        let got = segment_integral(&x, &start, &end, regularization);
        for (expected, got) in expected.iter().zip(&got) {
            worst = worst.max((expected - got).norm() / expected.norm());
        }
    }
    let name = "Stokeslet segments, 1000 random pairs: worst relative error";
    SEGMENT.of(name, "").zero(worst, 1e-10)
}

/// A straight rod of unit length, which is a hundred times its radius, towed along and across its
/// axis.
fn straight_rod() -> Result<Vec<Check>, SimulationError> {
    let (radius, viscosity) = (1e-2, 1.0);
    let nodes = line(Vector3::zeros(), Vector3::x(), 40);
    let mut checks = Vec::new();
    for (name, direction) in [("along", Vector3::x()), ("across", Vector3::y())] {
        let velocities = vec![direction; nodes.len()];
        let total = |forces: &[Vector3]| forces.iter().sum::<Vector3>().dot(&direction);
        let expected = forces(&nodes, &velocities, REGULARIZATION * radius, viscosity);
        let got = fluid_forces(&nodes, &velocities, radius, viscosity)?;
        let name = format!("straight rod, L/a = 100, 41 nodes: drag {name} it");
        let expected = total(&expected);
        checks.push(DENSE.of(name, "N").relative(expected, total(&got), BOUND));
    }
    Ok(checks)
}

/// The helix of the thesis (sec. 2.4.2), turning at 15 rad/s about its axis.
fn helix() -> Result<Vec<Check>, SimulationError> {
    let (radius, viscosity) = (1e-3, 0.1);
    let nodes: Vec<Vector3> = (0..68)
        .map(|k| {
            let z = 0.2 * f64::from(k) / 67.0;
            let angle = TAU * z / 0.05;
            Vector3::new(0.01 * libm::cos(angle), 0.01 * libm::sin(angle), z)
        })
        .collect();
    let velocities: Vec<Vector3> = nodes
        .iter()
        .map(|x| (15.0 * Vector3::z()).cross(x))
        .collect();
    let force = |forces: &[Vector3]| forces.iter().map(|f| f.z).sum::<f64>();
    let torque = |forces: &[Vector3]| {
        let moments = nodes.iter().zip(forces).map(|(x, f)| x.cross(f).z);
        moments.sum::<f64>()
    };
    let expected = forces(&nodes, &velocities, REGULARIZATION * radius, viscosity);
    let got = fluid_forces(&nodes, &velocities, radius, viscosity)?;
    let name = |what: &str| format!("helix of the thesis at 15 rad/s, 68 nodes: {what}");
    Ok(vec![
        DENSE
            .of(name("force"), "N")
            .relative(force(&expected), force(&got), BOUND),
        DENSE
            .of(name("torque"), "N m")
            .relative(torque(&expected), torque(&got), BOUND),
    ])
}

/// Forces of a rigid rod on the fluid, computed by the engine.
fn fluid_forces(
    nodes: &[Vector3],
    velocities: &[Vector3],
    radius: f64,
    viscosity: f64,
) -> Result<Vec<Vector3>, SimulationError> {
    let model = FluidModel::RegularizedStokeslets {
        viscosity,
        regularization: REGULARIZATION,
        far_field_error: 0.0,
    };
    let unphysical = |error: FluidError| SimulationError::Unphysical(error.to_string());
    let filament = open_filament(nodes.len(), radius);
    let mut fluid = Fluid::new(&model, &[filament]).map_err(unphysical)?;
    forces_on(&mut fluid, nodes, velocities).map_err(unphysical)
}
