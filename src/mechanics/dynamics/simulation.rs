//! A running simulation: owns the state, advances it step by step.

use super::parameters::IntegrationParameters;
use crate::mechanics::Vector3;
use crate::mechanics::scene::Scene;
use serde::{Deserialize, Serialize};

/// A scene in motion.
pub struct Simulation;

/// Everything that influences the future of a simulation; what a checkpoint holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SimulationState {
    /// Time, s.
    pub time: f64,
}

/// What one accepted step did.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepReport {
    /// Time at the end of the step, s.
    pub time: f64,
    /// Size of the step, s.
    pub step: f64,
    /// Newton iterations of the accepted step and of the retries before it.
    pub newton_iterations: usize,
    /// Contacts that bear force at the end of the step.
    pub contacts: usize,
    /// Times the step was halved before it was accepted.
    pub retries: usize,
    /// Krylov iterations of the fluid solve.
    pub fluid_iterations: usize,
}

/// Energies of all rods, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// ½ v·M v.
    pub kinetic: f64,
    /// Stretching energy.
    pub stretching: f64,
    /// Bending energy.
    pub bending: f64,
    /// Twisting energy.
    pub twisting: f64,
    /// Contact potential.
    pub contact: f64,
    /// Potential of gravity.
    pub gravitational: f64,
}

/// Why a simulation stopped.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The scene itself is wrong (exit code 2).
    #[error("{0}")]
    BadScene(String),
    /// Newton did not converge at the smallest step (exit code 3).
    #[error(
        "no convergence at t = {time:.6e} s with the smallest step {step:.3e} s: residual {residual:.3e} N, largest in the {term} term at node {node} of rod `{rod}`"
    )]
    NoConvergence {
        /// Time at the start of the failed step, s.
        time: f64,
        /// The smallest step tried, s.
        step: f64,
        /// Largest residual, N.
        residual: f64,
        /// Name of the term that is largest there.
        term: &'static str,
        /// Name of the rod.
        rod: String,
        /// Node along that rod.
        node: usize,
    },
    /// A physics check failed: penetration or a number that is not finite (exit code 4).
    #[error("{0}")]
    Unphysical(String),
}

impl Simulation {
    /// Sets up a simulation at time zero.
    pub fn new(
        _scene: &Scene,
        _parameters: &IntegrationParameters,
    ) -> Result<Self, SimulationError> {
        todo!()
    }
    /// Takes one step that ends no later than `until` (hit exactly when it is within the step).
    pub fn advance(&mut self, _until: f64) -> Result<StepReport, SimulationError> {
        todo!()
    }
    /// Finds the equilibrium at the present time: Newton's method without inertia.
    pub fn find_equilibrium(&mut self) -> Result<StepReport, SimulationError> {
        todo!()
    }
    /// Time, s.
    pub fn time(&self) -> f64 {
        todo!()
    }
    /// Positions of all nodes, rod after rod, m.
    pub fn positions(&self) -> &[Vector3] {
        todo!()
    }
    /// Velocities of all nodes, m/s.
    pub fn velocities(&self) -> &[Vector3] {
        todo!()
    }
    /// Angle of the edge that starts at each node, rad; zero where no edge starts.
    pub fn edge_angles(&self) -> &[f64] {
        todo!()
    }
    /// First material director of the edge that starts at each node; zero where no edge starts.
    pub fn material_directors(&self) -> Vec<Vector3> {
        todo!()
    }
    /// Force of the fluid on each node, N; empty without fluid.
    pub fn fluid_forces(&self) -> Vec<Vector3> {
        todo!()
    }
    /// Contact force on each node, N; empty without contact.
    pub fn contact_forces(&self) -> Vec<Vector3> {
        todo!()
    }
    /// Energies now, J.
    pub fn energies(&self) -> Energies {
        todo!()
    }
    /// Smallest distance between contact surfaces' centrelines that may touch, m; infinite if none is near.
    pub fn minimum_distance(&self) -> f64 {
        todo!()
    }
    /// What a checkpoint must hold to continue bit for bit.
    pub fn state(&self) -> SimulationState {
        todo!()
    }
    /// Continues from a checkpoint of the same scene.
    pub fn restore(&mut self, _state: SimulationState) -> Result<(), SimulationError> {
        todo!()
    }
}
