//! Vibrations of a rod of a lossy material, from a scenario file.

use super::theory::beam::cantilever_wave_number;
use super::{Check, Expectation, GroupError};
use crate::experiment;
use crate::mechanics::dynamics::Simulation;
use std::f64::consts::TAU;
use std::path::Path;

const LOSS: Expectation = Expectation {
    formula: "tan δ = ω η/E = 2ζ, ζ = Δ/√(4π² + Δ²)",
    source: "Kelvin–Voigt solid, Euler–Bernoulli",
};
/// Speed of axial waves √(E/ρ) in the rod of the file, m/s, and its radius of gyration √(I/A), m.
const AXIAL_SPEED: f64 = 1000.0;
const GYRATION: f64 = 5e-3;
/// Loss factor of its material at 1 Hz.
const LOSS_FACTOR: f64 = 0.02;
/// By then the higher modes, which are damped more, are gone, s.
const START: f64 = 1.0;
const END: f64 = 3.0;

/// Loss factor from the logarithmic decrement Δ of a cantilever that swings in its first mode.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let text = include_str!("scenes/damped_cantilever.toml");
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
    let ratio = decrement / libm::hypot(TAU, decrement);
    let frequency = cantilever_wave_number(1).powi(2) * GYRATION * AXIAL_SPEED / TAU;
    Ok(vec![LOSS.relative(
        "cantilever, 30 edges, first mode: loss factor from its decrement",
        "",
        LOSS_FACTOR * frequency,
        2.0 * ratio,
        0.01,
    )])
}

/// Height of the parabola through three heights, where the middle one is the largest.
fn peak([before, here, after]: [f64; 3]) -> Option<f64> {
    let bend = before - 2.0 * here + after;
    let slope = 0.5 * (after - before);
    (here > before && here >= after).then(|| here - 0.5 * slope * slope / bend)
}
