//! Contacts of free bodies with friction at their surfaces.

use super::body_turns::{Spin, SpunContact};
use super::contact_system::ContactSystem;
use super::contacts::{CandidatePair, ContactMotion, EDGE};
use super::edge_contact::Sliding;
use super::edge_turn::EdgeTurn;
use super::evaluation::Motion;
use super::multipliers::LinearLaw;
use super::tractions::{LinearTraction, correction};
use crate::mechanics::Vector3;

impl ContactSystem {
    /// Sets the rotation vectors of the free bodies since the stage began, rad.
    pub(crate) fn set_body_turns(&mut self, turns: impl Iterator<Item = Vector3>) {
        let own = self.body_turns.turns.iter_mut();
        own.zip(turns).for_each(|(own, turn)| *own = turn);
    }

    /// Rotation of the free bodies of a pair, and of a rod's edge at such a body; `None` if there is
    /// no free body.
    pub(super) fn spin_of_pair(&self, pair: &CandidatePair, motion: &Motion) -> Option<Spin> {
        let ends = [pair.nodes[0], pair.nodes[3]];
        let mut spin = self.body_turns.spin(ends, motion.time_step)?;
        if pair.side == EDGE {
            for (side, edge) in pair.edges.into_iter().enumerate() {
                let [from, to] = [pair.nodes[2 * side], pair.nodes[2 * side + 1]];
                let is_of_rod = self.is_of_rod(from) && self.body_turns.body_of(from).is_none();
                if is_of_rod && from != to {
                    let span = |of: &[Vector3]| of[to] - of[from];
                    let arm = self.surface.edges()[edge].radius;
                    let sides = [motion.previous, motion.positions].map(span);
                    spin.edges[side] = Some(EdgeTurn::between(&sides[0], &sides[1], arm));
                }
            }
        }
        Some(spin)
    }

    /// Rotation of the free body of a node over a plane; `None` if it has none.
    pub(super) fn spin_over_plane(&self, node: usize, time_step: f64) -> Option<Spin> {
        self.body_turns.spin([node, usize::MAX], time_step)
    }

    /// A contact of free bodies in a slot with its derivatives, from the linear laws of that slot;
    /// its present normal force (N) and traction are given.
    pub(super) fn linearize_spun(
        &mut self,
        (slot, spin): (usize, &Spin),
        place: &ContactMotion,
        (force, traction): (f64, Vector3),
        (pressure, friction): (&LinearLaw, &LinearTraction),
        sliding: &Sliding,
    ) -> Option<SpunContact> {
        let normal = &place.normal;
        let rates = spin.rates(place, &pressure.tangent, (sliding, friction.slip));
        if self.multipliers.in_use() {
            self.multipliers.keep(slot, pressure, &place.gap_gradient);
            self.carried_tractions
                .keep_spun(slot, friction, &rates.by_nodes, &rates.by_turns);
        }
        let rubbed = |force: f64, traction: &Vector3| traction * (force * normal.norm());
        let with = |force: f64, traction: &Vector3| -> [f64; 6] {
            let [first, second] = spin.moments(normal, &rubbed(force, traction));
            [first.x, first.y, first.z, second.x, second.y, second.z]
        };
        let [a, b, c, d, e, f] = correction(pressure, friction, with(force, &traction), with);
        Some(SpunContact {
            corrections: [Vector3::new(a, b, c), Vector3::new(d, e, f)],
            jacobian: Some(rates.jacobian),
            ..spin.contact(normal, &rubbed(force, &traction))
        })
    }

    /// The contacts of free bodies with friction at the last evaluation, in the order of
    /// [`Self::contacts`]; empty without free bodies.
    pub(crate) fn spun(&self) -> &[Option<SpunContact>] {
        &self.spun
    }

    /// The same in the order of [`Self::plane_contacts`].
    pub(crate) fn plane_spun(&self) -> &[Option<SpunContact>] {
        &self.plane_spun
    }

    /// All of them.
    pub(crate) fn all_spun(&self) -> impl Iterator<Item = &SpunContact> {
        self.spun.iter().chain(&self.plane_spun).flatten()
    }

    /// Whether there are free bodies.
    pub(super) fn has_bodies(&self) -> bool {
        !self.body_turns.radii.is_empty()
    }
}
