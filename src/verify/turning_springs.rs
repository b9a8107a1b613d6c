//! Springs that turn the frames of rods towards each other, from scenario files, against closed forms.

use super::frequencies::frequencies;
use super::scenario::simulation;
use super::{Check, Expectation, GroupError};
use std::f64::consts::PI;

const ARCS: Expectation = Expectation {
    formula: "two arcs of the curvature M/EI, with the angle M/c between them",
    source: "Euler–Bernoulli",
};
const SWING: Expectation = Expectation {
    formula: "ω² = 3c/mL²",
    source: "Newton",
};
const SPIN: Expectation = Expectation {
    formula: "ω² = 2c/mr²",
    source: "Newton",
};
const HARMONIC: Expectation = Expectation {
    formula: "θ = θ₀ (1 − cos ωt)",
    source: "Newton",
};

const PENDULUM: &str = include_str!("scenes/turning_pendulum.toml");
/// Length and radius of its rod, m, the mass of that, kg, and the stiffness of its spring, N m/rad.
const LENGTH: f64 = 0.1;
const RADIUS: f64 = 1e-3;
const MASS: f64 = 1000.0 * PI * RADIUS * RADIUS * LENGTH;
const STIFFNESS: f64 = 1e-3;
/// Second order, with 40 edges.
const BOUND: f64 = 1e-3;

/// Two beams under an end moment, a rod that swings about its end.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = arcs()?.to_vec();
    checks.extend(small_swings()?);
    checks.push(wide_swing()?);
    Ok(checks)
}

fn arcs() -> Result<[Check; 2], GroupError> {
    let mut simulation = simulation(include_str!("scenes/turning_spring.toml"), &[])?;
    simulation.find_equilibrium()?;
    let (length, moment, stiffness) = (0.1, 5e-3, 0.01);
    let radius = 1e9 * 0.25 * PI * 1e-12 / moment;
    let (arc, angle) = (length / radius, moment / stiffness);
    let ends = [0.0, arc, arc + angle, 2.0 * arc + angle];
    let [[a, b], [c, d]] = [[ends[0], ends[1]], [ends[2], ends[3]]];
    let x = radius * (libm::sin(b) - libm::sin(a) + libm::sin(d) - libm::sin(c));
    let z = radius * (libm::cos(a) - libm::cos(b) + libm::cos(c) - libm::cos(d));
    let tip = simulation.positions().last().ok_or("no nodes")?;
    let name = |axis| {
        format!("two beams that a turning spring ties, under an end moment: {axis} of the end")
    };
    let check =
        |axis, expected, got| ARCS.scaled(name(axis), "m", expected, got, 2.0 * length, BOUND);
    Ok([check("x", x, tip.x), check("z", z, tip.z)])
}

/// Angular frequency of the rod that swings, rad/s.
fn swing() -> f64 {
    (3.0 * STIFFNESS / (MASS * LENGTH * LENGTH)).sqrt()
}

fn small_swings() -> Result<[Check; 2], GroupError> {
    let mut simulation = simulation(PENDULUM, &[])?;
    let found = frequencies(&mut simulation)?;
    let near = |expected: f64| {
        let distance = |one: &f64| (one - expected).abs();
        let found = found.iter().copied();
        found
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(f64::NAN)
    };
    let spin = (2.0 * STIFFNESS / (MASS * RADIUS * RADIUS)).sqrt();
    Ok([
        SWING.relative(
            "stiff rod that a turning spring holds by its end: ω of its swing",
            "rad/s",
            swing(),
            near(swing()),
            BOUND,
        ),
        SPIN.relative(
            "the same: ω of its spin about itself",
            "rad/s",
            spin,
            near(spin),
            BOUND,
        ),
    ])
}

/// About one axis the moment is c times the angle however far the rod turns.
fn wide_swing() -> Result<Check, GroupError> {
    let rest: f64 = 1.5;
    let rotation = format!("joints.1.rest_rotation=[0, {:?}, 0]", -rest);
    let mut simulation = simulation(PENDULUM, &[rotation])?;
    let end = 1.3 * 2.0 * PI / swing();
    while simulation.time() < end {
        simulation.advance(end)?;
    }
    let tip = simulation.positions().last().ok_or("no nodes")?;
    // It turns about −y from x to z.
    let angle = libm::atan2(tip.z, tip.x).rem_euclid(2.0 * PI);
    let expected = rest * (1.0 - libm::cos(swing() * end));
    Ok(HARMONIC.scaled(
        "the same, let go 1.5 rad from where its spring rests: angle after 1.3 periods, of its amplitude",
        "rad",
        expected,
        angle,
        rest,
        3e-3,
    ))
}
