//! Rods that a force feeds out of their sheaths.
//!
//! The length s that is fed out is an unknown. Every node in the sheath moves with it, so that a step
//! must satisfy, with the force F_s of the sheath on its rod ([`super::mouth`]), which contains the
//! inertia of the rod inside, and the force F that pushes it,
//!
//! ```text
//! R(q, s) = 0,     F_s(q, s) = F
//! ```
//!
//! The first is solved for the other unknowns q by Newton's method as in every step, and s is
//! corrected by Newton's method for the second: with dq/ds = −K⁻¹ ∂R/∂s, the slope of F_s along the
//! solutions q(s) is ∂F_s/∂q · dq/ds + ∂F_s/∂s. The derivatives over s are difference quotients; the
//! steps that they lead to are exact when the forces balance.

use super::placed::Push;
use crate::linalg::SingularMatrix;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Stage, System};
use nalgebra::{DMatrix, DVector};

/// Change of s for difference quotients, relative to the first edge.
const CHANGE: f64 = 1e-6;

impl System {
    /// Whether the force of every sheath on a rod that is pushed is the force that pushes it, at the
    /// last evaluation, or the rod is at a stop.
    pub(crate) fn pushes_balance(&self) -> bool {
        let mut sheaths = self.terms.sheaths.0.iter().enumerate();
        sheaths.all(|(sheath, placed)| {
            let Some(push) = &placed.push else {
                return true;
            };
            let unbalanced = self.unbalanced(sheath, push);
            let rod = self.assembly.locate(placed.nodes[0]).0;
            unbalanced.abs() <= self.allowance(rod).0 || push.is_stopped(unbalanced)
        })
    }

    /// Force that pushes a rod minus the force of its sheath, N.
    fn unbalanced(&self, sheath: usize, push: &Push) -> f64 {
        push.force(self.time) - self.sheath_force(sheath)[0]
    }

    /// Moves the rod in a sheath, and the mouth along the rod, without changing which edges are held.
    fn feed(&mut self, sheath: usize, fed: f64, unknowns: &mut [f64]) {
        let (time, committed) = (self.time, self.committed_time);
        let placed = &mut self.terms.sheaths.0[sheath];
        if let Some(push) = &mut placed.push {
            push.feed(fed);
        }
        placed.apply(time, committed, &self.reference, unknowns);
        placed.stiffen(time, &mut self.assembly.rods);
        self.geometry.take_natural_strains(&self.assembly.rods);
        self.complete(unknowns);
    }

    /// Corrects the lengths that are fed out where forces push, once, and the other unknowns with
    /// them, from a solution of the stage for the present lengths.
    ///
    /// # Errors
    /// If the system or the slopes of the forces are singular.
    pub(crate) fn correct_fed(
        &mut self,
        unknowns: &mut [f64],
        stage: &Stage,
    ) -> Result<(), SingularMatrix> {
        self.linearize(unknowns, Some(stage));
        self.factor()?;
        let sheaths = self.terms.sheaths.0.iter().enumerate();
        let pushed: Vec<(usize, Push)> = sheaths
            .filter_map(|(sheath, placed)| Some((sheath, placed.push.clone()?)))
            .collect();
        let unbalanced = |system: &Self| {
            let own = pushed.iter();
            DVector::from_iterator(
                pushed.len(),
                own.map(|(sheath, push)| system.unbalanced(*sheath, push)),
            )
        };
        let missing = unbalanced(self);
        let residual = self.residual.clone();
        let mut slopes = DMatrix::zeros(pushed.len(), pushed.len());
        let mut motions = Vec::with_capacity(pushed.len());
        for (column, (sheath, push)) in pushed.iter().enumerate() {
            let edge = self.terms.sheaths.0[*sheath].along[1];
            let change = push.inwards(CHANGE * edge);
            let mut moved = unknowns.to_vec();
            self.feed(*sheath, push.fed + change, &mut moved);
            self.evaluate(&moved, Some(stage));
            let changed = self.residual.iter().zip(&residual);
            let mut motion: Vec<f64> = changed.map(|(new, old)| (old - new) / change).collect();
            self.solve(&mut motion)?;
            advance(&mut moved, &motion, change);
            self.complete(&mut moved);
            self.evaluate(&moved, Some(stage));
            slopes.set_column(column, &((&missing - unbalanced(self)) / change));
            self.feed(*sheath, push.fed, &mut moved);
            motions.push(motion);
        }
        let Some(steps) = slopes.lu().solve(&missing) else {
            let end = STRIDE * self.terms.sheaths.0[pushed[0].0].nodes[0];
            return Err(SingularMatrix {
                unknown: end,
                pivot: 0.0,
            });
        };
        for (((sheath, push), motion), step) in pushed.iter().zip(&motions).zip(steps.iter()) {
            self.feed(*sheath, push.fed + step, unknowns);
            let made = self.terms.sheaths.0[*sheath].fed(self.time) - push.fed;
            advance(unknowns, motion, made);
        }
        self.complete(unknowns);
        Ok(())
    }
}

/// Moves the unknowns along a motion per length fed out, by a length (m).
fn advance(unknowns: &mut [f64], motion: &[f64], length: f64) {
    for (unknown, motion) in unknowns.iter_mut().zip(motion) {
        *unknown += length * motion;
    }
}
