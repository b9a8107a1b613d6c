//! Impacts in steps of the midpoint rule.
//!
//! The rule evaluates contact forces in the middle of a step and extrapolates from there to its
//! end. A rod that comes into contact within a step may therefore be carried deep into it, or be
//! pushed although it has left the contact, and gain spurious energy. With the force f of the
//! middle and the energy φ of the contacts,
//!
//! ΔE = f·(x₁ − x₀) + φ(x₁) − φ(x₀),
//!
//! which vanishes with the step, except at an impact that the step does not resolve. A step in
//! which ΔE is positive is repeated with implicit Euler, which adds no energy: restitution is
//! never more than 1.

use super::parameters::Scheme;
use super::stage::Setting;

impl Setting {
    /// The setting for a step that ends in an impact.
    pub(crate) fn dissipative(mut self) -> Self {
        self.parameters.scheme = Scheme::ImplicitEuler;
        self
    }
}
