//! Dependence of contact on the state at the start of a step, for adjoints of motions. Friction
//! depends on the positions at the start. The contact stiffness depends on the previous stiffness,
//! on the forces at the prediction, and on the energies that bound its rise
//! ([`super::contact_stiffness`]).

use super::contact::Contact;
use super::contact_stiffness::{
    LimitedBy, MADE, StaticForce, allowed_by_contacts, stored_at_start,
};
use super::term::Kind;
use super::{Stage, System, WholeMatrix, copy_positions};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ActiveLaw, Adaption, ContactSystem, FromStart};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::{add_to_node, position};

/// Relative change of the stiffness for differences of its bound, which is a piecewise rational
/// function of the stiffness.
const PART: f64 = 1e-5;

/// Rule by which the contact stiffness of a step was determined.
pub(crate) struct StiffnessCourse {
    /// The forces at the prediction determined it.
    pub adaption: Adaption,
    /// Transposed Jacobian of these forces.
    pub jacobian: WholeMatrix,
    /// Force without inertia that determined it instead, in an impact.
    pub without_inertia: Option<StaticForce>,
    /// Derivatives of the bound if energies bound the rise of the stiffness, or the speed of the
    /// rods.
    pub bound: Option<StiffnessBound>,
}

/// Derivatives of a stiffness with a rise bounded by energies.
pub(crate) struct StiffnessBound {
    /// With respect to the previous stiffness, and to the stiffness that the forces require.
    pub stiffness: [f64; 2],
    /// With respect to the unknowns at the start of the step, and to the velocities at the start
    /// of the stage.
    pub start: Vec<f64>,
    pub velocity: Vec<f64>,
    /// With respect to the unknowns of the prediction; the entry of an angle is the derivative
    /// with respect to the spin of the frame.
    pub prediction: Vec<f64>,
}

impl StiffnessBound {
    /// Derivatives if the stiffness that the forces require is limited before.
    fn after(mut self, limit: &Self) -> Self {
        let [before, wanted] = self.stiffness;
        self.stiffness = [before + wanted * limit.stiffness[0], 0.0];
        let velocities = self.velocity.iter_mut().zip(&limit.velocity);
        velocities.for_each(|(own, limited)| *own += wanted * limited);
        self
    }
}

/// Ratio of the stiffness of an active set to that of the rods. The inverse of the ratio is the
/// relative violation of the constraints. The ratio also limits the digits that rounding leaves of
/// the rods' own stiffness.
const SHUT: f64 = 1e7;

