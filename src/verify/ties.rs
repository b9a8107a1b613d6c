//! Springs that act only in tension, against closed forms.

use super::scenario::{at_rest, simulation};
use super::{Check, Expectation, GroupError};
use std::f64::consts::PI;

const BOUNCE: Expectation = Expectation::new(
    "T = 2v/g + 2/ω (π − atan(v ω/g)), v² = 2 g h, ω² = k/m",
    "Newton",
);
const DEEPEST: Expectation = Expectation::new("g/ω² + √(g²/ω⁴ + v²/ω²)", "Newton");
const SLACK: Expectation = Expectation::new("Δ = m g/k", "Hooke");

/// Stiffness of the springs in the files, N/m.
const STIFFNESS: f64 = 50.0;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;
/// Mass of a body with its light rod, kg.
const MASS: f64 = 0.02 + 10.0 * PI * 1e-6 * 0.02;

/// Checks the bounces of a weight on a bungee, and a weight between two ties.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = bungee()?;
    checks.push(between_ties()?);
    Ok(checks)
}

fn bungee() -> Result<Vec<Check>, GroupError> {
    let mut simulation = simulation(include_str!("scenes/bungee.toml"), &[])?;
    let frequency = (STIFFNESS / MASS).sqrt();
    let (fall, length) = (0.05, 0.1);
    let speed = (2.0 * GRAVITY * fall).sqrt();
    let period =
        2.0 * speed / GRAVITY + 2.0 / frequency * (PI - libm::atan(speed * frequency / GRAVITY));
    let sag = GRAVITY / (frequency * frequency);
    let deepest = sag + libm::hypot(sag, speed / frequency);
    let (mut lowest, mut tops) = (0.0_f64, Vec::new());
    let mut before = (0.0, 0.0);
    while simulation.time() < 0.6 {
        simulation.advance(0.6)?;
        let now = (simulation.time(), simulation.velocities()[4].z);
        lowest = lowest.min(simulation.positions()[4].z);
        if before.1 > 0.0 && now.1 <= 0.0 {
            tops.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
        }
        before = now;
    }
    let [_, second] = tops[..] else {
        return Err(format!("the weight bounced {} times, not twice", tops.len()).into());
    };
    Ok(vec![
        BOUNCE
            .of("weight on a bungee: period of two bounces", "s")
            .relative(2.0 * period, second, 1e-4),
        DEEPEST
            .of("the same: largest extension", "m")
            .relative(deepest, -lowest - length, 1e-4),
    ])
}

fn between_ties() -> Result<Check, GroupError> {
    let simulation = at_rest(include_str!("scenes/weight_between_ties.toml"), &[])?;
    let name = "weight between two ties without slack: descent, with the lower tie slack";
    let found = -simulation.positions()[6].z;
    Ok(SLACK
        .of(name, "m")
        .relative(MASS * GRAVITY / STIFFNESS, found, 1e-6))
}
