//! Derivatives of results over the state at which they are measured, by differences: results are functions of few numbers of it each,
//! and have no derivatives of their own.

use super::covector::Covector;
use super::differences::Functions;
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
    let here = results(simulation);
    let edges = simulation.system.assembly.rods.edges.iter();
    let lengths = edges.map(|edge| edge.natural_length);
    let shortest = lengths.fold(f64::INFINITY, f64::min);
    let speeds = simulation.state.velocity.iter();
    let fastest = speeds.fold(SLOW, |largest, speed| largest.max(speed.abs()));
    let unknowns = simulation.state.unknowns.len();
    let held = simulation.system.assembly.held.clone();
    let mut covectors = vec![Covector::zero(simulation); here.len()];
    let at = [&simulation.state.unknowns[..], &simulation.state.velocity].concat();
    let mut values = |at: &[f64]| {
        let (places, velocities) = at.split_at(unknowns);
        let moves = simulation.state.unknowns != places;
        simulation.state.unknowns.copy_from_slice(places);
        simulation.state.velocity.copy_from_slice(velocities);
        if moves {
            simulation.system.update_geometry(places);
        }
        simulation.publish();
        results(simulation)
    };
    // Unknowns, and then velocities, are numbered in a row.
    let step = |number: usize| {
        RELATIVE_STEP
            * match number.checked_sub(unknowns) {
                _ if held[number % unknowns] => 0.0,
                Some(_) => fastest,
                None if number % STRIDE == 3 => 1.0,
                None => shortest,
            }
    };
    let mut store = |result: usize, number: usize, derivative: f64| {
        let covector = &mut covectors[result];
        match number.checked_sub(unknowns) {
            Some(number) => covector.velocities[0][number] = derivative,
            None => {
                covector.unknowns[0][number] = derivative;
                if number % STRIDE == 3 {
                    // The material frame turns by the angle, and with the frame that this counts from.
                    covector.spins[number / STRIDE] = derivative;
                }
            }
        }
    };
    let mut functions = Functions {
        at: at.clone(),
        here,
        values: &mut values,
        step: &step,
    };
    functions.differentiate(0..unknowns, &mut store);
    functions.differentiate(unknowns..2 * unknowns, &mut store);
    values(&at);
    covectors
}
