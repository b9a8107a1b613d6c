//! The states at the ends of steps: those of the last part of a motion, and those at the starts of
//! its earlier parts.

use super::SensitivityError;
use crate::mechanics::contact::ContactMemory;
use crate::mechanics::dynamics::report::{SimulationState, StepReport};
use crate::mechanics::dynamics::simulation::Simulation;

/// States of a motion, from which its steps can be visited backwards.
pub(super) struct Trace {
    /// Largest total size of the stored states, bytes.
    largest: usize,
    /// Earlier parts, whose steps must be repeated.
    parts: Vec<Part>,
    /// The last part.
    last: Part,
    /// Ends of the steps of the last part.
    ends: Vec<SimulationState>,
}

/// A part of a motion.
struct Part {
    /// Where it begins.
    start: SimulationState,
    /// The target times of its steps, s.
    untils: Vec<f64>,
}

/// Callback for a step, given by the states at its start and end.
pub(super) type Visit<'a> =
    &'a mut dyn FnMut(&mut Simulation, [&SimulationState; 2]) -> Result<(), SensitivityError>;

impl Trace {
    /// Starts a motion at the state of a simulation; up to `largest` bytes are kept.
    pub(super) fn new(simulation: &Simulation, largest: usize) -> Self {
        Self {
            largest,
            parts: Vec::new(),
            last: Part {
                start: simulation.state(),
                untils: Vec::new(),
            },
            ends: Vec::new(),
        }
    }

    /// Largest total size of the stored states, bytes.
    pub(super) fn largest(&self) -> usize {
        self.largest
    }

    /// Adds the step that a simulation has just taken.
    pub(super) fn add(&mut self, simulation: &Simulation, report: &StepReport, until: f64) {
        self.last.untils.push(until);
        let state = simulation.state();
        let each = size(&state);
        append(&mut self.ends, report, state);
        if each * self.ends.len() > self.largest
            && let Some(end) = self.ends.pop()
        {
            let next = Part {
                start: end,
                untils: Vec::new(),
            };
            self.parts.push(std::mem::replace(&mut self.last, next));
            self.ends.clear();
        }
    }

    /// Where the motion starts.
    pub(super) fn first(&self) -> &SimulationState {
        &self.parts.first().unwrap_or(&self.last).start
    }

    /// Where it ends.
    pub(super) fn last(&self) -> &SimulationState {
        self.ends.last().unwrap_or(&self.last.start)
    }

    /// Visits all steps, the last first, with a simulation in any state.
    pub(super) fn visit_backwards(
        &self,
        simulation: &mut Simulation,
        visit: Visit<'_>,
    ) -> Result<(), SensitivityError> {
        self.last.visit(&self.ends, simulation, visit)?;
        for part in self.parts.iter().rev() {
            let ends = part.repeat(simulation)?;
            part.visit(&ends, simulation, visit)?;
        }
        Ok(())
    }
}

impl Part {
    /// Repeats the steps of this part.
    fn repeat(
        &self,
        simulation: &mut Simulation,
    ) -> Result<Vec<SimulationState>, SensitivityError> {
        let mut ends = Vec::new();
        simulation.restore(self.start.clone())?;
        for &until in &self.untils {
            let report = simulation.advance(until)?;
            append(&mut ends, &report, simulation.state());
        }
        Ok(ends)
    }

    fn visit(
        &self,
        ends: &[SimulationState],
        simulation: &mut Simulation,
        visit: Visit<'_>,
    ) -> Result<(), SensitivityError> {
        for index in (0..ends.len()).rev() {
            let start = match index {
                0 => &self.start,
                _ => &ends[index - 1],
            };
            visit(simulation, [start, &ends[index]])?;
        }
        Ok(())
    }
}

/// Adds the end of a step; if only the time was set, updates the time of the last end.
fn append(ends: &mut Vec<SimulationState>, report: &StepReport, state: SimulationState) {
    if report.step > 0.0 {
        ends.push(state);
    } else if let Some(last) = ends.last_mut() {
        last.time = state.time;
    }
}

/// Approximate size of a state, bytes.
fn size(state: &SimulationState) -> usize {
    let motions = 2 * (1 + crate::mechanics::dynamics::history::LENGTH) * state.unknowns.len();
    let frames = 6 * state.reference.tangent.len() + state.reference.twist.len();
    let strains: usize = state.strains.iter().map(Vec::len).sum();
    let of_contact = |contact: &ContactMemory| {
        let of_candidates = contact.normal_forces.len() + 4 * contact.tractions.len();
        3 * contact.candidate_positions.len() + contact.coupled.len() + of_candidates
    };
    let contact = state.contact.as_ref().map_or(0, of_contact);
    size_of::<f64>() * (motions + frames + strains + contact)
}