impl System {
    /// Sets the contacts that pressed in a step by complementarity as laws for derivatives, at the
    /// solution of the step.
    ///
    /// # Errors
    /// The reason why there are no such laws.
    pub(crate) fn set_active_laws(
        &mut self,
        laws: Vec<ActiveLaw>,
        unknowns: &[f64],
        stage: &Stage,
    ) -> Result<(), &'static str> {
        let Some(mut contact) = self.terms.contact.model.take() else {
            return Ok(());
        };
        // The rods alone.
        self.linearize(unknowns, Some(stage));
        copy_positions(unknowns, &mut self.terms.contact.positions);
        let stiffness = |nodes: &[usize; 4], weights: &[f64; 4], normal: &Vector3| {
            let mut stiffness = [0.0, 0.0];
            let corners = nodes.iter().zip(weights);
            for (&node, weight) in corners.filter(|(node, _)| self.assembly.is_free(**node)) {
                let own = self.matrix.of_position(node) * (weight * weight * SHUT);
                stiffness[0] += normal.dot(&(own * normal));
                stiffness[1] += 0.5 * (own.trace() - normal.dot(&(own * normal)));
            }
            stiffness
        };
        let positions = &self.terms.contact.positions;
        let set = contact.set_active_laws(laws, positions, &stage.positions, stiffness);
        self.terms.contact.model = Some(contact);
        set
    }

    /// Contacts that pressed in the last step, if contact is by complementarity.
    pub(crate) fn pressing(&self) -> Vec<ActiveLaw> {
        match self.contact() {
            Some(contact) if self.has_constraints() => contact.pressing(),
            _ => Vec::new(),
        }
    }

    /// Copies the laws for derivatives of another simulation.
    pub(crate) fn share_active_laws(&mut self, other: &Self) {
        if let (Some(own), Some(other)) = (&mut self.terms.contact.model, other.contact()) {
            own.share_active_laws(other.active_laws());
        }
    }

    /// Removes the laws for derivatives.
    pub(crate) fn clear_active_laws(&mut self) {
        if let Some(contact) = &mut self.terms.contact.model {
            contact.clear_active_laws();
        }
    }

    /// Contacts of the last evaluation that depend on the start of the step, as functions of it.
    pub(crate) fn contacts_from_start(&self, unknowns: &[f64], stage: &Stage) -> Vec<FromStart> {
        let Some(contact) = self.contact() else {
            return Vec::new();
        };
        let mut positions = stage.positions.clone();
        copy_positions(unknowns, &mut positions);
        contact.dependence_on_start(&positions, &stage.positions, stage.step)
    }

    /// Derivative of −λ·R with respect to the contact stiffness k, for a virtual motion λ at the
    /// last evaluation.
    pub(crate) fn work_over_contact_stiffness(&self, motion: &[f64]) -> f64 {
        let work =
            |contact: &ContactSystem| contact.work_over_stiffness(|node| position(motion, node));
        self.contact().map_or(0.0, work)
    }

    /// Rule by which the stiffness `adapted` followed from the stiffness `before` at `unknowns`,
    /// the prediction of a step, and was bounded if it `may_bound`; `None` if the rule cannot be
    /// reproduced. The last evaluation is then the one at `unknowns` without contact.
    pub(crate) fn stiffness_course(
        &mut self,
        unknowns: &[f64],
        stage: &Stage,
        [before, adapted]: [f64; 2],
        may_bound: bool,
    ) -> Option<StiffnessCourse> {
        let mut contact = self.terms.contact.model.take()?;
        let used = contact.stiffness();
        let jacobian = self.linearize_transposed(unknowns, Some(stage));
        self.take_forces(unknowns);
        let Contact {
            positions, forces, ..
        } = &self.terms.contact;
        let found = contact.adaption(positions, forces, before);
        let course = found.and_then(|(wanted, adaption)| {
            let limit = self.limit_of_reaction(&contact, adaption, unknowns, stage);
            let limited = match may_bound {
                true => limit.applied(before, wanted),
                false => wanted,
            };
            let mut without_inertia = None;
            let of_limit = match limit.by {
                _ if limited == wanted => None,
                LimitedBy::Force(force) if limited > before => {
                    without_inertia = Some(force);
                    None
                }
                by => Some(self.bound_by_speed(&by, limited > before, stage)),
            };
            let bound = if adapted == limited {
                of_limit
            } else {
                let found = self.stiffness_bound(&mut contact, [before, limited], unknowns, stage);
                let (bounded, mut bound) = found?;
                self.gather_changes(unknowns, &mut bound.prediction);
                let is_same = (bounded - adapted).abs() <= PART * PART * adapted;
                let bound = is_same.then_some(bound)?;
                Some(match of_limit {
                    Some(limit) => bound.after(&limit),
                    None => bound,
                })
            };
            Some(StiffnessCourse {
                adaption,
                jacobian,
                without_inertia,
                bound,
            })
        });
        contact.set_stiffness(used);
        self.terms.contact.model = Some(contact);
        course
    }

    /// Derivatives of a stiffness that has risen to the limit set by a speed, or of one that has not
    /// risen.
    fn bound_by_speed(&self, by: &LimitedBy, rises: bool, stage: &Stage) -> StiffnessBound {
        let none = vec![0.0; stage.velocity.len()];
        let mut bound = StiffnessBound {
            stiffness: [1.0, 0.0],
            start: none.clone(),
            velocity: none.clone(),
            prediction: none,
        };
        if rises {
            bound.stiffness = [0.0; 2];
        }
        if let LimitedBy::Speed(node, factor) = by
            && rises
            && !self.assembly.held[STRIDE * node]
        {
            let velocity = position(&stage.velocity, *node) * *factor;
            add_to_node(&mut bound.velocity, *node, &velocity);
        }
        bound
    }

    /// Bound on a rise of the stiffness, k = k₀ + (k₁ − k₀) A/U, with the allowed energy A and the
    /// added energy U; and its derivatives.
    fn stiffness_bound(
        &self,
        contact: &mut ContactSystem,
        [before, wanted]: [f64; 2],
        unknowns: &[f64],
        stage: &Stage,
    ) -> Option<(f64, StiffnessBound)> {
        let places = &self.terms.contact.step_start;
        let others = MADE * (self.kinetic_energy_at_start(stage) + self.elastic_energy().total());
        let mut energies = |[before, wanted]: [f64; 2]| {
            let stored = stored_at_start(contact, before, places);
            let after = stored_at_start(contact, wanted, places);
            let allowed = allowed_by_contacts(contact, after) + others;
            (allowed, after.energy - stored.energy)
        };
        let mut bounded = |at: [f64; 2]| {
            let (allowed, made) = energies(at);
            at[0] + (at[1] - at[0]) * allowed / made
        };
        let stiffness = [0, 1].map(|which| {
            let mut moved = |part: f64| {
                let mut at = [before, wanted];
                at[which] *= 1.0 + part;
                bounded(at)
            };
            (moved(PART) - moved(-PART)) / (2.0 * PART * [before, wanted][which])
        });
        let found = bounded([before, wanted]);
        let (allowed, made) = energies([before, wanted]);
        if !(made > allowed) {
            return None;
        }
        let per_allowed = (wanted - before) / made;
        let mut start = vec![0.0; unknowns.len()];
        for (k, sign) in [(wanted, 1.0), (before, -1.0)] {
            contact.set_stiffness(k);
            let factor = -sign * per_allowed * allowed / made;
            contact.add_gradient_at_start(places, factor, &mut |node, gradient| {
                for axis in 0..3 {
                    start[STRIDE * node + axis] += gradient[axis];
                }
            });
        }
        let momenta = self.assembly.masses.iter().zip(&stage.velocity);
        let momenta = momenta.zip(&self.assembly.held);
        let velocity = momenta.map(|((mass, velocity), held)| match held {
            true => 0.0,
            false => per_allowed * MADE * mass * velocity,
        });
        let velocity = velocity.collect();
        let mut prediction = vec![0.0; unknowns.len()];
        let at = self.at(unknowns, Some(stage));
        let elastic = (self.terms.all().into_iter()).filter(|term| term.kind() == Kind::Elastic);
        elastic.for_each(|term| term.add_forces(&at, &mut prediction));
        (prediction.iter_mut()).for_each(|force| *force *= per_allowed * MADE);
        let bound = StiffnessBound {
            stiffness,
            start,
            velocity,
            prediction,
        };
        Some((found, bound))
    }
}
