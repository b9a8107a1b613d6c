//! Balls on rods in a fluid, and rods that spin about their own axes.

use super::rods::{clamp, gravity, line, round_rod, run};
use super::theory::shell::drag_of_sphere_with_tail;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Scheme, Simulation, SimulationError};
use rodlab_engine::mechanics::fluid::FluidModel;
use rodlab_engine::mechanics::scene::{Body, Clamp, Motion, RodNode, Scene};
use std::f64::consts::PI;

const SINKING: Expectation = Expectation::new("U = m g/(6πηa)", "Stokes 1851");
const WITH_TAIL: Expectation = Expectation::new(
    "U = m g/(F/U)",
    "dense solution, the ball a shell of 400 points",
);
const SPINNING: Expectation = Expectation::new("4πη r² L Ω", "long cylinder");
const VISCOSITY: f64 = 1.0;
const YOUNG: f64 = 1e6;
const RADIUS: f64 = 2e-4;
const BALL: f64 = 5e-3;
/// kg.
const MASS: f64 = 2e-3;
const GRAVITY: f64 = 9.81;
const REGULARIZATION: f64 = 1.02;

/// A ball of 5 mm and 2 g, alone and with a tail of three times its size, and a rod that is spun
/// by a motor.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    let inside = upwards(2, 0.8 * BALL);
    let resistive = FluidModel::Resistive {
        viscosity: VISCOSITY,
    };
    for (name, fluid) in [
        ("regularized Stokeslets", stokeslets()),
        ("resistive", resistive),
    ] {
        let ball = sink(&inside, fluid)?;
        let name = format!("ball that sinks, {name}: speed");
        let expected = weight(&inside) / (6.0 * PI * VISCOSITY * BALL);
        let got = -ball.velocities()[0].z;
        checks.push(SINKING.of(name, "m/s").relative(expected, got, 1e-5));
    }
    let tail = upwards(10, 0.02);
    let drag = drag_of_sphere_with_tail(BALL, &tail, REGULARIZATION * RADIUS, VISCOSITY);
    let name = "ball with a tail that sinks: speed";
    let expected = weight(&tail) / drag;
    let got = -sink(&tail, stokeslets())?.velocities()[0].z;
    checks.push(WITH_TAIL.of(name, "m/s").relative(expected, got, 1e-2));
    checks.push(spun()?);
    Ok(checks)
}

fn stokeslets() -> FluidModel {
    FluidModel::RegularizedStokeslets {
        viscosity: VISCOSITY,
        regularization: REGULARIZATION,
        far_field_error: 0.0,
    }
}

/// Nodes of a rod that points upwards from the origin.
fn upwards(edges: usize, length: f64) -> Vec<Vector3> {
    line(Vector3::zeros(), Vector3::z() * length, edges)
}

/// Weight of ball and rod, N.
fn weight(nodes: &[Vector3]) -> f64 {
    let length = nodes[nodes.len() - 1].z;
    (MASS + 1000.0 * PI * RADIUS * RADIUS * length) * GRAVITY
}

/// A sinking ball on the first node of a rod, after fourteen times the relaxation time of its
/// speed.
fn sink(nodes: &[Vector3], fluid: FluidModel) -> Result<Simulation, SimulationError> {
    let scene = Scene {
        rods: vec![round_rod(nodes.to_vec(), YOUNG, RADIUS)],
        bodies: vec![Body::uniform_ball(RodNode { rod: 0, node: 0 }, MASS, BALL)],
        loads: vec![gravity(GRAVITY)],
        fluid: Some(fluid),
        ..Scene::default()
    };
    run(&scene, Scheme::ImplicitEuler, 5e-3, 0.3)
}

/// The moment of a clamp that turns one end of a rod about its axis.
fn spun() -> Result<Check, SimulationError> {
    let (radius, length, speed) = (1e-3, 0.1, 10.0);
    let scene = Scene {
        rods: vec![round_rod(upwards(20, length), YOUNG, radius)],
        clamps: vec![Clamp {
            motion: Motion {
                axis: Some(Vector3::z()),
                angular_velocity: speed,
                ..Motion::default()
            },
            ..clamp(0)
        }],
        fluid: Some(stokeslets()),
        spin_drag: true,
        ..Scene::default()
    };
    let spinning = run(&scene, Scheme::ImplicitEuler, 1e-2, 2.0)?;
    let name = "rod spun about its axis: moment of the motor";
    let expected = 4.0 * PI * VISCOSITY * radius * radius * length * speed;
    let got = spinning.reaction_moment(0).z;
    Ok(SPINNING.of(name, "N m").relative(expected, got, 1e-6))
}
