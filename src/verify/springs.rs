//! Springs between nodes and about hinges, from scenario files, against closed forms. Torsional
//! springs between frames are in a separate file.

use super::frequencies::frequencies_of;
use super::scenario::{at_rest, moved, simulation};
use super::{Check, Expectation, GroupError, ties, turning_springs};
use nalgebra::DMatrix;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::rod::STRIDE;
use std::f64::consts::PI;

const LENGTHENING: Expectation = Expectation::new("Δ = Σ m g/k of all weights below", "Hooke");
const ROW: Expectation = Expectation::new("ω² = (3 ∓ √5)/2 k/m", "Lagrange");
const ORBIT: Expectation = Expectation::new("x = x₀ cos ωt, y = v₀/ω sin ωt, ω² = k/m", "Newton");
const HINGE: Expectation = Expectation::new("w = P L³/3EI + P b²/c", "Euler–Bernoulli");

const BREAK: Expectation = Expectation::new("v √(km) sin ωt = F", "Newton");
const FREED: Expectation = Expectation::new("v cos ωt", "Newton");

/// Stiffness of the springs in the files, N/m.
const STIFFNESS: f64 = 50.0;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;
/// Mass of a body with its light rod, kg.
const MASS: f64 = 0.02 + 10.0 * PI * 1e-6 * 0.02;

/// Checks weights in a row, a circling weight, a weight that breaks its spring, a sprung hinge,
/// torsional springs, and springs that act only in tension.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = weights_in_a_row()?;
    checks.push(orbit()?);
    checks.extend(broken_spring()?);
    checks.push(hinge()?);
    checks.extend(turning_springs::checks()?);
    checks.extend(ties::checks()?);
    Ok(checks)
}

fn weights_in_a_row() -> Result<Vec<Check>, GroupError> {
    let mut simulation = simulation(include_str!("scenes/weights_in_a_row.toml"), &[])?;
    let heights = |simulation: &Simulation| [3, 6].map(|node| simulation.positions()[node].z);
    let placed = heights(&simulation);
    simulation.find_equilibrium()?;
    let hung = heights(&simulation);
    let fallen = [placed[0] - hung[0], placed[1] - hung[1]];
    let mut checks = Vec::new();
    for (name, weights, got) in [
        ("upper", 2.0, fallen[0]),
        ("lower", 1.0, fallen[1] - fallen[0]),
    ] {
        let name = format!("two weights on springs in a row: lengthening of the {name} spring");
        let expected = weights * MASS * GRAVITY / STIFFNESS;
        checks.push(LENGTHENING.of(name, "m").relative(expected, got, 1e-6));
    }
    let found = vertical_frequencies(&mut simulation)?;
    for (sign, mode, got) in [(-1.0, 1, found[0]), (1.0, 2, found[1])] {
        let square = 0.5 * (3.0 + sign * 5.0_f64.sqrt()) * STIFFNESS / MASS;
        let name = format!("two weights on springs in a row, vertical mode {mode}: ω");
        checks.push(ROW.of(name, "rad/s").relative(square.sqrt(), got, 1e-4));
    }
    Ok(checks)
}

/// Angular frequencies of the vertical motion, ascending. If everything hangs vertically, this
/// motion is decoupled from all others.
fn vertical_frequencies(simulation: &mut Simulation) -> Result<Vec<f64>, GroupError> {
    let unknowns = simulation.free_unknowns();
    let vertical: Vec<usize> = (0..unknowns.len())
        .filter(|&k| unknowns[k] % STRIDE == 2)
        .collect();
    let part = |of: &DMatrix<f64>| {
        DMatrix::from_fn(vertical.len(), vertical.len(), |i, j| {
            of[(vertical[i], vertical[j])]
        })
    };
    let stiffness = part(&simulation.stiffness_matrix());
    frequencies_of(stiffness, &part(&simulation.mass_matrix()))
}

fn orbit() -> Result<Check, GroupError> {
    let mut simulation = simulation(include_str!("scenes/harmonic_orbit.toml"), &[])?;
    let (radius, speed, end) = (0.1, 2.0, 0.3);
    let frequency = (STIFFNESS / MASS).sqrt();
    let mut worst = 0.0_f64;
    while simulation.time() < end {
        simulation.advance(end)?;
        let phase = frequency * simulation.time();
        let along = Vector3::x() * (radius * libm::cos(phase));
        let across = Vector3::y() * (speed / frequency * libm::sin(phase));
        worst = worst.max((simulation.positions()[4] - along - across).norm());
    }
    let name = "weight orbiting on a spring of zero length for 2.4 turns, midpoint rule: largest distance from the \
                ellipse over its axis";
    Ok(ORBIT.of(name, "m").scaled(0.0, worst, radius, 1e-3))
}

fn broken_spring() -> Result<[Check; 2], GroupError> {
    let (speed, strength) = (2.0, 1.0);
    let simulation = moved(include_str!("scenes/breaking_spring.toml"), &[], 0.02)?;
    let frequency = (STIFFNESS / MASS).sqrt();
    let phase = libm::asin(strength / (speed * (STIFFNESS * MASS).sqrt()));
    let [Some(found)] = simulation.breaks()[..] else {
        return Err("the spring holds".into());
    };
    let name = "weight moving away on a spring: time at which the spring breaks, at half of the largest force";
    let velocity = simulation.velocities()[4].x;
    Ok([
        BREAK
            .of(name, "s")
            .relative(phase / frequency, found.time, 1e-3),
        FREED.of("the same: velocity after", "m/s").relative(
            speed * libm::cos(phase),
            velocity,
            1e-3,
        ),
    ])
}

fn hinge() -> Result<Check, GroupError> {
    let simulation = at_rest(include_str!("scenes/sprung_hinge.toml"), &[])?;
    let (force, arm, stiffness) = (1e-5, 0.1_f64, 0.01);
    let (length, bending) = (2.0 * arm, 1e9 * 0.25 * PI * 1e-12);
    let expected = force * (length.powi(3) / (3.0 * bending) + arm * arm / stiffness);
    let end = simulation.positions().last().ok_or("no nodes")?;
    let name = "cantilever with a sprung hinge in its middle: deflection";
    Ok(HINGE.of(name, "m").relative(expected, end.z, 1e-3))
}
