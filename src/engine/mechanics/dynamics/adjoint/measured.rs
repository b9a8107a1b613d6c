//! Derivatives of results over the state at which they are measured, by differences: results are functions of few numbers of it each,
//! and have no derivatives of their own.

use super::covector::Covector;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::STRIDE;

/// Change of a position over the length of the shortest edge, of an angle, and of a velocity over the largest one: truncation and
/// rounding errors are both about 1e-10.
const RELATIVE_STEP: f64 = 1e-5;
/// Velocity of a motion at rest that is changed by the part above, m/s and rad/s.
const SLOW: f64 = 1e-3;

/// Derivatives of results over the state of a simulation.
pub(super) fn derivatives(
    simulation: &mut Simulation,
    results: &dyn Fn(&Simulation) -> Vec<f64>,
) -> Vec<Covector> {
    let mut covectors = vec![Covector::zero(simulation); results(simulation).len()];
    let edges = simulation.system.assembly.rods.edges.iter();
    let shortest = edges
        .map(|edge| edge.natural_length)
        .fold(f64::INFINITY, f64::min);
    let fastest = simulation.state.velocity.iter();
    let fastest = fastest.fold(SLOW, |sum, speed| sum.max(speed.abs()));
    for k in 0..simulation.state.unknowns.len() {
        if simulation.system.assembly.held[k] {
            continue;
        }
        let is_angle = k % STRIDE == 3;
        let step = RELATIVE_STEP * if is_angle { 1.0 } else { shortest };
        let over = difference(simulation, step, results, |simulation, step| {
            simulation.state.unknowns[k] += step;
            simulation
                .system
                .update_geometry(&simulation.state.unknowns);
        });
        for (covector, derivative) in covectors.iter_mut().zip(over) {
            covector.unknowns[0][k] = derivative;
            if is_angle {
                // The material frame turns by the angle and with the frame that it counts from.
                covector.spins[k / STRIDE] = derivative;
            }
        }
        let step = RELATIVE_STEP * fastest;
        let over = difference(simulation, step, results, |simulation, step| {
            simulation.state.velocity[k] += step;
        });
        for (covector, derivative) in covectors.iter_mut().zip(over) {
            covector.velocities[0][k] = derivative;
        }
    }
    simulation.publish();
    covectors
}

/// Central difference of the results over a number that `change` changes.
fn difference(
    simulation: &mut Simulation,
    step: f64,
    results: &dyn Fn(&Simulation) -> Vec<f64>,
    change: impl Fn(&mut Simulation, f64),
) -> Vec<f64> {
    let mut at = |by: f64| {
        let before = (
            simulation.state.unknowns.clone(),
            simulation.state.velocity.clone(),
        );
        change(simulation, by);
        simulation.publish();
        let found = results(simulation);
        (simulation.state.unknowns, simulation.state.velocity) = before;
        found
    };
    let (plus, minus) = (at(step), at(-step));
    let pairs = plus.iter().zip(&minus);
    pairs
        .map(|(plus, minus)| (plus - minus) / (2.0 * step))
        .collect()
}
