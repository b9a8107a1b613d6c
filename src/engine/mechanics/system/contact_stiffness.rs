//! The contact stiffness of a step, and the energy added by its change.
//!
//! A contact that carries a force stores the energy k φ(g) at its gap g. When its stiffness k
//! rises from one step to the next, as it does with the contact forces, the gap is still that of
//! the softer contact, so the energy rises spuriously with k. Under typical contact forces the
//! increase is a force times a fraction of δ, and is lost again as contacts open. Rods that collide
//! at high speed, however, penetrate far into a soft contact. If this contact becomes a thousand
//! times as stiff, it pushes the rods apart with many times their initial energy. So k rises only
//! as far as the added energy is small.
//!
//! This bound is one for each step. Steps that resolve an impact need another one. The force
//! without contact that decelerates a node is the reaction of the contact itself, and is in
//! proportion to k while the gap hardly changes from step to step. A rule k = s F would then raise k
//! by the same factor in each of these steps, until the contact opens with many times the energy of
//! the impact, the more the smaller the steps. So k rises for no more than [`STATIC`] times the force
//! without inertia, or the force that stops the node within [`STOPPING`] times δ if this is larger:
//! F = m v²/(2 · 5 δ), where v is the largest speed in the scene. The energy of contacts that carry
//! F is then at most a part of that of the node. For a vertex of a free body, the force without
//! inertia is that on the body, and m is the mass felt at the vertex. In steps longer than 10 δ/v,
//! which do not resolve an impact, the forces m v/h are smaller, and the limit does not act. The
//! midpoint rule has neither bound, since it extrapolates through contacts that are too soft.

use super::contact::Contact;
use super::{Stage, System, copy_positions};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{Adaption, ContactSystem, Stored};
use crate::mechanics::rod::{STRIDE, topology::position};

/// Energy that a rise of the stiffness may add, relative to the kinetic and elastic energy of the
/// scene.
pub(super) const MADE: f64 = 1e-4;
/// Energy that a rise may add per contact, relative to the work over δ of the force that causes
/// the rise, which is the energy of contacts that carry this force.
const MADE_BY_CONTACT: f64 = 0.2;
/// Multiple of the force without inertia for which k may rise in an impact.
const STATIC: f64 = 2.0;
/// Distance within which the force for which k may rise stops a node, relative to δ.
const STOPPING: f64 = 5.0;

/// Limit of a stiffness that rises in an impact.
pub(super) struct ReactionLimit {
    /// The largest stiffness allowed.
    pub stiffness: f64,
    /// What determines it.
    pub by: LimitedBy,
}

impl ReactionLimit {
    /// The stiffness `wanted` after the stiffness `before`, as far as it may rise.
    pub(super) fn applied(&self, before: f64, wanted: f64) -> f64 {
        wanted.min(self.stiffness.max(before))
    }
}

/// What determines the limit of a stiffness.
pub(super) enum LimitedBy {
    Nothing,
    /// The speed of a node, and the derivative of the limit with respect to its velocity over this
    /// velocity.
    Speed(usize, f64),
    Force(StaticForce),
}

/// The force on a node without contact and inertia, R − m a.
pub(crate) struct StaticForce {
    pub node: usize,
    /// Derivative of the limit with respect to the force.
    pub slope: Vector3,
    /// Derivative of m a with respect to the velocity at the end of the stage, kg/s, and with
    /// respect to the position there, N/m.
    pub inertia: [f64; 2],
}

impl System {
    /// Adapts the contact stiffness to the forces without contact at `unknowns` (thesis Eqs. 2.18, 2.19).
    pub(crate) fn adapt_contact_stiffness(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        let Some(mut contact) = self.terms.contact.model.take() else {
            return;
        };
        let may_touch = !contact.candidates().is_empty() || self.terms.contact.has_planes;
        if may_touch && !contact.parameters().is_complementarity() {
            self.evaluate(unknowns, stage);
            self.take_forces(unknowns);
            contact.adapt_stiffness(&self.terms.contact.positions, &self.terms.contact.forces);
        }
        self.terms.contact.model = Some(contact);
    }

