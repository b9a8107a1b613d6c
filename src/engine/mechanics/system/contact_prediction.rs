//! A prediction of contact forces, for steps in which many contacts change.
//!
//! Newton's method finds which contacts open, stick and slide one iteration, hence one factorisation, after the other;
//! where rods fall on each other that takes ten. Here the step is linearised without contact, A δq = −R, and contacts
//! with forces λ are added as constraints,
//!
//! ```text
//! A δq = Hᵀλ − R,   w = g + H δq,
//! ```
//!
//! with the gaps and slips w. Without contact rods are not coupled, A is a band, and the response A⁻¹Hᵀ of a rod
//! to a force at one of its contacts is cheap. So sweeps over the contacts, each of which is given the force that its own
//! laws require while all others stay (projected Gauss–Seidel; Moreau 1988, Jean 1999), cost a hundredth of a
//! factorisation with contact. They converge slowly, but soon determine the states, and Newton's method begins with
//! their forces and where these move the rods.
//!
//! The first time it is linearised where it begins. There rods have not yet passed through each other nor been crushed by it, as they
//! may have where each continues with its velocity; later, at the last prediction.
//!
//! **Limits.** The solution does not depend on it: Newton's method computes it. The prediction omits the closing of
//! rings, the smoothing of friction, and the rotation of contacts, so it is repeated where rods move far.

use super::contact_response::{Response, Responses};
use super::{Stage, System, copy_positions};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactConstraint, ContactSystem};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::{motion_of, position};

/// Times that the step is linearised after the first.
const PASSES: usize = 3;
/// Displacement of a position, in radii, below which another linearisation changes little.
const SMALL_MOVE: f64 = 0.05;
/// Farthest that one of them moves a position, in radii; the first goes as far beyond what the step moves.
const FARTHEST: f64 = 2.0;
/// Gap up to which contacts count beyond what the step closes without contact, in radii: those that are pushed together.
const MARGIN: f64 = 0.5;
/// Sweeps over the contacts, and the change of a force in units of the largest that ends them.
const SWEEPS: usize = 100;
const SWEPT: f64 = 1e-3;
/// Sweeps after which the gaps at which contacts rest follow their forces.
const SWEEPS_PER_REST: usize = 5;

/// A contact between sweeps.
struct Touch {
    /// Contact points at rest: gap along the normal, and slip since the step began, m.
    start: Vector3,
    /// Gap at which it rests under its force, m.
    rest: f64,
    force: Vector3,
    response: Option<Response>,
}

impl System {
    /// Moves `unknowns`, the prediction of a step at which the system has been linearised, by the contact forces that it
    /// leads to, and starts the iterations with these, where they differ much from those of the last step; returns whether
    /// that is so. `radius` is that of the thinnest rod, m.
    pub(crate) fn predict_contacts(
        &mut self,
        unknowns: &mut [f64],
        stage: &Stage,
        radius: f64,
    ) -> bool {
        // It solves with the rods alone, each for itself.
        if !self.assembly.joints.is_empty() || self.terms.couple_nodes() {
            return false;
        }
        let rods = self.assembly.rods.rods.len();
        let surprised =
            (self.terms.contact.model.as_mut()).filter(|contact| contact.is_surprised(rods));
        let Some(contact) = surprised else {
            return false;
        };
        contact.begin_forces_anew();
        let farthest = FARTHEST * radius;
        let moves = (0..self.terms.contact.positions.len())
            .map(|node| (position(unknowns, node) - stage.positions[node]).norm());
        let of_step = moves.fold(0.0, f64::max);
        let mut from_start = self.at_start(unknowns, stage);
        let begun = self.predict_once(&mut from_start, stage, [radius, farthest + of_step]);
        if begun.is_some() {
            unknowns.copy_from_slice(&from_start);
        }
        for _ in 0..PASSES {
            if !self.candidates_are_complete(unknowns) {
                self.update_candidates(unknowns);
            }
            let Some(moved) = self.predict_once(unknowns, stage, [radius, farthest]) else {
                break;
            };
            if moved <= SMALL_MOVE * radius {
                break;
            }
        }
        if !self.candidates_are_complete(unknowns) {
            self.update_candidates(unknowns);
        }
        true
    }

    /// The unknowns at the start of a step, except held ones, which are at its end.
    pub(super) fn at_start(&self, unknowns: &[f64], stage: &Stage) -> Vec<f64> {
        let ends = unknowns.iter().zip(&self.assembly.held);
        ends.zip(&stage.start)
            .map(|((end, held), start)| if *held { *end } else { *start })
            .collect()
    }

