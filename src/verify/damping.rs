//! Vibrations of a rod of a lossy material, from a scenario file.

use super::scenario::simulation;
use super::theory::beam::cantilever_wave_number;
use super::{Check, Expectation, GroupError};
use nalgebra::Complex;
use std::f64::consts::TAU;

const LOSS: Expectation = Expectation::new(
    "tan δ = ω η/E = 2ζ, ζ = Δ/√(4π² + Δ²)",
    "Kelvin–Voigt solid, Euler–Bernoulli",
);
const RELAXING: Expectation = Expectation::new(
    "s² + ω₀² (1 + r sτ/(1 + sτ)) = 0, ζ = −Re s/|s|",
    "standard linear solid, Euler–Bernoulli",
);
/// Speed of axial waves √(E/ρ) in the rod of the file, m/s.
const AXIAL_SPEED: f64 = 1000.0;
/// Radius of gyration √(I/A) of this rod, m.
const GYRATION: f64 = 5e-3;
/// Loss factor of the material at 1 Hz.
const LOSS_FACTOR: f64 = 0.02;
/// Time after which the more strongly damped higher modes have decayed, s.
const START: f64 = 1.0;
const END: f64 = 3.0;

/// Ratio of the relaxing to the remaining modulus in the second file.
const RATIO: f64 = 0.2;
/// Relaxation time in the second file, s.
const TIME: f64 = 0.02;

/// Loss factors from the logarithmic decrements of cantilevers that swing in their first mode.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let viscous = damping_ratio(["loss_factor=0.02", "loss_frequency=1 Hz"])?;
    let relaxing = damping_ratio(["relaxing_modulus=200 MPa", "relaxation_time=20 ms"])?;
    let frequency = cantilever_wave_number(1).powi(2) * GYRATION * AXIAL_SPEED;
    let rate = relaxing_mode(frequency);
    let loss = LOSS.of(
        "cantilever, 30 edges, first mode: loss factor from its decrement",
        "",
    );
    let name = "cantilever of a standard linear solid, 30 edges, first mode: loss factor from its decrement";
    let (expected, got) = (-2.0 * rate.re / rate.norm(), 2.0 * relaxing);
    Ok(vec![
        loss.relative(LOSS_FACTOR * frequency / TAU, 2.0 * viscous, 0.01),
        RELAXING.of(name, "").relative(expected, got, 0.01),
    ])
}

/// Complex rate s, 1/s, of a mode whose angular frequency would be ω₀ without relaxation: the root
/// near iω₀, by Newton's method.
fn relaxing_mode(frequency: f64) -> Complex<f64> {
    let (one, square) = (Complex::new(1.0, 0.0), frequency * frequency);
    let mut rate = Complex::new(0.0, frequency);
    for _ in 0..20 {
        let relaxed = one + rate * TIME;
        let value = rate * rate + (one + rate * (RATIO * TIME) / relaxed) * square;
        let slope = rate * 2.0 + one * (square * RATIO * TIME) / (relaxed * relaxed);
        rate -= value / slope;
    }
    rate
}

/// Damping ratio ζ = Δ/√(4π² + Δ²) of the first mode of a cantilever with the given keys of the
/// material, from its decrement Δ.
fn damping_ratio(material: [&str; 2]) -> Result<f64, GroupError> {
    let keys = material.map(|key| format!("material.{key}"));
    let mut simulation = simulation(include_str!("scenes/plucked_cantilever.toml"), &keys)?;
    let mut heights = Vec::new();
    while simulation.time() < END {
        simulation.advance(END)?;
        if simulation.time() > START {
            heights.extend(simulation.positions().last().map(|end| end.z));
        }
    }
    let peaks: Vec<f64> = heights
        .windows(3)
        .filter_map(|heights| peak([heights[0], heights[1], heights[2]]))
        .collect();
    let [Some(first), Some(last)] = [peaks.first(), peaks.last()] else {
        return Err("the rod does not oscillate".into());
    };
    let decrement = libm::log(first / last) / (peaks.len() - 1) as f64;
    Ok(decrement / libm::hypot(TAU, decrement))
}

/// Maximum of the parabola through three heights, of which the middle one is the largest.
fn peak([before, here, after]: [f64; 3]) -> Option<f64> {
    let bend = before - 2.0 * here + after;
    let slope = 0.5 * (after - before);
    (here > before && here >= after).then(|| here - 0.5 * slope * slope / bend)
}