    /// Lowers a stiffness that has risen from `before` because of the reaction of contacts to an
    /// impact, which it would increase.
    fn bound_reaction(
        &self,
        contact: &mut ContactSystem,
        before: f64,
        unknowns: &[f64],
        stage: &Stage,
    ) {
        let wanted = contact.stiffness();
        if wanted <= before {
            return;
        }
        let Contact {
            positions, forces, ..
        } = &self.terms.contact;
        if let Some((_, adaption)) = contact.adaption(positions, forces, before) {
            let limit = self.limit_of_reaction(contact, adaption, unknowns, stage);
            contact.set_stiffness(limit.applied(before, wanted));
        }
    }

    /// Limit of a stiffness that rises because of the reaction of contacts to an impact.
    pub(super) fn limit_of_reaction(
        &self,
        contact: &ContactSystem,
        adaption: Adaption,
        unknowns: &[f64],
        stage: &Stage,
    ) -> ReactionLimit {
        let Adaption::OfForce { node, factor } = adaption else {
            return ReactionLimit {
                stiffness: f64::INFINITY,
                by: LimitedBy::Nothing,
            };
        };
        let touching = contact.node_of(node);
        let node = self.carrier(touching);
        let mass = self.assembly.masses[STRIDE * node];
        let velocity = |node: usize| position(&stage.velocity, node);
        let predicted = (position(unknowns, node) - position(&stage.start, node)) / stage.step;
        let acceleration = (predicted - velocity(node)) / stage.acceleration_step;
        // Forces without contact are those that contacts carry, m a − f.
        let without_inertia = self.terms.contact.forces[node] - acceleration * mass;
        let speeds =
            (0..self.terms.contact.forces.len()).map(|node| (node, velocity(node).norm_squared()));
        let fastest = speeds.max_by(|one, other| one.1.total_cmp(&other.1));
        let (fastest, square) = fastest.unwrap_or((node, 0.0));
        let distance = STOPPING * contact.parameters().distance_tolerance;
        let mut felt = self.assembly.masses_at_vertices();
        let felt = felt.find(|(vertex, _)| *vertex == touching);
        let stopped = felt.map_or(mass, |(_, mass)| mass);
        let stopping = 0.5 * stopped * square / distance;
        let other = STATIC * without_inertia.norm();
        ReactionLimit {
            stiffness: factor * stopping.max(other),
            by: if stopping > other {
                LimitedBy::Speed(fastest, factor * stopped / distance)
            } else {
                let per_velocity = mass / stage.acceleration_step;
                LimitedBy::Force(StaticForce {
                    node,
                    slope: without_inertia.try_normalize(0.0).unwrap_or_default()
                        * (factor * STATIC),
                    inertia: [per_velocity, per_velocity / stage.step],
                })
            },
        }
    }

    /// The node whose inertia a contact force at a node moves: the centre of a free body for one of
    /// its vertices, which have no mass.
    fn carrier(&self, node: usize) -> usize {
        let mut frames = self.assembly.joints.free_frames();
        let own = frames.find(|(_, _, vertices)| vertices.nodes().contains(&node));
        own.map_or(node, |(_, _, vertices)| vertices.centre)
    }

    /// Stores positions and forces of an evaluation without contact.
    pub(super) fn take_forces(&mut self, unknowns: &[f64]) {
        for node in 0..self.terms.contact.forces.len() {
            let held = self.assembly.held[STRIDE * node];
            self.terms.contact.forces[node] = if held {
                Vector3::zeros()
            } else {
                position(&self.residual, node)
            };
        }
        // Each vertex may carry all of the force on its body.
        for (_, _, vertices) in self.assembly.joints.free_frames() {
            let forces = &mut self.terms.contact.forces;
            let whole = forces[vertices.centre];
            forces[vertices.nodes()].fill(whole);
        }
        copy_positions(unknowns, &mut self.terms.contact.positions);
    }

    /// Contact stiffness k; zero without contact.
    pub(crate) fn contact_stiffness(&self) -> f64 {
        self.contact().map_or(0.0, ContactSystem::stiffness)
    }

