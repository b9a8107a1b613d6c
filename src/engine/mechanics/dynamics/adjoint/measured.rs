//! Derivatives of results over the state at which they are measured, by differences: results are functions of few numbers of it each,
//! and have no derivatives of their own.
//!
//! The numbers that matter are found by halving: where all numbers of a range change at once and no result does, none of them
//! matters. The place of one node among a thousand takes some tens of evaluations instead of thousands.

use super::covector::Covector;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::STRIDE;
use std::ops::Range;

/// Change of a position over the length of the shortest edge, of an angle, and of a velocity over the largest one: truncation and
/// rounding errors are both about 1e-10.
const RELATIVE_STEP: f64 = 1e-5;
/// Velocity of a motion at rest that is changed by the part above, m/s and rad/s.
const SLOW: f64 = 1e-3;
/// Part of its step by which a number differs in a range, with its number: so that the changes of two do not cancel.
const SPREAD: f64 = 0.618_034;

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
    let mut measurement = Measurement {
        covectors: vec![Covector::zero(simulation); here.len()],
        at: [&simulation.state.unknowns[..], &simulation.state.velocity].concat(),
        held: simulation.system.assembly.held.clone(),
        lengths: [shortest, fastest],
        simulation,
        results,
        here,
    };
    measurement.differentiate(0..unknowns);
    measurement.restore();
    measurement.differentiate(unknowns..2 * unknowns);
    measurement.restore();
    measurement.covectors
}

/// Unknowns, and then velocities, are numbered in a row.
struct Measurement<'a> {
    simulation: &'a mut Simulation,
    results: &'a dyn Fn(&Simulation) -> Vec<f64>,
    /// Results in the state.
    here: Vec<f64>,
    /// The state.
    at: Vec<f64>,
    held: Vec<bool>,
    /// Length of the shortest edge, m, and largest velocity.
    lengths: [f64; 2],
    covectors: Vec<Covector>,
}

impl Measurement<'_> {
    /// Finds the derivatives over the numbers of a range.
    fn differentiate(&mut self, range: Range<usize>) {
        let first = range.start;
        if range.len() == 1 {
            if self.held[first % self.held.len()] {
                return;
            }
            let step = self.step(first);
            let (plus, minus) = (self.after(range.clone(), 1.0), self.after(range, -1.0));
            for (of, (plus, minus)) in plus.iter().zip(&minus).enumerate() {
                self.store(of, first, (plus - minus) / (2.0 * step));
            }
        } else if !range.is_empty() && self.after(range.clone(), SPREAD) != self.here {
            let middle = first + range.len() / 2;
            self.differentiate(first..middle);
            self.differentiate(middle..range.end);
        }
    }

    /// Step of a number.
    fn step(&self, number: usize) -> f64 {
        let [shortest, fastest] = self.lengths;
        RELATIVE_STEP
            * match number.checked_sub(self.held.len()) {
                Some(_) => fastest,
                None if number % STRIDE == 3 => 1.0,
                None => shortest,
            }
    }

    /// Results where the numbers of a range are changed by a part of their steps; of several each by a different one.
    fn after(&mut self, range: Range<usize>, part: f64) -> Vec<f64> {
        let unknowns = self.held.len();
        let apart = if range.len() > 1 { SPREAD } else { 0.0 };
        for number in range.clone() {
            let share = 1.0 + (number as f64 * apart).fract();
            let moved = self.at[number] + part * share * self.step(number);
            self.set(number, moved);
        }
        let state = &self.simulation.state;
        if range.start < unknowns {
            self.simulation.system.update_geometry(&state.unknowns);
        }
        self.simulation.publish();
        let found = (self.results)(self.simulation);
        for number in range {
            self.set(number, self.at[number]);
        }
        found
    }

    /// Geometry and published arrays of the state.
    fn restore(&mut self) {
        let simulation = &mut *self.simulation;
        simulation
            .system
            .update_geometry(&simulation.state.unknowns);
        simulation.publish();
    }

    fn set(&mut self, number: usize, value: f64) {
        let (unknowns, state) = (self.held.len(), &mut self.simulation.state);
        match number.checked_sub(unknowns) {
            Some(number) => state.velocity[number] = value,
            None => state.unknowns[number] = value,
        }
    }

    fn store(&mut self, result: usize, number: usize, derivative: f64) {
        let covector = &mut self.covectors[result];
        match number.checked_sub(self.held.len()) {
            Some(number) => covector.velocities[0][number] = derivative,
            None => {
                covector.unknowns[0][number] = derivative;
                if number % STRIDE == 3 {
                    // The material frame turns by the angle, and with the frame that this counts from.
                    covector.spins[number / STRIDE] = derivative;
                }
            }
        }
    }
}
