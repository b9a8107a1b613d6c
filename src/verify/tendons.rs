//! Tendons: a backbone that they bend and twist, and movable pulleys.

use super::rods::run_until;
use super::scenario::{at_rest, simulation};
use super::{Check, Expectation, GroupError};
use std::f64::consts::{PI, TAU};

const ARC: Expectation = Expectation::new("κ = T d/EI", "constant curvature");
const HELIX: Expectation = Expectation::new(
    "least energy of ½ EI κ² + ½ GJ τ² + T √((1 − κ d)² + d² (τ + α)²)",
    "Rucker and Webster 2011, without load",
);
const PULLEY: Expectation =
    Expectation::new("a = g (m₁ − 2 m₂)/(m₁ + 4 m₂)", "Newton, massless pulley");

const WINCH: Expectation = Expectation::new(
    "T = W/(1 + e^(−μφ)), φ = π; lowering, W/(1 + e^(μφ))",
    "Euler, Eytelwein",
);

const BACKBONE: &str = include_str!("scenes/tendon_backbone.toml");
/// Length of the backbone and distance of the tendon, m; tension, N; EI and GJ, N m².
const LENGTH: f64 = 0.3;
const OFFSET: f64 = 0.01;
const TENSION: f64 = 5.0;
const BENDING: f64 = 0.01;
const TWISTING: f64 = 0.008;
/// Rate at which the offset turns, rad/m: once from the first of 120 nodes to the last.
const TURNING: f64 = TAU / (LENGTH * 119.0 / 120.0);
/// Node in the middle.
const MIDDLE: usize = 60;

const GRAVITY: f64 = 9.81;

/// Checks an arc, a helix, two weights on a rope, and a winch.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let [curvature, _] = bent(0.0)?;
    let mut checks = vec![
        ARC.of("tendon beside a backbone: curvature", "1/m")
            .relative(TENSION * OFFSET / BENDING, curvature, 1e-3),
    ];
    let [curvature, twist] = bent(1.0)?;
    let [expected_curvature, expected_twist] = helical(TURNING);
    checks.push(
        HELIX
            .of("helical tendon around a backbone: curvature", "1/m")
            .relative(expected_curvature, curvature, 1e-3),
    );
    checks.push(
        HELIX
            .of("the same: twist", "rad/m")
            .relative(expected_twist, twist, 1e-3),
    );
    checks.push(movable_pulley()?);
    checks.push(winch(
        "winch that lifts by a pulley with friction 0.15: its pull",
        0.02,
    )?);
    checks.push(winch("the same, as it lowers", -0.02)?);
    Ok(checks)
}

/// Curvature and twist in the middle under a tendon that makes some turns.
fn bent(turns: f64) -> Result<[f64; 2], GroupError> {
    let simulation = at_rest(BACKBONE, &[format!("parameters.turns={turns}")])?;
    let middle = simulation.resultants()[MIDDLE].ok_or("the backbone ends in the middle")?;
    Ok([middle.curvature, middle.twist])
}

/// κ and τ of least energy per length under a tendon that turns at the rate α.
fn helical(turning: f64) -> [f64; 2] {
    let (mut bent, mut twisted) = (0.0, 0.0);
    for _ in 0..200 {
        let along = 1.0 - OFFSET * bent;
        let around = OFFSET * (twisted + turning);
        let stretch = libm::hypot(along, around);
        bent = TENSION * OFFSET * along / (stretch * BENDING);
        twisted = -TENSION * OFFSET * around / (stretch * TWISTING);
    }
    [bent, twisted]
}

fn movable_pulley() -> Result<Check, GroupError> {
    // Each weight carries a light rod.
    let rod = 1000.0 * PI * 1e-6 * 0.02;
    let [one, two] = [0.3 + rod, 0.1 + rod];
    let down = GRAVITY * (one - 2.0 * two) / (one + 4.0 * two);
    let tension = two * (GRAVITY + 2.0 * down);
    let rest_length = 4.0 / (1.0 + tension / 1e4);
    let text = include_str!("scenes/movable_pulley.toml");
    let mut simulation = simulation(text, &[format!("parameters.rest_length={rest_length:?}")])?;
    let end = 0.3;
    run_until(&mut simulation, end)?;
    let found = -simulation.velocities()[0].z / end;
    Ok(PULLEY
        .of("weight on a movable pulley: acceleration", "m/s²")
        .relative(down, found, 1e-5))
}

/// Pull of a winch that takes in at a rate, m/s.
fn winch(name: &str, rate: f64) -> Result<Check, GroupError> {
    let (friction, stiffness) = (0.15, 500.0);
    let weight = GRAVITY * (0.2 + 1000.0 * PI * 1e-6 * 0.02);
    // At the start each part carries half of it.
    let rest_length = 2.0 / (1.0 + 0.5 * weight / stiffness);
    let set = [
        format!("parameters.rest_length={rest_length:?}"),
        format!("parameters.rate={rate:?}"),
    ];
    let mut simulation = simulation(include_str!("scenes/winch_with_friction.toml"), &set)?;
    run_until(&mut simulation, 2.0)?;
    let ratio = libm::exp(-friction * PI * rate.signum());
    let found = simulation.tendon_tension(0);
    Ok(WINCH
        .of(name, "N")
        .relative(weight / (1.0 + ratio), found, 1e-4))
}
