//! One parameter: its neighbours, and the derivative of the state of motion.

use super::error::SensitivityError;
use super::replay::Replayed;
use super::variation::Variation;
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::parameters::IntegrationParameters;
use crate::mechanics::dynamics::report::Exchange;
use crate::mechanics::dynamics::scheme::{Prediction, SolvedStep};
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::dynamics::state::State;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::system::{Stage, WholeMatrix, copy_positions};

const OTHER_SHAPE: SensitivityError = SensitivityError::Unsuitable(
    "a parameter of derivatives must not change the numbers of rods, nodes and clamps",
);

/// A parameter.
pub(super) struct Parameter {
    /// ε.
    pub step: f64,
    /// The simulations with p + ε and p − ε.
    pub neighbours: [Simulation; 2],
    /// Work and losses of the neighbours in their last step.
    pub exchanges: [Exchange; 2],
    /// Amplitude; see [`super::Sensitivity::amplitude`].
    pub amplitude: f64,
    /// Derivatives of unknowns and velocities, now and at the starts of the last steps.
    state: State,
}

/// Signs of ε of the neighbours.
const SIGNS: [f64; 2] = [1.0, -1.0];

impl Parameter {
    /// Creates the neighbours at the start of the motion.
    ///
    /// # Errors
    /// [`SensitivityError`] for neighbours with another structure, or invalid ones.
    pub(super) fn new(
        variation: &Variation,
        parameters: &IntegrationParameters,
        base: &Simulation,
    ) -> Result<Self, SensitivityError> {
        let [plus, minus] = &variation.scenes;
        let neighbours = [
            super::sharp(plus, parameters)?,
            super::sharp(minus, parameters)?,
        ];
        let is_like = |one: &Simulation| {
            one.state.unknowns.len() == base.state.unknowns.len()
                && one.system.assembly.held == base.system.assembly.held
                && one.system.ghosts.len() == base.system.ghosts.len()
                && one.system.assembly.drives.len() == base.system.assembly.drives.len()
                && one.system.assembly.joints.frames.len()
                    == base.system.assembly.joints.frames.len()
                && one.breaks().len() == base.breaks().len()
        };
        if !neighbours.iter().all(is_like) {
            return Err(OTHER_SHAPE);
        }
        let difference = |of: fn(&Simulation) -> &[f64]| {
            let [plus, minus] = [of(&neighbours[0]), of(&neighbours[1])];
            let pairs = plus.iter().zip(minus);
            let rates = pairs.map(|(plus, minus)| (plus - minus) / (2.0 * variation.step));
            rates.collect::<Vec<f64>>()
        };
        let unknowns = difference(|one| &one.state.unknowns);
        let velocity = difference(|one| &one.state.velocity);
        let mut parameter = Self {
            step: variation.step,
            state: State::new(&unknowns, &velocity),
            exchanges: [Exchange::default(); 2],
            amplitude: 0.0,
            neighbours,
        };
        parameter.measure_amplitude(base);
        Ok(parameter)
    }

