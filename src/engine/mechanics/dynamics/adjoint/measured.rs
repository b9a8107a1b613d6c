//! Derivatives of results with respect to the state at which they are measured, by differences:
//! each result is a function of few variables of the state, without derivatives of its own.

use super::covector::Covector;
use super::differences::Functions;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::STRIDE;

/// Step of a position relative to the length of the shortest edge, step of an angle, and step of a
/// velocity relative to the largest one: truncation and rounding errors are both about 1e-10.
const RELATIVE_STEP: f64 = 1e-5;
/// Velocity that stands for the largest one in a motion at rest, m/s and rad/s.
const SLOW: f64 = 1e-3;

/// Derivatives of results with respect to the state of a simulation.
pub(super) fn derivatives(
    simulation: &mut Simulation,
    results: &dyn Fn(&Simulation) -> Vec<f64>,
) -> Vec<Covector> {
    let edges = simulation.system.assembly.rods.edges.iter();
    let lengths = edges.map(|edge| edge.natural_length);
    let shortest = lengths.fold(f64::INFINITY, f64::min);
    let speeds = simulation.state.velocity.iter();
    let fastest = speeds.fold(SLOW, |largest, speed| largest.max(speed.abs()));
    let unknowns = simulation.state.unknowns.len();
    let held = simulation.system.assembly.held.clone();
    // Tips of bodies follow frames, but their velocities are stored.
    let mut prescribed = held.clone();
    let joints = &simulation.system.assembly.joints;
    joints.of_tips().for_each(|k| prescribed[k] = false);
    let nothing = Covector::zero(simulation);
    let at = [&simulation.state.unknowns[..], &simulation.state.velocity].concat();
    let mut values = |at: &[f64]| {
        let (places, velocities) = at.split_at(unknowns);
        let mut places = places.to_vec();
        simulation.system.complete(&mut places);
        let moves = simulation.state.unknowns != places;
        simulation.state.unknowns.copy_from_slice(&places);
        simulation.state.velocity.copy_from_slice(velocities);
        if moves {
            simulation.system.update_geometry(&places);
        }
        simulation.publish();
        results(simulation)
    };
    // Unknowns, followed by velocities, have consecutive indices.
    let step = |number: usize| {
        RELATIVE_STEP
            * match number.checked_sub(unknowns) {
                Some(own) if prescribed[own] => 0.0,
                Some(_) => fastest,
                None if held[number] => 0.0,
                None if number % STRIDE == 3 => 1.0,
                None => shortest,
            }
    };
    let here = values(&at);
    let mut covectors = vec![nothing; here.len()];
    let mut store = |result: usize, number: usize, derivative: f64| {
        let covector = &mut covectors[result];
        match number.checked_sub(unknowns) {
            Some(number) => covector.velocities[0][number] = derivative,
            None => {
                covector.unknowns[0][number] = derivative;
                if number % STRIDE == 3
                    && let Some(spin) = covector.spins.get_mut(number / STRIDE)
                {
                    // The material frame turns with the angle, and with the frame from which the
                    // angle is measured.
                    *spin = derivative;
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
