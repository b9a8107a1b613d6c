//! Reports of a simulation: steps, energies, errors, and its state for checkpoints.

use super::history::History;
use super::step_control::StepControl;
use super::validity_memory::ValidityMemory;
use crate::mechanics::contact::{ContactMemory, Proximity};
use crate::mechanics::fluid::FluidMemory;
use crate::mechanics::rod::ReferenceFrames;
use crate::mechanics::system::{Break, Interventions};
use crate::mechanics::{SceneError, UnitQuaternion};
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

/// All state that influences the future of a simulation: the data of a checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SimulationState {
    /// Time, s.
    pub time: f64,
    /// Unknowns, 4 per node.
    pub unknowns: Vec<f64>,
    /// Velocities of the unknowns.
    pub velocity: Vec<f64>,
    /// Unknowns and velocities at the last steps.
    pub history: History,
    /// Frames of the edges.
    pub reference: ReferenceFrames,
    /// Step control.
    pub control: StepControl,
    /// Interventions in clamps and loads since the start.
    pub interventions: Interventions,
    /// Remarks on the motion.
    pub validity: ValidityMemory,
    /// Contact candidates and stiffness.
    pub contact: Option<ContactMemory>,
    /// Force history and preconditioner of the fluid.
    pub fluid: Option<FluidMemory>,
    /// State of forces between steps: strains of viscous rods.
    pub strains: Vec<Vec<f64>>,
    /// Reference rotations of joints and bodies.
    pub frames: Vec<UnitQuaternion>,
    /// Breaking of the joints.
    pub breaks: Vec<Option<Break>>,
}

/// Report of one accepted step.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepReport {
    /// Time at the end of the step, s.
    pub time: f64,
    /// Size of the step, s.
    pub step: f64,
    /// Newton iterations of the accepted step and of the retries before it.
    pub newton_iterations: usize,
    /// Number of contacts with a force at the end of the step.
    pub contacts: usize,
    /// Number of times the step was repeated before it was accepted.
    pub retries: usize,
    /// Krylov iterations of the fluid solve.
    pub fluid_iterations: usize,
    /// The pair of bodies in contact with the smallest ratio of their distance to the distance at
    /// which their surfaces touch.
    pub nearest: Option<Proximity>,
    /// Work done and energy lost.
    pub exchange: Exchange,
    /// Work that moving obstacles did on the rods by normal forces, J.
    pub obstacle_work: f64,
    /// Energy added by a change of the contact stiffness at the start of the step, J.
    pub stiffening: f64,
    /// Sum of all normal contact forces, N.
    pub contact_force: f64,
}

/// Work done on rods and energy lost by them, J.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Exchange {
    /// Work of the clamps through the motion of the nodes and angles that they hold, without that
    /// of tilting a held tangent.
    pub clamp_work: f64,
    /// Energy lost to friction between rods and on planes.
    pub friction_loss: f64,
    /// Energy lost to drag loads and to the viscosity of the rods, without that lost to a fluid.
    pub drag_loss: f64,
}

impl AddAssign for Exchange {
    fn add_assign(&mut self, other: Self) {
        self.clamp_work += other.clamp_work;
        self.friction_loss += other.friction_loss;
        self.drag_loss += other.drag_loss;
    }
}

/// Energies of all rods, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// ½ v·M v.
    pub kinetic: f64,
    /// Energy of stretching, including springs between nodes.
    pub stretching: f64,
    /// Energy of bending, including springs about hinges.
    pub bending: f64,
    /// Twisting energy.
    pub twisting: f64,
    /// Contact potential.
    pub contact: f64,
    /// Potential of gravity.
    pub gravitational: f64,
}

impl Energies {
    /// Sum of stretching, bending and twisting energy.
    pub fn elastic(&self) -> f64 {
        self.stretching + self.bending + self.twisting
    }

    /// Sum of kinetic, elastic, contact and gravitational energy.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic() + self.contact + self.gravitational
    }
}

/// Reason why a simulation stopped.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The scene is invalid, or not suitable for the requested method (exit code 2).
    #[error(transparent)]
    BadScene(#[from] SceneError),
    /// Newton's method did not converge at the smallest step (exit code 3).
    #[error(
        "no convergence at t = {time:.6e} s with the smallest step {step:.3e} s: {}, largest in the {term} term at node {node} of rod `{rod}`", in_words(*residual)
    )]
    NoConvergence {
        /// Time at the start of the failed step, s.
        time: f64,
        /// The smallest step tried, s.
        step: f64,
        /// Largest residual, N.
        residual: f64,
        /// Name of the largest term of the residual there.
        term: &'static str,
        /// Name of the rod.
        rod: String,
        /// Node along that rod.
        node: usize,
    },
    /// The complementarity problem of contact had no solution, or none was found, at the smallest
    /// step (exit code 3).
    #[error(
        "no convergence at t = {time:.6e} s with the smallest step {step:.3e} s: no contact forces satisfy the laws of Signorini and Coulomb"
    )]
    NoContactForces {
        /// Time at the start of the failed step, s.
        time: f64,
        /// The smallest step tried, s.
        step: f64,
    },
    /// Newton's method without inertia did not converge (exit code 3).
    #[error(
        "no equilibrium found in {iterations} iterations: {}, largest in the {term} term at node {node} of rod `{rod}`; {advice}", in_words(*residual)
    )]
    NoEquilibrium {
        /// Iterations spent.
        iterations: usize,
        /// Largest residual, N.
        residual: f64,
        /// Name of the largest term of the residual there.
        term: &'static str,
        /// Name of the rod.
        rod: String,
        /// Node along that rod.
        node: usize,
        /// Advice to the user.
        advice: &'static str,
    },
    /// A physics check failed: penetration or a number that is not finite (exit code 4).
    #[error("{0}")]
    Unphysical(String),
}

/// Formats a residual in N, which may be NaN.
fn in_words(residual: f64) -> String {
    if residual.is_finite() {
        format!("residual {residual:.3e} N")
    } else {
        "the equations are singular or not finite".into()
    }
}