    /// Takes the step that `centre` has repeated from the simulation.
    ///
    /// # Errors
    /// [`SensitivityError::NotRepeated`], or a drag that is not defined.
    pub(super) fn step(
        &mut self,
        replayed: &Replayed,
        base: &Simulation,
        centre: &mut Simulation,
    ) -> Result<(), SensitivityError> {
        let (step, goal) = (replayed.step, replayed.goal);
        let rules = centre.rules();
        let turning = centre.system.assembly.steady_turning();
        // The stage of the derivatives: schemes are linear.
        let mut stage = centre.integrator.workspace.stage.clone();
        let mut prediction = Prediction {
            unknowns: self.state.unknowns.clone(),
            velocity: self.state.velocity.clone(),
        };
        rules.begin(step, &self.state, turning, &mut stage, &mut prediction);
        let mut right_hand_side = Self::motion_forces(&stage, &replayed.solution, centre);
        let mut velocity = vec![0.0; right_hand_side.len()];
        let mut explicit = vec![0.0; right_hand_side.len()];
        for (neighbour, sign) in self.neighbours.iter_mut().zip(SIGNS) {
            let weight = sign / (2.0 * self.step);
            let before = neighbour.system.contact_stiffness();
            neighbour.begin_like(goal)?;
            replayed.stiffen(neighbour, before)?;
            neighbour.system.share_active_laws(&centre.system);
            let from = neighbour.stage_from(centre, step);
            let mut at = replayed.solution.clone();
            let held = &neighbour.system.assembly.held;
            let prescribed = &neighbour.integrator.workspace.trial.unknowns;
            for k in (0..at.len()).filter(|&k| held[k]) {
                at[k] = prescribed[k];
            }
            neighbour.system.complete(&mut at);
            for (explicit, at) in explicit.iter_mut().zip(&at) {
                *explicit += weight * at;
            }
            if !neighbour.system.candidates_are_complete(&at) {
                neighbour.system.update_candidates(&at);
            }
            neighbour.system.evaluate(&at, Some(&from));
            for (sum, residual) in right_hand_side.iter_mut().zip(&neighbour.system.residual) {
                *sum += weight * residual;
            }
            neighbour.add_velocity(weight, centre, base, &from, step, &mut velocity);
        }
        let mut change = self.solve(&right_hand_side, centre, goal)?;
        (centre.system).spread_change(&replayed.solution, &explicit, &mut change);
        let mut reactions = replayed.jacobian.multiply(&change);
        centre.system.gather_product(&change, &mut reactions);
        let reactions = sum(right_hand_side, &reactions);
        for (neighbour, sign) in self.neighbours.iter_mut().zip(SIGNS) {
            let away = sign * self.step;
            let trial = neighbour.along(&replayed.solution, &change, away);
            neighbour.end_like(goal, &trial)?;
            neighbour.take_reactions(&replayed.residual, &reactions, away);
        }
        if rules.extrapolates() {
            let ends = self.state.unknowns.iter();
            let ends = change
                .iter()
                .zip(ends)
                .map(|(middle, start)| 2.0 * middle - start);
            change = ends.collect();
            self.take_prescribed(&mut change);
        }
        let solved = SolvedStep {
            step,
            state: &self.state,
            stage: &stage,
            end: &change,
            predicted_velocity: &prediction.velocity,
            held: &centre.system.assembly.held,
        };
        let mut own = vec![0.0; velocity.len()];
        rules.finish(&solved, &mut own);
        for (own, explicit) in own.iter_mut().zip(&velocity) {
            *own += explicit;
        }
        for (index, sign) in SIGNS.into_iter().enumerate() {
            let neighbour = &mut self.neighbours[index];
            let away = sign * self.step;
            let next = |k: usize| base.integrator.workspace.next_velocity[k] + away * own[k];
            self.exchanges[index] = neighbour.accept_like(goal, &replayed.long, next);
            neighbour.cut_like(base);
        }
        self.state.advance_to(goal, &change, &own);
        if base.integrator.is_cut {
            self.state.history.cut();
        }
        if !replayed.long.is_empty() {
            self.take_rotations();
        }
        self.measure_amplitude(base);
        Ok(())
    }

    /// Breaks the joints that broke in `base` at the end of its step.
    pub(super) fn break_like(&mut self, base: &Simulation) {
        for neighbour in &mut self.neighbours {
            neighbour.break_like(base);
        }
        self.take_rotations();
        self.state.begin_anew();
    }

    /// Copies the derivatives of the rotation vectors of frames and of their velocities, present
    /// and earlier, from the neighbours.
    fn take_rotations(&mut self) {
        let [plus, minus] = &mut self.neighbours;
        let frames = &plus.system.assembly.joints.frames;
        let places = frames.iter().map(|frame| frame.first_unknown);
        let places: Vec<usize> = places.flat_map(|first| first..first + STRIDE).collect();
        let motions = (self.state.motions().into_iter())
            .zip(plus.state.motions())
            .zip(minus.state.motions());
        for ((own, plus), minus) in motions {
            for ((own, plus), minus) in own.into_iter().zip(plus).zip(minus) {
                for &k in &places {
                    own[k] = (plus[k] - minus[k]) / (2.0 * self.step);
                }
            }
        }
    }

    /// Moves to the equilibrium of `base`, at which the matrix of `centre` is factored.
    ///
    /// # Errors
    /// [`SensitivityError::Singular`].
    pub(super) fn settle(
        &mut self,
        base: &Simulation,
        centre: &mut Simulation,
        jacobian: &WholeMatrix,
    ) -> Result<(), SensitivityError> {
        let mut right_hand_side = vec![0.0; base.state.unknowns.len()];
        let mut explicit = right_hand_side.clone();
        for (neighbour, sign) in self.neighbours.iter_mut().zip(SIGNS) {
            neighbour.settle_like(base);
            let weight = sign / (2.0 * self.step);
            for (sum, residual) in right_hand_side.iter_mut().zip(&neighbour.system.residual) {
                *sum += weight * residual;
            }
            let at = &neighbour.state.unknowns;
            for (explicit, at) in explicit.iter_mut().zip(at) {
                *explicit += weight * at;
            }
            let prescribed = &mut neighbour.integrator.workspace.trial.unknowns;
            prescribed.copy_from_slice(at);
        }
        let mut change = self.solve(&right_hand_side, centre, base.state.time)?;
        (centre.system).spread_change(&base.state.unknowns, &explicit, &mut change);
        let mut reactions = jacobian.multiply(&change);
        centre.system.gather_product(&change, &mut reactions);
        let reactions = sum(right_hand_side, &reactions);
        for (neighbour, sign) in self.neighbours.iter_mut().zip(SIGNS) {
            let away = sign * self.step;
            let rest = neighbour.along(&base.state.unknowns, &change, away);
            neighbour.state.unknowns.copy_from_slice(&rest);
            neighbour.rest_here();
            neighbour.take_reactions(&centre.system.residual, &reactions, away);
        }
        self.state.rest_at(&change);
        self.state.time = base.state.time;
        self.measure_amplitude(base);
        Ok(())
    }