    /// One of these passes, which moves no position beyond the second `reach`; the first is the radius of the thinnest rod, m.
    /// Returns the farthest move of a node, m, or `None` where the rods are not stable or without contact.
    fn predict_once(
        &mut self,
        unknowns: &mut [f64],
        stage: &Stage,
        reach: [f64; 2],
    ) -> Option<f64> {
        let mut contact = self.terms.contact.model.take()?;
        self.linearize(unknowns, Some(stage));
        let moved = self
            .matrix
            .factor_rods()
            .is_some_and(|inertia| inertia.negative == 0)
            .then(|| {
                copy_positions(unknowns, &mut self.terms.contact.positions);
                self.sweep(&mut contact, stage, reach, unknowns)
            });
        contact.release_constraints();
        self.terms.contact.model = Some(contact);
        moved.flatten()
    }

    fn sweep(
        &self,
        contact: &mut ContactSystem,
        stage: &Stage,
        [radius, farthest]: [f64; 2],
        unknowns: &mut [f64],
    ) -> Option<f64> {
        let mut responses = Responses::new(self.matrix.rod_factor(), &self.assembly);
        let mut correction = responses.free_motion(&self.residual);
        let nodes = 0..self.terms.contact.positions.len();
        let motions: Vec<Vector3> = nodes.map(|node| position(&correction, node)).collect();
        contact.list_constraints(
            &self.terms.contact.positions,
            &motions,
            2.0 * MARGIN * radius,
            &[],
        );
        contact.load_begun_forces();
        let constraints = contact.constraints();
        if constraints.is_empty() {
            return None;
        }
        let mut touches: Vec<Touch> = constraints
            .iter()
            .map(|constraint| {
                let slid = constraint.relative_motion(|node| self.slid(contact, node, stage));
                Touch::new(
                    constraint,
                    slid + constraint.turned_motion(|edge| contact.turn_of(edge)),
                )
            })
            .collect();
        for (touch, constraint) in touches.iter_mut().zip(constraints) {
            if touch.force != Vector3::zeros() {
                touch.response = Some(responses.of_contact(constraint));
                responses.push(touch.response.as_ref(), &touch.force, &mut correction);
            }
        }
        for sweep in 0..SWEEPS {
            if sweep % SWEEPS_PER_REST == 0 {
                for (touch, constraint) in touches.iter_mut().zip(constraints) {
                    touch.rest = contact.rest_gap(constraint, touch.force.dot(&constraint.normal));
                }
            }
            let (mut change, mut largest) = (0.0_f64, 0.0_f64);
            for k in 0..touches.len() {
                // Forwards and backwards: a force at one end of a chain of contacts reaches the other in one sweep.
                let k = if sweep % 2 == 0 {
                    k
                } else {
                    touches.len() - 1 - k
                };
                let by = touches[k].relax(&constraints[k], &mut responses, &correction);
                change = change.max(by.norm());
                largest = largest.max(touches[k].force.norm());
                responses.push(touches[k].response.as_ref(), &by, &mut correction);
            }
            if change <= SWEPT * largest {
                break;
            }
        }
        if !correction.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let moves =
            (0..self.terms.contact.positions.len()).map(|node| position(&correction, node).norm());
        let longest = moves.fold(0.0, f64::max);
        let part = (farthest / longest).min(1.0);
        for (own, correction) in unknowns.iter_mut().zip(&correction) {
            *own += part * correction;
        }
        let forces: Vec<Vector3> = touches.iter().map(|touch| touch.force).collect();
        contact.begin_with_forces(&forces);
        Some(longest)
    }
}

impl Touch {
    /// A contact whose points have `slid` by so much since the step began, m.
    fn new(constraint: &ContactConstraint, slid: Vector3) -> Self {
        let normal = constraint.normal;
        Self {
            start: slid + normal * (constraint.gap - normal.dot(&slid)),
            rest: 0.0,
            force: constraint.force,
            response: None,
        }
    }

    /// Takes the force that its laws require while all others stay; returns the change, N.
    fn relax(
        &mut self,
        constraint: &ContactConstraint,
        responses: &mut Responses,
        correction: &[f64],
    ) -> Vector3 {
        let normal = constraint.normal;
        let apart = self.start
            + constraint.relative_motion(|node| motion_of(correction, node))
            + constraint.turned_motion(|edge| correction[STRIDE * edge + 3]);
        let closing = self.rest - normal.dot(&apart);
        if self.response.is_none() && closing > 0.0 {
            self.response = Some(responses.of_contact(constraint));
        }
        let Some(response) = &self.response else {
            return Vector3::zeros();
        };
        let softness = response.by_pressure.dot(&normal);
        if softness <= 0.0 {
            return Vector3::zeros();
        }
        let before = self.force;
        let pressed = before.dot(&normal);
        let pressure = (pressed + closing / softness).max(0.0);
        let apart = apart + response.by_pressure * (pressure - pressed);
        let drag = before - normal * pressed;
        self.force =
            normal * pressure + response.friction(&drag, &apart, constraint.friction * pressure);
        self.force - before
    }
}

#[cfg(test)]
#[path = "contact_prediction_tests.rs"]
mod tests;
