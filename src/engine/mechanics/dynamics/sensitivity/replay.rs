//! Repetition of another simulation's step: the stage is the same, but the solution is given.

use super::error::SensitivityError;
use crate::mechanics::contact::ActiveLaw;
use crate::mechanics::dynamics::report::{Exchange, SimulationError};
use crate::mechanics::dynamics::scheme::{Prediction, TimeScheme};
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::dynamics::state::State;
use crate::mechanics::system::{Stage, System, WholeMatrix};

/// Largest ratio of residual to tolerance for which a repeated step counts as the same: Newton's
/// method may end with changes in the last digits.
const SAME: f64 = 1e3;
/// Relative change of the contact stiffness between neighbours from which on it counts as a
/// switch: at a switch it doubles or halves.
const SWITCH: f64 = 0.1;

/// A step of the simulation, repeated by the centre: its Newton matrix is factored.
pub(in crate::mechanics::dynamics) struct Replayed {
    /// Time at the end of the step, s.
    pub goal: f64,
    /// Size, s.
    pub step: f64,
    /// Unknowns at the end of the stage.
    pub solution: Vec<f64>,
    /// Its Jacobian.
    pub jacobian: WholeMatrix,
    /// The residual at the end of the stage; at held unknowns the reactions.
    pub residual: Vec<f64>,
    /// Frames whose rotation vectors are reset at the end.
    pub long: Vec<usize>,
    /// Contact stiffness k, and its ratio to that from the forces at the prediction.
    stiffness: f64,
    pub stiffening: f64,
    /// Contact stiffness before the forces at the prediction, and with these forces.
    pub adaption: [f64; 2],
}

/// The end of a step that was taken.
pub(in crate::mechanics::dynamics) struct Taken<'a> {
    /// s.
    pub time: f64,
    /// Unknowns, before rotation vectors were reset and joints broke.
    pub unknowns: &'a [f64],
    /// Contact stiffness k.
    pub contact_stiffness: f64,
    /// Contacts that press by complementarity.
    pub pressing: Vec<ActiveLaw>,
}

impl<'a> Taken<'a> {
    /// The last step of a simulation.
    pub(super) fn last_of(simulation: &'a Simulation) -> Self {
        Self {
            time: simulation.state.time,
            unknowns: &simulation.integrator.workspace.trial.unknowns,
            contact_stiffness: simulation.system.contact_stiffness(),
            pressing: simulation.system.pressing(),
        }
    }
}

impl Replayed {
    /// Repeats a step with `centre`, which is at the start of the step.
    ///
    /// # Errors
    /// [`SensitivityError`] if the residual differs, or the matrix is singular.
    pub(in crate::mechanics::dynamics) fn new(
        taken: &Taken<'_>,
        centre: &mut Simulation,
    ) -> Result<Self, SensitivityError> {
        Self::with(taken, centre, System::linearize_whole)
    }

    /// Repeats a step with the transposed Jacobian, for adjoints.
    ///
    /// # Errors
    /// The same.
    pub(in crate::mechanics::dynamics) fn transposed(
        taken: &Taken<'_>,
        centre: &mut Simulation,
    ) -> Result<Self, SensitivityError> {
        Self::with(taken, centre, System::linearize_transposed)
    }