    /// Solves for the derivatives of the unknowns; those of prescribed unknowns come from the
    /// neighbours.
    fn solve(
        &self,
        right_hand_side: &[f64],
        centre: &mut Simulation,
        time: f64,
    ) -> Result<Vec<f64>, SensitivityError> {
        let mut change: Vec<f64> = right_hand_side.iter().map(|entry| -entry).collect();
        let solved = centre.system.solve(&mut change);
        if solved.is_err() || !change.iter().all(|entry| entry.is_finite()) {
            return Err(SensitivityError::Singular { time });
        }
        self.take_prescribed(&mut change);
        Ok(change)
    }

    /// Sets the derivatives of prescribed unknowns from the workspaces of the neighbours.
    fn take_prescribed(&self, change: &mut [f64]) {
        let [plus, minus] = &self.neighbours;
        let held = &plus.system.assembly.held;
        let [plus, minus] =
            [plus, minus].map(|neighbour| &neighbour.integrator.workspace.trial.unknowns);
        for k in (0..change.len()).filter(|&k| held[k]) {
            change[k] = (plus[k] - minus[k]) / (2.0 * self.step);
        }
    }

    /// Derivative of inertia and drag with respect to the start of the stage and the velocity
    /// there, at the solution of the stage.
    fn motion_forces(stage: &Stage, solution: &[f64], centre: &mut Simulation) -> Vec<f64> {
        // The drag of the fluid at the start of the step differs between the neighbours.
        let stage = stage.without_drag();
        let at_rest = vec![0.0; stage.start.len()];
        let mut forces = at_rest.clone();
        let system = &mut centre.system;
        system.add_motion_forces(&at_rest, &stage, &mut forces);
        let solved = &centre.integrator.workspace.stage;
        let changes = [&stage.start[..], &stage.velocity];
        system.add_start_forces(solution, solved, changes, &mut forces);
        system.gather_changes(solution, &mut forces);
        forces
    }

    /// Updates the largest amplitude.
    fn measure_amplitude(&mut self, base: &Simulation) {
        let rods = &base.system.assembly.rods;
        for edge in &rods.edges {
            let unknowns = &self.state.unknowns;
            let moved = position(unknowns, edge.end) - position(unknowns, edge.start);
            let turn = moved.norm() / edge.natural_length;
            self.amplitude = self.amplitude.max(turn * self.step);
        }
    }

    /// Derivatives of the positions.
    pub(super) fn positions(&self) -> Vec<Vector3> {
        self.vectors(&self.state.unknowns)
    }

    /// Derivatives of the velocities.
    pub(super) fn velocities(&self) -> Vec<Vector3> {
        self.vectors(&self.state.velocity)
    }

    fn vectors(&self, unknowns: &[f64]) -> Vec<Vector3> {
        let nodes = self.neighbours[0].published.positions.len();
        let mut vectors = vec![Vector3::zeros(); nodes.min(unknowns.len() / STRIDE)];
        copy_positions(unknowns, &mut vectors);
        vectors
    }
}

/// Sum of two vectors.
fn sum(mut one: Vec<f64>, other: &[f64]) -> Vec<f64> {
    one.iter_mut()
        .zip(other)
        .for_each(|(one, other)| *one += other);
    one
}

impl Simulation {
    /// The given unknowns, moved along a derivative; prescribed unknowns are those in the
    /// workspace.
    fn along(&mut self, from: &[f64], change: &[f64], step: f64) -> Vec<f64> {
        let held = &self.system.assembly.held;
        let prescribed = &self.integrator.workspace.trial.unknowns;
        let moved = from.iter().zip(change).enumerate();
        let moved = moved.map(|(k, (from, change))| match held[k] {
            true => prescribed[k],
            false => from + step * change,
        });
        let mut moved: Vec<f64> = moved.collect();
        self.system.complete(&mut moved);
        moved
    }

    /// Adds a weight times the velocity that the scheme of this simulation computes from the step
    /// of `base`: clamps that turn at another speed have other differences.
    fn add_velocity(
        &self,
        weight: f64,
        centre: &Self,
        base: &Self,
        stage: &Stage,
        step: f64,
        velocity: &mut [f64],
    ) {
        let turning = |one: &Self| one.system.assembly.steady_turning();
        if turning(self) == turning(centre) {
            return;
        }
        let solved = SolvedStep {
            step,
            state: &centre.state,
            stage,
            end: &base.state.unknowns,
            predicted_velocity: &base.state.velocity,
            held: &self.system.assembly.held,
        };
        let mut own = vec![0.0; velocity.len()];
        self.rules().finish(&solved, &mut own);
        for (sum, own) in velocity.iter_mut().zip(own) {
            *sum += weight * own;
        }
    }
}
