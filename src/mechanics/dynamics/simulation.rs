//! A running simulation: owns the state and advances it step by step.

use super::backward_difference::largest_step;
use super::failure::Failure;
use super::history::History;
use super::newton::Newton;
use super::parameters::{IntegrationParameters, Scheme, StepSize};
use super::report::{SimulationError, StepReport};
use super::stage::Attempt;
use super::step_control::{ErrorLaw, StepControl, Verdict};
use crate::mechanics::contact::ActiveContact;
use crate::mechanics::fluid::{Filament, Fluid, FluidModel};
use crate::mechanics::rod::{STRIDE, topology::position};
use crate::mechanics::scene::{Motion, Scene};
use crate::mechanics::system::{Stage, System, copy_positions};
use crate::mechanics::{Matrix3, Vector3};

/// Factor by which the contact stiffness grows when a step ends with too much penetration.
const STIFFENING: f64 = 10.0;
/// Such growths before the step is halved instead.
const STIFFENINGS: usize = 3;

/// Largest growth of automatic steps from one to the next.
const LARGEST_GROWTH: f64 = 1.5;
/// The same for backward differences, which err more where steps grow: two flagella turned from rest are a fifth as far
/// from those of small steps after 2.5 s as with 1.5.
const LARGEST_GROWTH_OF_DIFFERENCES: f64 = 1.1;

/// What rigid contact is for: the midpoint rule would extrapolate through it, and statics has no free motion that
/// contact could prevent.
pub(super) const ONLY_EULER: &str = "contact by complementarity needs time steps of implicit Euler";

/// A scene in motion.
pub struct Simulation {
    pub(super) system: System,
    pub(super) fluid: Option<Fluid>,
    pub(super) parameters: IntegrationParameters,
    pub(super) time: f64,
    pub(super) unknowns: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    /// What the predictor extrapolates from and backward differences go through.
    pub(super) history: History,
    pub(super) control: StepControl,
    pub(super) stage: Stage,
    pub(super) newton: Newton,
    pub(super) trial: Vec<f64>,
    /// Velocity that backward differences expect at the end of a step.
    pub(super) predicted_velocity: Vec<f64>,
    pub(super) next_velocity: Vec<f64>,
    pub(super) positions: Vec<Vector3>,
    pub(super) velocities: Vec<Vector3>,
    pub(super) fluid_forces: Vec<Vector3>,
    pub(super) edge_angles: Vec<f64>,
    pub(super) radius: f64,
}

impl Simulation {
    /// Sets up a simulation at time zero.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] names what is impossible.
    pub fn new(scene: &Scene, parameters: &IntegrationParameters) -> Result<Self, SimulationError> {
        let system = System::new(scene).map_err(SimulationError::BadScene)?;
        if system.has_constraints() && parameters.scheme != Scheme::ImplicitEuler {
            return Err(SimulationError::BadScene(ONLY_EULER.into()));
        }
        let mut parameters = *parameters;
        if parameters.scheme == Scheme::BackwardDifferences {
            let largest = largest_step(system.assembly.steady_turning());
            parameters.step = parameters.step.limited(largest);
        }
        let assembly = &system.assembly;
        let (unknowns, velocity) = (assembly.unknowns.clone(), assembly.velocity.clone());
        let nodes = assembly.rods.nodes;
        let filaments: Vec<Filament> = assembly
            .rods
            .rods
            .iter()
            .zip(&scene.rods)
            .filter(|(_, rod)| !rod.held)
            .map(|(range, rod)| Filament {
                first_node: range.first_node,
                nodes: range.nodes,
                closed: range.closed,
                radius: rod.radius,
            })
            .collect();
        let fluid = scene
            .fluid
            .map(|model| Fluid::new(&model, &filaments))
            .transpose();
        let fluid = fluid.map_err(|error| SimulationError::BadScene(error.to_string()))?;
        let wet = if fluid.is_some() { nodes } else { 0 };
        let free_radii = scene
            .rods
            .iter()
            .filter(|rod| !rod.held)
            .map(|rod| rod.radius);
        let mut simulation = Self {
            fluid,
            parameters,
            time: 0.0,
            history: History::begin(&unknowns, &velocity),
            control: match parameters.scheme {
                Scheme::BackwardDifferences => StepControl::beginning_small(&parameters.step),
                Scheme::ImplicitEuler | Scheme::ImplicitMidpoint => {
                    StepControl::new(&parameters.step)
                }
            },
            stage: Stage {
                step: 0.0,
                acceleration_step: 0.0,
                start: unknowns.clone(),
                velocity: velocity.clone(),
                drag: vec![Vector3::zeros(); wet],
                drag_velocity: vec![Vector3::zeros(); wet],
                resistance: vec![Matrix3::zeros(); wet],
                positions: vec![Vector3::zeros(); nodes],
            },
            newton: Newton::new(unknowns.len()),
            trial: unknowns.clone(),
            predicted_velocity: velocity.clone(),
            next_velocity: velocity.clone(),
            fluid_forces: vec![Vector3::zeros(); wet],
            positions: vec![Vector3::zeros(); nodes],
            velocities: vec![Vector3::zeros(); nodes],
            edge_angles: vec![0.0; nodes],
            radius: free_radii.fold(f64::INFINITY, f64::min),
            unknowns,
            velocity,
            system,
        };
        simulation.system.drive(0.0, &mut simulation.unknowns);
        simulation.system.update_geometry(&simulation.unknowns);
        simulation.publish();
        if let Some(FluidModel::Resistive { .. }) = scene.fluid {
            // Rods too thick for the theory show in the first forces, which leave no trace.
            simulation
                .compute_drag()
                .map_err(|error| SimulationError::BadScene(error.to_string()))?;
        }
        Ok(simulation)
    }