    fn with(
        taken: &Taken<'_>,
        centre: &mut Simulation,
        linearize: fn(&mut System, &[f64], Option<&Stage>) -> WholeMatrix,
    ) -> Result<Self, SensitivityError> {
        let goal = taken.time;
        let step = goal - centre.state.time;
        let before = centre.system.contact_stiffness();
        centre.begin_like(goal)?;
        let adapted = centre.system.contact_stiffness();
        let used = taken.contact_stiffness;
        let setting = centre.integrator.setting;
        let extrapolates = centre.rules().extrapolates();
        let workspace = &mut centre.integrator.workspace;
        let solution = &mut workspace.trial.unknowns;
        for (k, own) in solution.iter_mut().enumerate() {
            if !centre.system.assembly.held[k] {
                let end = taken.unknowns[k];
                *own = match extrapolates {
                    true => 0.5 * (end + centre.state.unknowns[k]),
                    false => end,
                };
            }
        }
        let system = &mut centre.system;
        system.complete(solution);
        let solution = solution.clone();
        system.restore_contact_stiffness(used);
        if !system.candidates_are_complete(&solution) {
            system.update_candidates(&solution);
        }
        let tolerance = setting.parameters.force_tolerance;
        system.set_tolerances(tolerance, &centre.state.unknowns, Some(&workspace.stage));
        if system.has_constraints() {
            let pressing = taken.pressing.clone();
            let set = system.set_active_laws(pressing, &solution, &workspace.stage);
            set.map_err(|reason| SensitivityError::NotRepeated { time: goal, reason })?;
        }
        let jacobian = linearize(system, &solution, Some(&workspace.stage));
        if centre.integrator.fluid.must_be_coupled() {
            return Err(SensitivityError::NotRepeated {
                time: goal,
                reason: "its drag is found by iteration, because inertia is small compared with \
                    the drag",
            });
        }
        // Written so that NaN does not pass.
        let is_same = system.imbalance().ratio <= SAME;
        if !is_same {
            return Err(SensitivityError::NotRepeated {
                time: goal,
                reason: "its result depends on the iterations that led to it",
            });
        }
        let factored = system.factor();
        factored.map_err(|_| SensitivityError::Singular { time: goal })?;
        Ok(Self {
            goal,
            step,
            solution,
            jacobian,
            residual: system.residual.clone(),
            long: system.long_rotations(taken.unknowns),
            stiffness: used,
            stiffening: if adapted > 0.0 { used / adapted } else { 1.0 },
            adaption: [before, adapted],
        })
    }

    /// Whether forces at the prediction changed the contact stiffness.
    pub(in crate::mechanics::dynamics) fn adapts(&self) -> bool {
        let [before, adapted] = self.adaption;
        adapted != before
    }

    /// Sets the contact stiffness of a neighbour, which was `before` ahead of its step, by the
    /// rule of the simulation.
    ///
    /// # Errors
    /// [`SensitivityError::NotRepeated`] if the neighbour's forces switch to another stiffness
    /// than those of the simulation.
    pub(super) fn stiffen(
        &self,
        neighbour: &mut Simulation,
        before: f64,
    ) -> Result<(), SensitivityError> {
        let system = &mut neighbour.system;
        let adapted = match self.adapts() {
            true => system.contact_stiffness(),
            false => before,
        };
        let stiffness = self.stiffening * adapted;
        if (stiffness - self.stiffness).abs() > SWITCH * self.stiffness {
            return Err(SensitivityError::NotRepeated {
                time: self.goal,
                reason: "the contact stiffness changes in it",
            });
        }
        system.restore_contact_stiffness(stiffness);
        Ok(())
    }
}

