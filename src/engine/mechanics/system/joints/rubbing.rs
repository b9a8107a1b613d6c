//! Friction of a node that slides along a rod.
//!
//! The force of the joint on the node is −R, with the residual R of the node. Its part across the
//! rod, of the size N, is the normal force of Coulomb's law. The friction on the node is along the
//! rod, and acts on the unknown s with the natural length L per unit of s:
//!
//! ```text
//! R⊥ = R − t (t·R),     N = ‖R⊥‖ = n·R,     f = μ N L z,     t = X'/‖X'‖,  n = R⊥/N
//! z = clamp(z⁰ + L (s − s⁰)/δ, −1, 1)
//! ```
//!
//! It adds f to the residual of s. Before the node slides it sticks like a spring (L. Prandtl
//! 1928), with the values z⁰ and s⁰ at the start of the step and the presliding length δ, so that
//! a node at rest keeps its force. N is that of the same instant as the motion: the derivatives
//!
//! ```text
//! ∂f/∂R = μ L z n,     ∂f/∂X' = −μ L z (t·R)/‖X'‖ n,     ∂f/∂s at fixed R and X' = μ N L²/δ
//! ```
//!
//! the last where |z| < 1, complete Newton's matrix, which is not symmetric.

use crate::mechanics::Vector3;
use crate::mechanics::scene::CoulombFriction;

/// Presliding length of a node for which none is given, over the natural length of the rod along
/// which it slides.
const PRESLIDING: f64 = 1e-5;

/// Friction of a sliding node, at the configuration of the last evaluation.
#[derive(Clone, Debug)]
pub(super) struct Rubbing {
    /// μ L, m.
    arm: f64,
    /// L/δ.
    per_parameter: f64,
    /// s and z.
    state: [f64; 2],
    /// s⁰ and z⁰.
    committed: [f64; 2],
    /// ∂f/∂R, m.
    pub over_force: Vector3,
    /// ∂f/∂X', N.
    pub over_tangent: Vector3,
    /// ∂f/∂s at fixed R and X', N m.
    pub over_parameter: f64,
}

impl Rubbing {
    /// Friction of a node that rests at the parameter `start` of a rod of the length `length` (m),
    /// with L = `edge` (m), with no part of it mobilised.
    pub(super) fn new(law: &CoulombFriction, [length, edge]: [f64; 2], start: f64) -> Self {
        let presliding = law.presliding.unwrap_or(PRESLIDING * length);
        Self {
            arm: law.coefficient * edge,
            per_parameter: edge / presliding,
            state: [start, 0.0],
            committed: [start, 0.0],
            over_force: Vector3::zeros(),
            over_tangent: Vector3::zeros(),
            over_parameter: 0.0,
        }
    }

    /// Begins at s with no part of it mobilised.
    pub(super) fn begin(&mut self, parameter: f64) {
        self.restore([parameter, 0.0]);
    }

    /// Sets s.
    pub(super) fn place(&mut self, parameter: f64) {
        let [start, state] = self.committed;
        let state = state + self.per_parameter * (parameter - start);
        self.state = [parameter, state.clamp(-1.0, 1.0)];
    }

    /// Sets R, N, and X', m.
    pub(super) fn note(&mut self, residual: &Vector3, tangent: &Vector3) {
        let (length, state) = (tangent.norm(), self.state[1]);
        let unit = tangent / length;
        let along = residual.dot(&unit);
        let across = residual - unit * along;
        let normal_force = across.norm();
        let normal = across.try_normalize(0.0).unwrap_or_default();
        self.over_force = normal * (self.arm * state);
        self.over_tangent = self.over_force * (-along / length);
        self.over_parameter = match state.abs() < 1.0 {
            true => self.arm * normal_force * self.per_parameter,
            false => 0.0,
        };
    }

    /// s and z.
    #[cfg(test)]
    pub(super) fn state(&self) -> [f64; 2] {
        self.state
    }

    /// Begins at the present state.
    pub(super) fn commit(&mut self) {
        self.committed = self.state;
    }

    /// s⁰ and z⁰.
    pub(super) fn memory(&self) -> [f64; 2] {
        self.committed
    }

    /// Restores what [`Self::memory`] returned.
    pub(super) fn restore(&mut self, memory: [f64; 2]) {
        (self.committed, self.state) = (memory, memory);
    }
}
