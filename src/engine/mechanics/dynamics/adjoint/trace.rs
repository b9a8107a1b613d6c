//! The states at the ends of steps: those of the last part of a motion, and those at the starts of
//! its earlier parts.

use super::SensitivityError;
use super::origin::Origin;
use crate::mechanics::contact::{ActiveLaw, ContactMemory};
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
    ends: Vec<End>,
}

/// The end of a step.
pub(super) struct End {
    pub state: SimulationState,
    /// Unknowns before rotation vectors were reset, if they were.
    solution: Option<Vec<f64>>,
    /// Contacts that press by complementarity.
    pub pressing: Vec<ActiveLaw>,
}

impl End {
    /// The end of the last step of a simulation.
    fn of(simulation: &Simulation) -> Self {
        let solution = &simulation.integrator.workspace.trial.unknowns;
        Self {
            solution: (*solution != simulation.state.unknowns).then(|| solution.clone()),
            state: simulation.state(),
            pressing: simulation.system.pressing(),
        }
    }

    /// Unknowns before rotation vectors were reset.
    pub(super) fn solution(&self) -> &[f64] {
        self.solution.as_ref().unwrap_or(&self.state.unknowns)
    }
}

/// A part of a motion.
struct Part {
    /// Where it begins.
    start: SimulationState,
    /// The target times of its steps, s.
    untils: Vec<f64>,
}

/// Callback for a step; the arguments are the state at the start of the step, and its end.
pub(super) type Visit<'a> =
    &'a mut dyn FnMut(&mut Simulation, &SimulationState, &End) -> Result<(), SensitivityError>;

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
        let end = End::of(simulation);
        let each = size(&end.state) + size_of::<ActiveLaw>() * end.pressing.len();
        append(&mut self.ends, report, end);
        if each * self.ends.len() > self.largest
            && let Some(end) = self.ends.pop()
        {
            let next = Part {
                start: end.state,
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
        self.ends.last().map_or(&self.last.start, |end| &end.state)
    }

    /// Visits all steps, the last first, with a simulation in any state.
    pub(super) fn visit_backwards(
        &self,
        simulation: &mut Simulation,
        origin: &Origin,
        visit: Visit<'_>,
    ) -> Result<(), SensitivityError> {
        self.last.visit(&self.ends, simulation, visit)?;
        for part in self.parts.iter().rev() {
            let ends = part.repeat(simulation, origin)?;
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
        origin: &Origin,
    ) -> Result<Vec<End>, SensitivityError> {
        let mut ends = Vec::new();
        origin.restore(simulation, &self.start)?;
        for &until in &self.untils {
            let report = simulation.advance(until)?;
            append(&mut ends, &report, End::of(simulation));
        }
        Ok(ends)
    }

    fn visit(
        &self,
        ends: &[End],
        simulation: &mut Simulation,
        visit: Visit<'_>,
    ) -> Result<(), SensitivityError> {
        for index in (0..ends.len()).rev() {
            let start = match index {
                0 => &self.start,
                _ => &ends[index - 1].state,
            };
            visit(simulation, start, &ends[index])?;
        }
        Ok(())
    }
}

/// Adds the end of a step; if only the time was set, updates the time of the last end.
fn append(ends: &mut Vec<End>, report: &StepReport, end: End) {
    if report.step > 0.0 {
        ends.push(end);
    } else if let Some(last) = ends.last_mut() {
        last.state.time = end.state.time;
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
