//! Bodies with their centre of mass away from the node that carries them, from scenario files,
//! against closed forms.

use super::frequencies::{ascending, frequencies, nearest};
use super::scenario::{at_rest, simulation};
use super::{Check, Expectation, GroupError};
use nalgebra::Matrix2;
use rodlab_engine::mechanics::dynamics::Simulation;
use std::f64::consts::{PI, TAU};

const SAG: Expectation = Expectation::new("w = P L³/3EI + P a L²/2EI", "Euler–Bernoulli");
const MODES: Expectation =
    Expectation::new("det(K − ω² [m, ma; ma, I + ma²]) = 0", "Euler–Bernoulli");
const FALL: Expectation = Expectation::new("t = K(sin ½θ₀) √((I + md²)/mgd)", "physical pendulum");

const BOUND: f64 = 1e-3;

/// A ball beyond the end of a cantilever, at rest and in vibration; a box that swings about a node
/// outside it.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = cantilever()?;
    checks.push(pendulum()?);
    Ok(checks)
}

fn cantilever() -> Result<Vec<Check>, GroupError> {
    let (length, bending, mass, arm) = (0.2_f64, 1e-3, 0.01, 0.03);
    let inertia = 0.4 * mass * 0.02 * 0.02;
    let mut simulation = at_rest(include_str!("scenes/eccentric_body.toml"), &[])?;
    let weight = mass * 0.01;
    let sag = weight * length * length / bending * (length / 3.0 + arm / 2.0);
    let end = simulation.positions().last().ok_or("no nodes")?;
    let mut checks = vec![
        SAG.of("cantilever with a ball beyond its end: sag", "m")
            .relative(sag, -end.z, BOUND),
    ];
    let found = frequencies(&mut simulation)?;
    let stiffness = Matrix2::new(12.0, -6.0 * length, -6.0 * length, 4.0 * length * length)
        * (bending / length.powi(3));
    let coupled = mass * arm;
    let masses = Matrix2::new(mass, coupled, coupled, inertia + coupled * arm);
    let factor = masses.cholesky().ok_or("no mass")?.l();
    let inverse = factor.try_inverse().ok_or("no mass")?;
    let squares = (inverse * stiffness * inverse.transpose()).symmetric_eigenvalues();
    let theory = ascending(squares.iter().map(|square| square.sqrt()));
    for (mode, expected) in theory.into_iter().enumerate() {
        let name = format!("the same, bending mode {}: ω", mode + 1);
        let got = nearest(&found, expected);
        checks.push(MODES.of(name, "rad/s").relative(expected, got, BOUND));
    }
    Ok(checks)
}

/// Time in which a box falls from rest, at 112 degrees from the vertical, to its lowest position.
fn pendulum() -> Result<Check, GroupError> {
    let mut simulation = simulation(include_str!("scenes/physical_pendulum.toml"), &[])?;
    let (mass, gravity) = (0.1, 9.81);
    let [along, across] = [0.05_f64, 0.02];
    let square = along * along + across * across;
    // The axis is the first director, which is perpendicular to the plane of the swing.
    let inertia = mass * (0.04 * 0.04 + 0.06 * 0.06) / 12.0 + mass * square;
    let ahead = libm::atan2(across, along);
    let start = 0.5 * PI + ahead;
    let quarter = 0.5 * PI / mean_of_gauss(1.0, libm::cos(0.5 * start));
    let expected = quarter * (inertia / (mass * gravity * square.sqrt())).sqrt();
    // The rod rotates downwards about y, starting along x.
    let angle = |simulation: &Simulation| {
        let end = simulation.positions()[2];
        libm::atan2(-end.z, end.x).rem_euclid(TAU)
    };
    let (mut before, mut found) = ([0.0, 0.0], f64::NAN);
    while simulation.time() < 0.3 && found.is_nan() {
        simulation.advance(0.3)?;
        let now = [simulation.time(), angle(&simulation)];
        if now[1] >= start && now[1] < PI + start {
            let part = (start - before[1]) / (now[1] - before[1]);
            found = before[0] + part * (now[0] - before[0]);
        }
        before = now;
    }
    let name = "box that swings about a node outside of it: time from 112° to its lowest place";
    Ok(FALL.of(name, "s").relative(expected, found, BOUND))
}

/// Arithmetic–geometric mean M. The complete elliptic integral is K(k) = π/2 / M(1, √(1 − k²)).
fn mean_of_gauss(first: f64, second: f64) -> f64 {
    let (mut arithmetic, mut geometric) = (first, second);
    while (arithmetic - geometric).abs() > 1e-15 * arithmetic {
        (arithmetic, geometric) = (
            0.5 * (arithmetic + geometric),
            (arithmetic * geometric).sqrt(),
        );
    }
    arithmetic
}
