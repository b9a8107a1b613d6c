//! Free rigid bodies: in flight, on an incline, in a collision, as the jaws of a gripper, and as a
//! pulley with the weights on its rope.

use super::rods::run_until;
use super::scenario::{moved, simulation};
use super::theory::friction::sliding_acceleration;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::{Vector3, rotation};

const PRECESSION: Expectation = Expectation::new(
    "the axis turns about L at the rate L/I₁",
    "Euler; torque-free motion of a symmetric body",
);
const SLIDING: Expectation = Expectation::new("a = g (sin α − μ cos α)", "Coulomb");
const MOMENTA: Expectation = Expectation::new("P, L conserved", "Newton's third law");
const GRIP: Expectation = Expectation::new("P = 2 μ F + m g", "Coulomb");

const PULLEY: Expectation = Expectation::new(
    "a = g (m₁ − m₂)/(m₁ + m₂ + m + I/ϱ²)",
    "Atwood's machine with the rope's mass m, at the distance ϱ from the axle",
);

const GRAVITY: f64 = 9.81;
/// Distance of a rope on a pulley from its axle, m: the radii, and the gap as placed.
const AROUND: f64 = 0.0313;
/// Speed of the wire at which it has slipped, m/s; while it sticks it creeps a hundred times more slowly.
const SLIPPED: f64 = 5e-3;

/// Runs all checks.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for scheme in ["backward-differences", "implicit-euler"] {
        checks.push(precession(scheme)?);
    }
    for model in ["imc", "ipc", "complementarity"] {
        checks.push(sliding(model)?);
    }
    checks.extend(collision("imc")?);
    checks.extend(collision("complementarity")?);
    checks.push(grip()?);
    for model in ["imc", "ipc"] {
        checks.push(pulley(model)?);
    }
    Ok(checks)
}

/// Two weights on a rope over a pulley with inertia.
fn pulley(model: &str) -> Result<Check, GroupError> {
    let (end, step) = (0.3, 1e-3);
    let set = [format!("contact.model={model:?}")];
    let simulation = moved(include_str!("scenes/pulley.toml"), &set, end)?;
    let turn = simulation.body_motion(0).turn.y;
    let rope = simulation.rod_ranges()[0].nodes - 1;
    let edge = 2.0 * AROUND * libm::sin(std::f64::consts::PI / 40.0);
    let mass = 50.0 * std::f64::consts::PI * 1e-6 * rope as f64 * edge;
    let inertia = 0.25 + mass + 1e-4 / (AROUND * AROUND);
    let acceleration = GRAVITY * 0.05 / inertia;
    // Implicit Euler adds up velocities at the ends of steps.
    let expected = 0.5 * acceleration * end * (end + step) / AROUND;
    let row =
        format!("two weights on a rope over a pulley, {model}: turn of the pulley after 0.3 s");
    Ok(PULLEY.of(row, "rad").relative(expected, turn, 2e-3))
}

/// A can thrown with a spin.
fn precession(scheme: &str) -> Result<Check, GroupError> {
    let end = 0.7;
    let set = [format!("time.scheme={scheme:?}")];
    let simulation = moved(include_str!("scenes/thrown_cylinder.toml"), &set, end)?;
    let turn = rotation::from_vector(simulation.body_motion(0).turn);
    let (mass, radius, length) = (0.3, 0.03, 0.14);
    let along = 0.5 * mass * radius * radius;
    let across = mass * (0.25 * radius * radius + length * length / 12.0);
    let momentum = Vector3::new(across * 3.0, 0.0, along * 20.0);
    let precession = rotation::from_vector(momentum * (end / across));
    let (found, expected) = (turn * Vector3::z(), precession * Vector3::z());
    let apart = (found - expected).norm();
    let row = format!("spinning cylinder thrown, {scheme}: direction of its axis after 0.7 s");
    Ok(PRECESSION.of(row, "").zero(apart, 1e-4))
}

fn sliding(model: &str) -> Result<Check, GroupError> {
    let set = [format!("contact.model={model:?}")];
    let text = include_str!("scenes/sliding_box.toml");
    let mut simulation = moved(text, &set, 0.1)?;
    let velocity =
        |simulation: &rodlab_engine::mechanics::dynamics::Simulation| simulation.velocities()[0].x;
    let before = velocity(&simulation);
    run_until(&mut simulation, 0.4)?;
    let found = (velocity(&simulation) - before) / 0.3;
    let expected = sliding_acceleration(GRAVITY, 30f64.to_radians(), 0.3);
    let row = format!("box on an incline of 30°, μ = 0.3, {model}: acceleration");
    Ok(SLIDING.of(row, "m/s²").relative(expected, found, 1e-4))
}

/// Two boxes that meet in free space.
fn collision(model: &str) -> Result<[Check; 2], GroupError> {
    let set = [format!("contact.model={model:?}")];
    let mut simulation = simulation(include_str!("scenes/colliding_boxes.toml"), &set)?;
    let before = simulation.momenta();
    run_until(&mut simulation, 0.3)?;
    let after = simulation.momenta();
    let [momentum, angular] = [0, 1].map(|k| (after[k] - before[k]).norm() / before[k].norm());
    let rows = ["momentum", "angular momentum"];
    let rows = rows.map(|what| match model {
        "imc" => format!("two boxes that collide, μ = 0.4: change of {what}"),
        _ => format!("two boxes that collide, μ = 0.4, {model}: change of {what}"),
    });
    let [first, second] = rows;
    Ok([
        MOMENTA.of(first, "").zero(momentum, 1e-9),
        MOMENTA.of(second, "").zero(angular, 2e-3),
    ])
}

/// The pull at which a wire slips out of two jaws.
fn grip() -> Result<Check, GroupError> {
    let mut simulation = simulation(include_str!("../../scenarios/gripper.toml"), &[])?;
    let last = simulation.rod_ranges()[0].nodes - 1;
    while simulation.velocities()[last].z < SLIPPED && simulation.time() < 1.1 {
        let next = simulation.time() + 1e-3;
        run_until(&mut simulation, next)?;
    }
    let pull = 4.0 * (simulation.time() - 0.1);
    let volume = std::f64::consts::PI * 3e-3 * 3e-3 * 0.12;
    let expected = 2.0 * 0.3 * 5.0 + 1200.0 * volume * GRAVITY;
    let row = "wire between two jaws, μ = 0.3: pull at which it slips";
    Ok(GRIP.of(row, "N").relative(expected, pull, 1e-2))
}