    /// Sets forces of another solver, which act beside the loads of the scene from the next step on: for
    /// coupling step by step. `forces` act on the nodes, N; `moments` about the tangent of the edge that
    /// starts at each node, N m. They are no part of the state that checkpoints hold.
    pub fn set_external_forces(&mut self, forces: &[Vector3], moments: &[f64]) {
        let entries = self.system.external_forces.chunks_exact_mut(STRIDE);
        for (entry, (force, moment)) in entries.zip(forces.iter().zip(moments)) {
            entry.copy_from_slice(&[force.x, force.y, force.z, *moment]);
        }
    }

    /// Gives a clamp of the scene, counted from 0, another motion, which holds from the next step or equilibrium
    /// on: for ends that a robot or a continuation moves. It is no part of the state that checkpoints hold.
    pub fn move_clamp(&mut self, clamp: usize, motion: Motion) {
        self.system.assembly.drives[clamp].follow(motion);
    }

    /// Takes one step that ends no later than `until` (hit exactly when it is within the step).
    ///
    /// # Errors
    /// [`SimulationError::NoConvergence`] and [`SimulationError::Unphysical`]; the state is then that of
    /// the last accepted step.
    pub fn advance(&mut self, until: f64) -> Result<StepReport, SimulationError> {
        let mut report = StepReport::default();
        if self.parameters.scheme != Scheme::BackwardDifferences {
            report.fluid_iterations = self.compute_drag()?;
        }
        self.system.update_candidates(&self.unknowns);
        let mut goal = self.control.goal(&self.parameters.step, self.time, until);
        let (mut stiffenings, mut passes) = (0, false);
        loop {
            let step = goal - self.time;
            report.fluid_iterations += self.prepare_stage(goal)?;
            let smaller = match self.attempt(goal) {
                Ok(attempt) => {
                    report.newton_iterations += attempt.iterations;
                    match self.judge(step, &attempt) {
                        Verdict::Accepted => break,
                        Verdict::Refused(smaller) => smaller,
                    }
                }
                Err(Failure::Penetration { .. }) if stiffenings < STIFFENINGS => {
                    stiffenings += 1;
                    self.stiffen_contact();
                    step
                }
                Err(failure) => {
                    report.newton_iterations += failure.iterations();
                    passes |= matches!(failure, Failure::Crossing { .. });
                    if 0.5 * step < self.parameters.minimum_step {
                        return Err(self.give_up(step, failure));
                    }
                    0.5 * step
                }
            };
            report.retries += 1;
            if smaller < step {
                if passes || self.stays_careful() {
                    self.control.failed(smaller);
                }
                goal = self.time + smaller;
            }
        }
        report.step = self.control.size(&self.parameters.step, goal - self.time);
        report.exchange = self.exchange(goal - self.time);
        self.accept(goal);
        report.time = self.time;
        self.report_contacts(&mut report);
        Ok(report)
    }

