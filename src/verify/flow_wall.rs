//! A filament near a wall in viscous fluid, against a dense solution with images by quadrature,
//! and against a long cylinder.

use super::filaments::{forces_on, open_filament};
use super::scenario::simulation;
use super::theory::stokeslet::forces;
use super::theory::wall::{drag_at_wall, gliding_cylinder};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::fluid::{Fluid, FluidError, FluidModel, Wall};

const IMAGES: Expectation = Expectation::new(
    "8πη u(xᵢ) = Σ ∫ (S + S*) f ds",
    "Ainley et al. 2008, dense solution",
);
const FREE: Expectation = Expectation::new("8πη u(xᵢ) = Σ ∫ S f ds", "Cortez 2001, dense solution");
const CYLINDER: Expectation = Expectation::new("2πη/arcosh(H/a)", "long cylinder");
/// Regularisation in rod radii (thesis sec. 2.4.1).
const REGULARIZATION: f64 = 1.02;
/// Default regularisation near a wall, in rod radii.
const BESIDE_A_WALL: f64 = 1.65;
const BOUND: f64 = 1e-3;

/// Speeds of a filament along, across and towards a wall, and the drag of a long one.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = filament()?;
    checks.extend(long_cylinder()?);
    Ok(checks)
}

/// A stiff filament of 200 radii, three radii above a wall, pulled by a force per length; and the
/// same filament far from the wall.
fn filament() -> Result<Vec<Check>, GroupError> {
    let (length, radius, viscosity, pull) = (20e-3, 1e-4, 1.0, 1e-3);
    let (nodes, got) = speed(&[])?;
    let expected = drag_at_wall(&nodes, BESIDE_A_WALL * radius, viscosity);
    let name = "filament three radii over a wall, pulled along itself: speed";
    let along = pull * length / expected[(0, 0)];
    let mut checks = vec![IMAGES.of(name, "m/s").relative(along, got, BOUND)];
    for (name, axis) in [("sideways", 1), ("away", 2)] {
        let velocity = Vector3::ith(axis, 1.0);
        let forces = forces_at_wall(&nodes, &velocity, radius, viscosity)?;
        let got: f64 = forces.iter().map(|force| force[axis]).sum();
        let name = format!("the same towed {name} at 1 m/s: drag");
        let expected = expected[(axis, axis)];
        checks.push(IMAGES.of(name, "N").relative(expected, got, BOUND));
    }
    let (nodes, got) = speed(&["planes.0.wall=false".into()])?;
    let velocities = vec![Vector3::x(); nodes.len()];
    let drag = forces(&nodes, &velocities, REGULARIZATION * radius, viscosity);
    let drag: f64 = drag.iter().map(|force| force.x).sum();
    let name = "the same without the wall, pulled along itself: speed";
    let expected = pull * length / drag;
    checks.push(FREE.of(name, "m/s").relative(expected, got, BOUND));
    Ok(checks)
}

/// Positions of the nodes, and the speed of the middle one, after a millisecond.
fn speed(overrides: &[String]) -> Result<(Vec<Vector3>, f64), GroupError> {
    let mut simulation = simulation(include_str!("scenes/filament_at_wall.toml"), overrides)?;
    for _ in 0..100 {
        simulation.advance(f64::INFINITY)?;
    }
    let nodes = simulation.positions().to_vec();
    Ok((nodes, simulation.velocities()[10].x))
}

/// Drag per length in the middle of a cylinder 600 radii long that moves along its axis.
fn long_cylinder() -> Result<Vec<Check>, FluidError> {
    let (radius, viscosity, edges) = (1.0, 1.0, 120);
    let mut checks = Vec::new();
    for (height, bound) in [(3.0, 4e-2), (10.0, 5e-3)] {
        let edge = 600.0 / f64::from(edges);
        let nodes: Vec<Vector3> = (0..=edges)
            .map(|k| Vector3::new(edge * f64::from(k), 0.0, height))
            .collect();
        let forces = forces_at_wall(&nodes, &Vector3::x(), radius, viscosity)?;
        let name = format!("long cylinder gliding {height} radii over a wall: drag per length");
        let expected = gliding_cylinder(viscosity, radius, height);
        let got = forces[nodes.len() / 2].x / edge;
        checks.push(CYLINDER.of(name, "N/m").relative(expected, got, bound));
    }
    Ok(checks)
}

/// Forces on the fluid, N per node, of a rigidly moving rod above the wall z = 0, computed by the
/// engine.
fn forces_at_wall(
    nodes: &[Vector3],
    velocity: &Vector3,
    radius: f64,
    viscosity: f64,
) -> Result<Vec<Vector3>, FluidError> {
    let model = FluidModel::RegularizedStokeslets {
        viscosity,
        regularization: BESIDE_A_WALL,
        far_field_error: 0.0,
    };
    let wall = Wall {
        point: Vector3::zeros(),
        normal: Vector3::z(),
        held: Vec::new(),
    };
    let filament = open_filament(nodes.len(), radius);
    let mut fluid = Fluid::beside_wall(&model, &[filament], wall)?;
    forces_on(&mut fluid, nodes, &vec![*velocity; nodes.len()])
}
