//! Prediction of contact forces, for steps in which many contacts change.
//!
//! Newton's method finds the contacts that open, stick and slide one iteration, and so one
//! factorisation, at a time; when rods fall on each other this takes ten. Here the step is
//! linearised without contact, A δq = −R, and contacts with forces λ are added as constraints,
//!
//! ```text
//! A δq = Hᵀλ − R,   w = g + H δq,
//! ```
//!
//! with the gaps and slips w. Without contact rods are not coupled, A is a band, and the response
//! A⁻¹Hᵀ of a rod to a force at one of its contacts is cheap. So sweeps over the contacts cost a
//! hundredth of a factorisation with contact; in a sweep each contact in turn gets the force that
//! its own laws require while all others are fixed (projected Gauss–Seidel; Moreau 1988, Jean
//! 1999). Sweeps converge slowly, but soon determine the states. Newton's method then begins with
//! their forces and with the positions to which these move the rods.
//!
//! The first linearisation is at the start of the step, where rods have not yet passed through
//! each other or been crushed, which may happen if each continues with its velocity. Later
//! linearisations are at the last prediction.
//!
//! **Limits.** The solution does not depend on the prediction, since Newton's method computes it.
//! The prediction omits the closing of rings, the smoothing of friction, and the rotation of
//! contacts, so it is repeated if rods move far.

use super::contact_response::{Found, Response, Responses};
use super::{Stage, System, copy_positions};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactConstraint, ContactSystem};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::{motion_of, position};

/// Number of linearisations after the first.
const PASSES: usize = 3;
/// Displacement of a position, in radii, below which another linearisation would change little.
const SMALL_MOVE: f64 = 0.05;
/// Largest displacement of a position in one linearisation, in radii; the first linearisation
/// allows this much beyond the motion of the step.
const FARTHEST: f64 = 2.0;
/// Largest gap of contacts that are included, in radii, beyond the distance that the step closes
/// without contact: other contacts may push them together.
const MARGIN: f64 = 0.5;
/// Number of sweeps over the contacts, and the change of a force, relative to the largest force,
/// at which they end.
const SWEEPS: usize = 100;
const SWEPT: f64 = 1e-3;
/// Number of sweeps after which the rest gaps of contacts are updated for their forces.
const SWEEPS_PER_REST: usize = 5;

/// A contact between sweeps.
struct Touch {
    /// Contact points at rest: gap along the normal, and slip since the step began, m.
    start: Vector3,
    /// Gap at which the contact rests under its force, m.
    rest: f64,
    force: Vector3,
    response: Option<Response>,
}

impl System {
    /// Predicts the contact forces if they differ much from those of the last step; returns
    /// whether they do. Moves `unknowns`, the predicted unknowns at which the system was
    /// linearised, by these forces, and starts the iterations with them. `radius` is that of the
    /// thinnest rod, m.
    pub(crate) fn predict_contacts(
        &mut self,
        unknowns: &mut [f64],
        stage: &Stage,
        radius: f64,
    ) -> bool {
        // The system is solved for each rod separately.
        let is_smooth = self
            .contact()
            .is_some_and(|contact| contact.curves().is_some());
        if !self.assembly.joints.is_empty() || self.terms.couple_nodes() || is_smooth {
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

    /// The unknowns at the start of a step, but held unknowns at its end.
    pub(super) fn at_start(&self, unknowns: &[f64], stage: &Stage) -> Vec<f64> {
        let ends = unknowns.iter().zip(&self.assembly.held);
        ends.zip(&stage.start)
            .map(|((end, held), start)| if *held { *end } else { *start })
            .collect()
    }

    /// Runs one linearisation, which moves no position beyond the second `reach`; the first
    /// `reach` is the radius of the thinnest rod, m. Returns the farthest move of a node, m, or
    /// `None` if the rods are not stable or there is no contact.
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
                let mut found = std::mem::take(&mut self.responses);
                let moved = self.sweep(&mut contact, &mut found, stage, reach, unknowns);
                self.responses = found;
                moved
            });
        contact.release_constraints();
        self.terms.contact.model = Some(contact);
        moved.flatten()
    }

    fn sweep(
        &self,
        contact: &mut ContactSystem,
        found: &mut Found,
        stage: &Stage,
        [radius, farthest]: [f64; 2],
        unknowns: &mut [f64],
    ) -> Option<f64> {
        let mut responses = Responses::new(self.matrix.rod_factor(), &self.assembly, found);
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
                    slid + constraint.turned
                        + constraint.turned_motion(|edge| contact.turn_of(edge)),
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
                // Sweeps forwards and backwards: a force at one end of a chain of contacts reaches
                // the other end in one sweep.
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
    /// A contact with points that have `slid` by this distance since the step began, m.
    fn new(constraint: &ContactConstraint, slid: Vector3) -> Self {
        let normal = constraint.normal;
        Self {
            start: slid + normal * (constraint.gap - normal.dot(&slid)),
            rest: 0.0,
            force: constraint.force,
            response: None,
        }
    }

    /// Sets the force that the laws of this contact require while all others are fixed; returns
    /// the change, N.
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