impl Simulation {
    /// The rules of the scheme.
    pub(in crate::mechanics::dynamics) fn rules(&self) -> &'static dyn TimeScheme {
        self.integrator.setting.parameters.scheme.rules()
    }

    /// Begins a step to `goal` up to its prediction, with the contact stiffness for it.
    ///
    /// # Errors
    /// If a rod reaches a position at which the drag is not defined.
    pub(super) fn begin_like(&mut self, goal: f64) -> Result<(), SimulationError> {
        let extrapolates = self.rules().extrapolates();
        let Self {
            system,
            state,
            integrator,
            ..
        } = self;
        let (setting, workspace) = (integrator.setting, &mut integrator.workspace);
        system.begin_damping(&state.unknowns);
        system.update_candidates(&state.unknowns);
        system.note_start(&state.unknowns, extrapolates);
        let prepared = workspace.prepare(&setting, system, &mut integrator.fluid, state, goal);
        prepared.map_err(|error| {
            SimulationError::Unphysical(format!("at t = {:.6e} s {error}", state.time))
        })?;
        workspace.adapt_contact_stiffness(&setting, system, state);
        system.abandon_multipliers();
        Ok(())
    }

    /// Start and velocity of the stage for this simulation in the state of `other`.
    pub(super) fn stage_from(&self, other: &Self, step: f64) -> Stage {
        let mut stage = self.integrator.workspace.stage.clone();
        let mut prediction = Prediction {
            unknowns: stage.start.clone(),
            velocity: stage.velocity.clone(),
        };
        let turning = self.system.assembly.steady_turning();
        let (positions, angles) = (stage.positions.clone(), stage.angles.clone());
        let rules = self.rules();
        rules.begin(step, &other.state, turning, &mut stage, &mut prediction);
        // Friction acts on slips from the previous positions of the nodes and edges of this
        // simulation.
        (stage.positions, stage.angles) = (positions, angles);
        stage
    }

    /// Moves to the end of the stage at `trial`, then to the end of the step; stores the unknowns
    /// of both in the workspace.
    ///
    /// # Errors
    /// [`SensitivityError::NotRepeated`] if the end of a step is behind a contact.
    pub(super) fn end_like(&mut self, goal: f64, trial: &[f64]) -> Result<(), SensitivityError> {
        let extrapolates = self.rules().extrapolates();
        let (system, workspace) = (&mut self.system, &mut self.integrator.workspace);
        if !system.candidates_are_complete(trial) {
            system.update_candidates(trial);
        }
        workspace.trial.unknowns.copy_from_slice(trial);
        system.evaluate(trial, Some(&workspace.stage));
        if extrapolates {
            let ended = workspace.extrapolate(system, &self.state, goal, 0);
            ended.map_err(|_| SensitivityError::NotRepeated {
                time: goal,
                reason: "a contact is crossed",
            })?;
        }
        Ok(())
    }

    /// Accepts the step that ends in the workspace, with a velocity, and resets the rotation
    /// vectors of some frames; returns the work and losses of the step.
    pub(super) fn accept_like(
        &mut self,
        goal: f64,
        long: &[usize],
        velocity: impl Fn(usize) -> f64,
    ) -> Exchange {
        let scheme = self.integrator.setting.parameters.scheme;
        let Self {
            system,
            state,
            integrator,
            ..
        } = self;
        let next = integrator.workspace.next_velocity.iter_mut();
        next.enumerate().for_each(|(k, next)| *next = velocity(k));
        let exchange = integrator.accepted(system, state, goal, scheme).exchange();
        integrator.accept(system, state, goal);
        system.begin_rotations_anew(long, &mut state.motions());
        self.publish();
        exchange
    }

    /// Forgets the steps before, if `base` has after its last step.
    pub(super) fn cut_like(&mut self, base: &Self) {
        if base.integrator.is_cut {
            self.state.history.cut();
        }
    }

    /// Ends the step of this simulation at the end of that of `base`.
    ///
    /// # Errors
    /// The errors of [`Self::end_like`].
    pub(super) fn finish_like(
        &mut self,
        base: &Self,
        replayed: &Replayed,
    ) -> Result<(), SensitivityError> {
        self.end_like(replayed.goal, &replayed.solution)?;
        let taken = &base.integrator.workspace;
        let end = &mut self.integrator.workspace.trial.unknowns;
        end.copy_from_slice(&taken.trial.unknowns);
        self.system.update_geometry(end);
        self.accept_like(replayed.goal, &replayed.long, |k| taken.next_velocity[k]);
        self.cut_like(base);
        Ok(())
    }

    /// Breaks the joints that broke in `base` at the end of its step; returns whether there are any.
    pub(super) fn break_like(&mut self, base: &Self) -> bool {
        let State {
            unknowns, velocity, ..
        } = &mut self.state;
        let breaks = self.system.break_like(&base.breaks(), unknowns, velocity);
        if breaks {
            self.begin_anew();
        }
        breaks
    }

    /// Copies the frames of `base` in its equilibrium and evaluates residual and Jacobian there.
    /// Frames held by clamps are those of this simulation.
    pub(in crate::mechanics::dynamics) fn settle_like(&mut self, base: &Self) -> WholeMatrix {
        let (system, unknowns) = (&mut self.system, &mut self.state.unknowns);
        unknowns.copy_from_slice(&base.state.unknowns);
        self.state.time = base.state.time;
        system.resume(base.state.time, unknowns, &base.system.reference);
        system.drive(base.state.time, unknowns);
        system.update_candidates(unknowns);
        system.restore_contact_stiffness(base.system.contact_stiffness());
        system.abandon_multipliers();
        system.linearize_whole(unknowns, None)
    }

    /// Sets the state to rest at the present unknowns, as in an equilibrium.
    pub(super) fn rest_here(&mut self) {
        let unknowns = self.state.unknowns.clone();
        self.system.evaluate(&unknowns, None);
        self.system.commit_frames();
        self.state.rest_at(&unknowns);
        self.publish();
    }

    /// Sets the reactions at held unknowns, from those of the simulation itself and their
    /// derivative times a step.
    pub(super) fn take_reactions(&mut self, of: &[f64], change: &[f64], step: f64) {
        let own = self.system.residual.iter_mut();
        for ((own, of), change) in own.zip(of).zip(change) {
            *own = of + step * change;
        }
    }

    /// Rests where `base` does.
    pub(super) fn rest_like(&mut self, base: &Self) {
        self.state.unknowns.copy_from_slice(&base.state.unknowns);
        self.rest_here();
    }
}
