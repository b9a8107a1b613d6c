//! Vibrations of a rod of a lossy material, from a scenario file.

use super::theory::beam::cantilever_wave_number;
use super::{Check, Expectation, GroupError};
use nalgebra::Complex;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_lab::experiment;
use std::f64::consts::TAU;
use std::path::Path;

const LOSS: Expectation = Expectation {
    formula: "tan δ = ω η/E = 2ζ, ζ = Δ/√(4π² + Δ²)",
    source: "Kelvin–Voigt solid, Euler–Bernoulli",
};
const RELAXING: Expectation = Expectation {
    formula: "s² + ω₀² (1 + r sτ/(1 + sτ)) = 0, ζ = −Re s/|s|",
    source: "standard linear solid, Euler–Bernoulli",
};
/// Speed of axial waves √(E/ρ) in the rod of the file, m/s, and its radius of gyration √(I/A), m.
const AXIAL_SPEED: f64 = 1000.0;
const GYRATION: f64 = 5e-3;
/// Loss factor of its material at 1 Hz.
const LOSS_FACTOR: f64 = 0.02;
/// By then the higher modes, which are damped more, are gone, s.
const START: f64 = 1.0;
const END: f64 = 3.0;

/// What of its modulus relaxes in the second file, over that which does not, and the relaxation time, s.
const RATIO: f64 = 0.2;
const TIME: f64 = 0.02;

/// Loss factors from the logarithmic decrements of cantilevers that swing in their first mode.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let viscous = damping_ratio(include_str!("scenes/damped_cantilever.toml"))?;
    let relaxing = damping_ratio(include_str!("scenes/relaxing_cantilever.toml"))?;
    let frequency = cantilever_wave_number(1).powi(2) * GYRATION * AXIAL_SPEED;
    let rate = relaxing_mode(frequency);
    Ok(vec![
        LOSS.relative(
            "cantilever, 30 edges, first mode: loss factor from its decrement",
            "",
            LOSS_FACTOR * frequency / TAU,
            2.0 * viscous,
            0.01,
        ),
        RELAXING.relative(
            "cantilever of a standard linear solid, 30 edges, first mode: loss factor from its decrement",
            "",
            -2.0 * rate.re / rate.norm(),
            2.0 * relaxing,
            0.01,
        ),
    ])
}

/// The rate s of a mode that would have the angular frequency ω₀ if nothing relaxed, 1/s: the root near iω₀, by Newton's method.
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

/// Damping ratio ζ = Δ/√(4π² + Δ²) of the first mode of a cantilever in a file, from its decrement Δ.
fn damping_ratio(text: &str) -> Result<f64, GroupError> {
    let loaded = experiment::from_text("scene", text, Path::new(""), &[])?;
    let prepared = experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
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
        return Err("the rod does not swing".into());
    };
    let decrement = libm::log(first / last) / (peaks.len() - 1) as f64;
    Ok(decrement / libm::hypot(TAU, decrement))
}

/// Height of the parabola through three heights, where the middle one is the largest.
fn peak([before, here, after]: [f64; 3]) -> Option<f64> {
    let bend = before - 2.0 * here + after;
    let slope = 0.5 * (after - before);
    (here > before && here >= after).then(|| here - 0.5 * slope * slope / bend)
}