    /// Drag and local resistance at the present positions and velocities; returns the Krylov iterations.
    pub(super) fn compute_drag(&mut self) -> Result<usize, SimulationError> {
        let Some(fluid) = &mut self.fluid else {
            return Ok(0);
        };
        self.stage.drag_velocity.copy_from_slice(&self.velocities);
        let (drag, resistance) = (&mut self.stage.drag, &mut self.stage.resistance);
        match fluid.drag(&self.positions, &self.velocities, drag, resistance) {
            Ok(report) => Ok(report.iterations),
            Err(error) => Err(SimulationError::Unphysical(format!(
                "at t = {:.6e} s {error}",
                self.time
            ))),
        }
    }

    /// Whether the steps after a failed one begin small: where the step is automatic, and where rods rub, since the
    /// slip that fails one step fails many. Steps of a fixed grid that fail for another reason, an impact on a
    /// barrier say, are over when they are done.
    fn stays_careful(&self) -> bool {
        matches!(self.parameters.step, StepSize::Auto { .. }) || self.system.rubs()
    }

    fn judge(&mut self, step: f64, attempt: &Attempt) -> Verdict {
        let tolerance = match self.parameters.step {
            StepSize::Auto { tolerance, .. } => tolerance,
            StepSize::Fixed(whole) => {
                self.control.recover(whole);
                return Verdict::Accepted;
            }
        };
        let (order, largest_growth) = match self.parameters.scheme {
            Scheme::ImplicitEuler => (2, LARGEST_GROWTH),
            Scheme::ImplicitMidpoint => (3, LARGEST_GROWTH),
            Scheme::BackwardDifferences => (4, LARGEST_GROWTH_OF_DIFFERENCES),
        };
        let law = ErrorLaw {
            order,
            largest_growth,
        };
        if step <= self.parameters.minimum_step {
            return Verdict::Accepted;
        }
        let error = attempt.error / (tolerance * self.radius);
        self.control.judge(step, error, law, attempt.iterations)
    }

    fn accept(&mut self, goal: f64) {
        if self.fluid.is_some() {
            for node in 0..self.stage.drag.len() {
                let change = position(&self.next_velocity, node) - self.stage.drag_velocity[node];
                self.fluid_forces[node] =
                    self.stage.drag[node] - self.stage.resistance[node] * change;
            }
        }
        self.history
            .remember(goal - self.time, &self.unknowns, &self.velocity);
        self.time = goal;
        self.unknowns.copy_from_slice(&self.trial);
        self.velocity.copy_from_slice(&self.next_velocity);
        self.system.accept();
        self.publish();
    }

    /// Copies the state into the arrays that observers read.
    pub(super) fn publish(&mut self) {
        copy_positions(&self.unknowns, &mut self.positions);
        copy_positions(&self.velocity, &mut self.velocities);
        for (node, angle) in self.edge_angles.iter_mut().enumerate() {
            *angle = self.unknowns[STRIDE * node + 3];
        }
    }

    pub(super) fn stiffen_contact(&mut self) {
        if let Some(contact) = &mut self.system.contact {
            contact.set_stiffness(STIFFENING * contact.stiffness());
        }
    }

    /// Counts the contacts of the last evaluation and finds the nearest.
    pub(super) fn report_contacts(&self, report: &mut StepReport) {
        let Some(contact) = &self.system.contact else {
            return;
        };
        report.contacts = contact.contact_count();
        let smallest = |of: fn(&ActiveContact) -> f64| {
            contact.contacts().iter().map(of).min_by(f64::total_cmp)
        };
        report.minimum_distance = smallest(|pair| pair.distance);
        report.minimum_distance_ratio = smallest(|pair| pair.distance / pair.threshold);
    }
}
