//! Bodies with a centre of mass away from the node that carries them.
//!
//! The centre of such a body, of the mass m, is at x + r. Here r = Σ cₖ pₖ, with the tips pₖ = ℓ R
//! eₖ of its principal axes ([`super::joints`], `frame`), whose masses mₖ give the energy of its
//! rotation about the centre. So its kinetic energy
//!
//! ```text
//! ½ m |ẋ + ṙ|² + ½ Σ mₖ ṗₖ² = ½ m ẋ² + m ẋ·Σ cₖ ṗₖ + ½ m |Σ cₖ ṗₖ|² + ½ Σ mₖ ṗₖ²
//! ```
//!
//! is a quadratic form of the velocities of node and tips with constant coefficients. Time schemes
//! treat it like the masses of nodes, however far the body turns, and conserve momenta in the same
//! way. The weight of the body acts on the tips with the parts cₖ m.

use super::joints::EccentricMass;
use super::{Assembly, Stage};
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::{add_to_node, position};
use std::ops::Range;

impl EccentricMass {
    /// r (m) or its rate, from the tips or their rates.
    pub(crate) fn arm_of(&self, tips: &[Vector3; 3]) -> Vector3 {
        tips.iter()
            .zip(self.parts)
            .map(|(tip, part)| tip * part)
            .sum()
    }

    /// r (m) or its rate, from all unknowns or their velocities.
    pub(crate) fn arm(&self, unknowns: &[f64]) -> Vector3 {
        self.arm_of(&[0, 1, 2].map(|k| position(unknowns, self.first_tip + k)))
    }
}

impl Assembly {
    /// Bodies whose centre of mass is off their node.
    pub(super) fn eccentric(&self) -> impl Iterator<Item = &EccentricMass> {
        let frames = self.joints.frames.iter();
        frames.filter_map(|frame| frame.eccentric.as_ref())
    }

    /// Adds to the residual the inertia of these bodies under the accelerations of a stage at
    /// `unknowns`, beyond that of the masses of nodes and tips.
    pub(super) fn add_eccentric_inertia(
        &self,
        stage: &Stage,
        unknowns: &[f64],
        residual: &mut [f64],
    ) {
        for body in self.eccentric() {
            let acceleration = |place: usize| {
                let change = position(unknowns, place) - position(&stage.start, place);
                let rate = change / stage.step - position(&stage.velocity, place);
                rate / stage.acceleration_step
            };
            let tips = [0, 1, 2].map(|k| acceleration(body.first_tip + k));
            let of_arm = body.arm_of(&tips);
            add_to_node(residual, body.node, &(of_arm * body.mass));
            let whole = (acceleration(body.node) + of_arm) * body.mass;
            for (k, part) in body.parts.iter().enumerate() {
                add_to_node(residual, body.first_tip + k, &(whole * *part));
            }
        }
    }

    /// Kinetic energy of these bodies beyond that of the masses of nodes and tips, J; only of
    /// bodies whose tips are in the given range.
    pub(super) fn eccentric_energy(&self, places: &Range<usize>, velocity: &[f64]) -> f64 {
        let own = self
            .eccentric()
            .filter(|body| places.contains(&body.first_tip));
        let energies = own.map(|body| {
            let (node, arm) = (position(velocity, body.node), body.arm(velocity));
            body.mass * (node.dot(&arm) + 0.5 * arm.norm_squared())
        });
        energies.sum()
    }

    /// Momentum, kg m/s, and angular momentum about the origin, kg m²/s, of these bodies beyond
    /// those of the masses of nodes and tips.
    pub(super) fn eccentric_momenta(&self, unknowns: &[f64], velocity: &[f64]) -> [Vector3; 2] {
        let mut momenta = [Vector3::zeros(); 2];
        for body in self.eccentric() {
            let [node, node_rate] = [unknowns, velocity].map(|of| position(of, body.node));
            let [arm, arm_rate] = [unknowns, velocity].map(|of| body.arm(of));
            momenta[0] += arm_rate * body.mass;
            let angular = node.cross(&arm_rate) + arm.cross(&(node_rate + arm_rate));
            momenta[1] += angular * body.mass;
        }
        momenta
    }

    /// Masses at the tips of bodies: the unknown along x, followed by those along y and z, and the
    /// mass, kg.
    pub(super) fn weights_of_tips(&self) -> Vec<(usize, f64)> {
        let weights = self.eccentric().flat_map(|body| {
            let of_tip =
                |(k, part): (usize, &f64)| (STRIDE * (body.first_tip + k), body.mass * part);
            body.parts.iter().enumerate().map(of_tip)
        });
        weights.collect()
    }
}
