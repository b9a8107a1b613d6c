//! Torsional springs between the frames of rods, from scenario files, against closed forms.

use super::frequencies::{frequencies, nearest};
use super::scenario::{at_rest, moved, simulation};
use super::{Check, Expectation, GroupError};
use std::f64::consts::PI;

const ARCS: Expectation = Expectation::new(
    "two arcs of the curvature M/EI, with the angle M/c between them",
    "Euler–Bernoulli",
);
const SWING: Expectation = Expectation::new("ω² = 3c/mL²", "Newton");
const SPIN: Expectation = Expectation::new("ω² = 2c/mr²", "Newton");
const HARMONIC: Expectation = Expectation::new("θ = θ₀ (1 − cos ωt)", "Newton");

const PENDULUM: &str = include_str!("scenes/turning_pendulum.toml");
/// Length of the rod of the pendulum, m.
const LENGTH: f64 = 0.1;
/// Radius of the rod, m.
const RADIUS: f64 = 1e-3;
/// Mass of the rod, kg.
const MASS: f64 = 1000.0 * PI * RADIUS * RADIUS * LENGTH;
/// Stiffness of the spring, N m/rad.
const STIFFNESS: f64 = 1e-3;
/// Error bound for second-order convergence with 40 edges.
const BOUND: f64 = 1e-3;

/// Checks two beams under an end moment, and a rod that swings about its end.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = arcs()?.to_vec();
    checks.extend(small_swings()?);
    checks.push(wide_swing()?);
    Ok(checks)
}

fn arcs() -> Result<[Check; 2], GroupError> {
    let simulation = at_rest(include_str!("scenes/turning_spring.toml"), &[])?;
    let (length, moment, stiffness) = (0.1, 5e-3, 0.01);
    let radius = 1e9 * 0.25 * PI * 1e-12 / moment;
    let (arc, angle) = (length / radius, moment / stiffness);
    let ends = [0.0, arc, arc + angle, 2.0 * arc + angle];
    let [[a, b], [c, d]] = [[ends[0], ends[1]], [ends[2], ends[3]]];
    let x = radius * (libm::sin(b) - libm::sin(a) + libm::sin(d) - libm::sin(c));
    let z = radius * (libm::cos(a) - libm::cos(b) + libm::cos(c) - libm::cos(d));
    let tip = simulation.positions().last().ok_or("no nodes")?;
    let name = |axis| {
        format!("two beams joined by a turning spring, under an end moment: {axis} of the end")
    };
    let check = |axis, expected, got| {
        ARCS.of(name(axis), "m")
            .scaled(expected, got, 2.0 * length, BOUND)
    };
    Ok([check("x", x, tip.x), check("z", z, tip.z)])
}

/// Angular frequency of the rod that swings, rad/s.
fn swing() -> f64 {
    (3.0 * STIFFNESS / (MASS * LENGTH * LENGTH)).sqrt()
}

fn small_swings() -> Result<[Check; 2], GroupError> {
    let mut simulation = simulation(PENDULUM, &[])?;
    let found = frequencies(&mut simulation)?;
    let spin = (2.0 * STIFFNESS / (MASS * RADIUS * RADIUS)).sqrt();
    let name = "stiff rod held at its end by a turning spring: ω of its swing";
    let got = [swing(), spin].map(|expected| nearest(&found, expected));
    Ok([
        SWING.of(name, "rad/s").relative(swing(), got[0], BOUND),
        SPIN.of("the same: ω of its spin about itself", "rad/s")
            .relative(spin, got[1], BOUND),
    ])
}

/// About one axis the moment is c times the angle, for any angle.
fn wide_swing() -> Result<Check, GroupError> {
    let rest: f64 = 1.5;
    let rotation = format!("joints.1.rest_rotation=[0, {:?}, 0]", -rest);
    let end = 1.3 * 2.0 * PI / swing();
    let simulation = moved(PENDULUM, &[rotation], end)?;
    let tip = simulation.positions().last().ok_or("no nodes")?;
    // The rod rotates about −y from x to z.
    let angle = libm::atan2(tip.z, tip.x).rem_euclid(2.0 * PI);
    let expected = rest * (1.0 - libm::cos(swing() * end));
    let name = "the same, released 1.5 rad from the rest angle of its spring: angle after 1.3 periods, error over its amplitude";
    Ok(HARMONIC.of(name, "rad").scaled(expected, angle, rest, 3e-3))
}
