//! Weights with which a scheme combines the last steps: the scheme is linear, and the same for
//! every unknown.

use crate::mechanics::dynamics::history::LENGTH;
use crate::mechanics::dynamics::scheme::Prediction;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::dynamics::state::State;

/// Number of unknowns, or velocities, from which a step starts: those at present and at the last
/// steps.
pub(super) const MOTIONS: usize = 1 + LENGTH;

/// Weights of the unknowns and of the velocities, the latest first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Weights {
    pub unknowns: [f64; MOTIONS],
    pub velocities: [f64; MOTIONS],
}

/// Weights for the start of a stage, the velocity there, and the prediction of its solution.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HistoryWeights {
    pub start: Weights,
    pub velocity: Weights,
    pub prediction: Weights,
}

impl HistoryWeights {
    /// Weights for a step (s) from the state of a simulation, from the stages of motions in which
    /// one value is 1.
    pub(super) fn of(simulation: &Simulation, step: f64) -> Self {
        let zero = vec![0.0; 2 * MOTIONS];
        let mut state = State::new(&zero, &zero);
        let steps = state.history.steps.iter_mut();
        for (own, past) in steps.zip(&simulation.state.history.steps) {
            own.size = past.size;
        }
        for (index, [unknowns, velocity]) in state.motions().into_iter().enumerate() {
            unknowns[index] = 1.0;
            velocity[MOTIONS + index] = 1.0;
        }
        let mut stage = simulation.integrator.workspace.stage.clone();
        stage.start.clone_from(&zero);
        stage.velocity.clone_from(&zero);
        stage.positions.clear();
        let mut prediction = Prediction {
            unknowns: zero.clone(),
            velocity: zero,
        };
        let turning = simulation.system.assembly.steady_turning();
        let rules = simulation.rules();
        rules.begin(step, &state, turning, &mut stage, &mut prediction);
        let of = |all: &[f64]| Weights {
            unknowns: std::array::from_fn(|index| all[index]),
            velocities: std::array::from_fn(|index| all[MOTIONS + index]),
        };
        Self {
            start: of(&stage.start),
            velocity: of(&stage.velocity),
            prediction: of(&prediction.unknowns),
        }
    }
}
