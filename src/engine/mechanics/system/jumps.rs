//! Jumps of the velocity at contacts.

use super::System;
use crate::mechanics::Vector3;
use crate::mechanics::rod::topology::position;

/// Change of the normal velocity of a contact in a step, relative to the faster of its two values,
/// from which on it is a jump.
const JUMP: f64 = 0.3;
/// Way, as a fraction of the distance tolerance δ, that a jump must change in a step to count: the
/// contact does not resolve it.
const UNRESOLVED: f64 = 0.02;

/// Velocities of all unknowns, in m/s and rad/s: at the start of a step, at its end as earlier
/// steps predict them, and at its end.
#[derive(Clone, Copy)]
pub(crate) struct Velocities<'a> {
    pub start: &'a [f64],
    pub predicted: &'a [f64],
    pub end: &'a [f64],
}

impl System {
    /// Work that the normal forces of the contacts of the last evaluation do on jumps of their
    /// velocities within a step (s), J: the sum of ½ h F |u − u*| over contacts whose normal
    /// velocity u differs from the predicted u* as if the rods had collided. 0 if there is none.
    pub(crate) fn work_of_jumps(&self, step: f64, velocities: &Velocities<'_>) -> f64 {
        let Some(contact) = self.contact() else {
            return 0.0;
        };
        let negligible = UNRESOLVED * contact.parameters().distance_tolerance / step;
        let work = |force: f64, powers: [f64; 3]| {
            let [start, predicted, end] = powers;
            let jump = (end - predicted).abs();
            let is_jump = jump >= JUMP * start.abs().max(end.abs()) && jump >= negligible * force;
            if is_jump { 0.5 * step * jump } else { 0.0 }
        };
        let of_nodes = [velocities.start, velocities.predicted, velocities.end];
        let of_pairs = contact.contacts().iter().map(|pair| {
            let corners = || pair.nodes.iter().zip(pair.force.chunks_exact(3));
            let power = |of: &[f64]| -> f64 {
                let parts = corners().map(|(&node, force)| {
                    let velocity = match contact.is_of_rod(node) {
                        true => contact.motion_of_point(node, |node| position(of, node)),
                        false => contact.vertex_motion(node) / step,
                    };
                    Vector3::from_column_slice(force).dot(&pair.normal) * pair.normal.dot(&velocity)
                });
                parts.sum::<f64>() / pair.normal.norm_squared()
            };
            work(pair.normal_force.abs(), of_nodes.map(power))
        });
        let of_planes = contact.plane_contacts().iter().map(|touched| {
            let normal = &contact.planes()[touched.plane].normal;
            let power = |of: &[f64]| {
                let velocity = contact.motion_of_point(touched.node, |node| position(of, node));
                touched.normal_force * normal.dot(&velocity)
            };
            work(touched.normal_force, of_nodes.map(power))
        });
        of_pairs.chain(of_planes).sum()
    }
}
