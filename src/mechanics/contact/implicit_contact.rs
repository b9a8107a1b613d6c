//! All contacts of a scene: candidates, forces, Jacobians, stiffness.

use super::parameters::ContactParameters;
use super::surface::{ContactPlane, ContactSurface};
use crate::mechanics::Vector3;
use serde::{Deserialize, Serialize};

/// Derivative of the 12 force components of an edge–edge contact with respect to the 12 coordinates, N/m.
pub type EdgeJacobian = [[f64; 12]; 12];
/// Derivative of the force of a plane on a node with respect to the node's position, N/m.
pub type PlaneJacobian = [[f64; 3]; 3];

/// A pair of edges that may touch before the candidates are next updated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CandidatePair {
    /// The edges i < j, indices into [`ContactSurface::edges`].
    pub edges: [usize; 2],
    /// The nodes x_i, x_{i+1}, x_j, x_{j+1}.
    pub nodes: [usize; 4],
}

/// A pair of edges within reach of the contact potential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveContact {
    /// Index into [`ImplicitContact::candidates`].
    pub candidate: usize,
    /// The nodes x_i, x_{i+1}, x_j, x_{j+1}.
    pub nodes: [usize; 4],
    /// Centreline distance Δ, m.
    pub distance: f64,
    /// Magnitude of the normal force of one edge on the other, N.
    pub normal_force: f64,
    /// Force on the four nodes, friction included, N.
    pub force: [f64; 12],
}

/// A node within reach of the contact potential of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneContact {
    /// The node.
    pub node: usize,
    /// Index of the plane.
    pub plane: usize,
    /// Distance of the node from the plane, m; negative behind it.
    pub distance: f64,
    /// Magnitude of the normal force, N.
    pub normal_force: f64,
    /// Force on the node, friction included, N.
    pub force: [f64; 3],
}

/// Two bodies that meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactPair {
    /// Two edges, indices into [`ContactSurface::edges`].
    Edges([usize; 2]),
    /// A node and a plane.
    NodeAndPlane {
        /// The node.
        node: usize,
        /// Index of the plane.
        plane: usize,
    },
}

/// How near two bodies are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proximity {
    /// The bodies.
    pub pair: ContactPair,
    /// Distance of the centrelines, or of the node from the plane, m.
    pub distance: f64,
    /// The distance at which the surfaces touch: h_i + h_j, or h at a plane, m.
    pub threshold: f64,
}

/// What influences future contact forces; part of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactMemory {
    /// Positions of all nodes when the candidates were last built, m; empty before the first time.
    pub candidate_positions: Vec<[f64; 3]>,
    /// Contact stiffness k.
    pub stiffness: f64,
}

/// A memory of another scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("contact memory of {found} nodes in a scene of {expected}")]
pub struct MismatchedMemory {
    /// Nodes of this scene.
    pub expected: usize,
    /// Nodes in the memory.
    pub found: usize,
}

/// The implicit contact model with Coulomb friction (thesis 2.2–2.3) for all rods and planes of a scene.
pub struct ImplicitContact;

impl ImplicitContact {
    /// `least_stiffness` is the contact stiffness k at the start and the least that
    /// [`Self::adapt_stiffness`] chooses; s times the force scale EI/L² suits.
    pub fn new(
        _parameters: ContactParameters,
        _surface: ContactSurface,
        _planes: Vec<ContactPlane>,
        _least_stiffness: f64,
    ) -> Self {
        todo!()
    }

    /// The surfaces.
    pub fn surface(&self) -> &ContactSurface {
        todo!()
    }

    /// Rebuilds the candidates where some node has moved more than a quarter of the margin since they
    /// were last built; returns whether the set changed. To be called at the start of a step.
    pub fn update_candidates(&mut self, _positions: &[Vector3]) -> bool {
        todo!()
    }

    /// Pairs of edges that may touch, sorted by edges.
    pub fn candidates(&self) -> &[CandidatePair] {
        todo!()
    }

    /// Whether no contact can be missing from the candidates at these positions: no node has moved more
    /// than half the margin since they were built. To be asked when a step has converged.
    pub fn candidates_are_complete(&self, _positions: &[Vector3]) -> bool {
        todo!()
    }

    /// Finds the active contacts at `positions` and evaluates energy, forces and Jacobians.
    ///
    /// Friction acts on the velocity (`positions` − `previous`)/`time_step`, and not at all where
    /// `time_step` is infinite (statics).
    pub fn evaluate(&mut self, _positions: &[Vector3], _previous: &[Vector3], _time_step: f64) {
        todo!()
    }

    /// The same without Jacobians, for line searches; [`Self::jacobians`] are empty afterwards.
    pub fn evaluate_forces(
        &mut self,
        _positions: &[Vector3],
        _previous: &[Vector3],
        _time_step: f64,
    ) {
        todo!()
    }

    /// Contact energy of the last evaluation, J.
    pub fn energy(&self) -> f64 {
        todo!()
    }

    /// Active edge–edge contacts of the last evaluation, in the order of the candidates.
    pub fn contacts(&self) -> &[ActiveContact] {
        todo!()
    }

    /// Force Jacobians, one per element of [`Self::contacts`]; symmetric without friction.
    pub fn jacobians(&self) -> &[EdgeJacobian] {
        todo!()
    }

    /// Active plane contacts of the last evaluation, sorted by plane and node.
    pub fn plane_contacts(&self) -> &[PlaneContact] {
        todo!()
    }

    /// Force Jacobians, one per element of [`Self::plane_contacts`].
    pub fn plane_jacobians(&self) -> &[PlaneJacobian] {
        todo!()
    }

    /// Contacts (with planes too) of the last evaluation within the distance tolerance δ (Eq. 2.17).
    pub fn contact_count(&self) -> usize {
        todo!()
    }

    /// Contact stiffness k.
    pub fn stiffness(&self) -> f64 {
        todo!()
    }

    /// Sets the contact stiffness k.
    pub fn set_stiffness(&mut self, _stiffness: f64) {
        todo!()
    }

    /// Adapts the stiffness to `forces`, the total force on every node without contact and friction, N
    /// (Eqs. 2.18, 2.19); returns whether it changed.
    pub fn adapt_stiffness(&mut self, _positions: &[Vector3], _forces: &[Vector3]) -> bool {
        todo!()
    }

    /// What a checkpoint must hold.
    pub fn memory(&self) -> ContactMemory {
        todo!()
    }

    /// Continues from a checkpoint.
    pub fn restore(&mut self, _memory: &ContactMemory) -> Result<(), MismatchedMemory> {
        todo!()
    }

    /// Smallest centreline distance over the candidates, m; infinite without candidates.
    pub fn minimum_distance(&self, _positions: &[Vector3]) -> f64 {
        todo!()
    }

    /// The pair with the smallest ratio of distance to threshold, over candidates and planes.
    pub fn nearest(&self, _positions: &[Vector3]) -> Option<Proximity> {
        todo!()
    }

    /// The deepest penetration, where it exceeds `maximum_penetration`.
    pub fn excessive_penetration(&self, _positions: &[Vector3]) -> Option<Proximity> {
        todo!()
    }

    /// All pairs whose surfaces overlap at `positions`; a scene must not start so.
    pub fn initial_overlaps(&self, _positions: &[Vector3]) -> Vec<Proximity> {
        todo!()
    }
}