    /// Restores the previous contact stiffness when a step is repeated.
    pub(crate) fn restore_contact_stiffness(&mut self, stiffness: f64) {
        if let Some(contact) = &mut self.terms.contact.model {
            contact.set_stiffness(stiffness);
        }
    }

    /// Energy that the change of the contact stiffness from `before` has added in this step, J.
    pub(crate) fn energy_of_stiffening(&mut self, before: f64) -> f64 {
        let Some(contact) = &mut self.terms.contact.model else {
            return 0.0;
        };
        let now = contact.stiffness();
        if now == before {
            return 0.0;
        }
        let stored = stored_at_start(contact, before, &self.terms.contact.step_start).energy;
        stored_at_start(contact, now, &self.terms.contact.step_start).energy - stored
    }

    /// Lowers a contact stiffness that has risen from `before`, adapted to the forces at `unknowns`,
    /// as far as the reaction of contacts to an impact and the contact energy at the start of a
    /// step require.
    pub(crate) fn bound_contact_stiffness(&mut self, before: f64, unknowns: &[f64], stage: &Stage) {
        if let Some(mut contact) = self.terms.contact.model.take() {
            self.bound_reaction(&mut contact, before, unknowns, stage);
            self.bound_stiffness(&mut contact, before, stage);
            self.terms.contact.model = Some(contact);
        }
    }

    /// Increases the contact stiffness by this factor, in a time step only if that adds little
    /// energy; returns whether it did. Contact by complementarity is already rigid.
    pub(crate) fn stiffen_contact(&mut self, factor: f64, stage: Option<&Stage>) -> bool {
        if self.has_constraints() {
            return false;
        }
        let Some(mut contact) = self.terms.contact.model.take() else {
            return false;
        };
        let before = contact.stiffness();
        contact.stiffen(factor);
        let wanted = contact.stiffness();
        if let Some(stage) = stage {
            self.bound_stiffness(&mut contact, before, stage);
        }
        let is_stiffer = contact.stiffness() == wanted;
        if !is_stiffer {
            contact.set_stiffness(before);
        }
        self.terms.contact.model = Some(contact);
        is_stiffer
    }

    /// Lowers a stiffness that has risen from `before` until it adds at most the allowed energy.
    fn bound_stiffness(&self, contact: &mut ContactSystem, before: f64, stage: &Stage) {
        let wanted = contact.stiffness();
        if wanted <= before {
            return;
        }
        let stored = stored_at_start(contact, before, &self.terms.contact.step_start).energy;
        if stored == 0.0 {
            return contact.set_stiffness(wanted);
        }
        let after = stored_at_start(contact, wanted, &self.terms.contact.step_start);
        let made = after.energy - stored;
        let mut allowed =
            allowed_by_contacts(contact, after) + MADE * self.kinetic_energy_at_start(stage);
        if made > allowed {
            allowed += MADE * self.elastic_energy().total();
        }
        if made > allowed {
            contact.set_stiffness(before + (wanted - before) * allowed / made);
        }
    }

    /// Kinetic energy of all free unknowns, J.
    pub(super) fn kinetic_energy_at_start(&self, stage: &Stage) -> f64 {
        let masses = self.assembly.masses.iter().zip(&self.assembly.held);
        masses
            .zip(&stage.velocity)
            .filter(|((_, held), _)| !**held)
            .map(|((mass, _), velocity)| 0.5 * mass * velocity * velocity)
            .sum()
    }
}

/// Energy that a rise to the present stiffness may add with this number of contacts, J.
pub(super) fn allowed_by_contacts(contact: &ContactSystem, stored: Stored) -> f64 {
    MADE_BY_CONTACT * stored.contacts as f64 * contact.work_over_tolerance()
}

/// Sets the stiffness k and returns the contact energy at the start of the step with it, J.
pub(super) fn stored_at_start(
    contact: &mut ContactSystem,
    stiffness: f64,
    start: &[Vector3],
) -> Stored {
    contact.set_stiffness(stiffness);
    contact.stored_at_start(start)
}
