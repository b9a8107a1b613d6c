//! A rod that a slowly growing force feeds into a horizontal tube: it snakes and then coils up, with
//! reversals of its sense.

use super::scenario::moved;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::dynamics::Simulation;

const PITCH: Expectation = Expectation::new("k = √(F/2EI)", "Lubinski, Althouse and Logan 1962");
const PRESSURE: Expectation = Expectation::new("n = F² r/4EI", "Mitchell 1986");

/// Force at the end, N; EI, N m²; clearance of the tube, m; time, s.
const FORCE: f64 = 0.124;
const BENDING: f64 = 1e7 * std::f64::consts::PI * 1e-12 / 4.0;
const CLEARANCE: f64 = 1e-3;
const END: f64 = 2.6;
/// Edges per turn of the coil of the theory, to 1 %, and their length, m.
const TURN: usize = 14;
const EDGE: f64 = 5e-3;

/// Checks the wave number and the pressure of the most uniform turn.
pub(super) fn checks() -> Result<[Check; 2], GroupError> {
    let simulation = moved(include_str!("scenes/coil_in_tube.toml"), &[], END)?;
    let [wave_number, pressure] = most_uniform_turn(&simulation);
    let name = "rod pushed into a horizontal tube by 8 √(EI w/r): wave number of the coil";
    let coiled = (FORCE / (2.0 * BENDING)).sqrt();
    let expected = FORCE * FORCE * CLEARANCE / (4.0 * BENDING);
    Ok([
        PITCH.of(name, "1/m").relative(coiled, wave_number, 1e-2),
        PRESSURE
            .of("the same: force of the tube per length of a turn", "N/m")
            .relative(expected, pressure, 2e-2),
    ])
}

/// Wave number (1/m) and force of the tube per length (N/m) of the turn whose angle about the axis
/// of the tube grows most evenly.
fn most_uniform_turn(simulation: &Simulation) -> [f64; 2] {
    let nodes = simulation.positions();
    let rates: Vec<f64> = (nodes.windows(2))
        .map(|ends| {
            let [from, to] = [ends[0], ends[1]];
            let across = from.y * to.z - from.z * to.y;
            libm::atan2(across, from.y * to.y + from.z * to.z) / (to.x - from.x)
        })
        .collect();
    let mut forces = vec![0.0; nodes.len()];
    for touch in simulation.touches() {
        if let Some(node) = touch.nodes[0] {
            forces[node] += touch.normal_force;
        }
    }
    let mut best = (f64::INFINITY, [f64::NAN; 2]);
    // Outside of the sheath.
    let first = nodes.iter().position(|x| x.x > 0.0).unwrap_or_default();
    for start in first..nodes.len() - TURN {
        let turn = &rates[start..start + TURN];
        let mean = turn.iter().sum::<f64>() / TURN as f64;
        let spread = turn
            .iter()
            .map(|rate| (rate - mean).abs())
            .fold(0.0, f64::max);
        if spread < best.0 * mean.abs() {
            let force: f64 = forces[start..start + TURN].iter().sum();
            let values = [mean.abs(), force / (TURN as f64 * EDGE)];
            best = (spread / mean.abs(), values);
        }
    }
    best.1
}
