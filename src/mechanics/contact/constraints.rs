//! Contacts as constraints on the motion: what the complementarity model needs of the geometry (thesis 3.3).
//!
//! Near a configuration q the gap and the slip of a contact are linear in the displacements of its nodes,
//!
//! w_n = g + n·Σ w_m δx_m,   w_t = t·Σ w_m (x_m − x_mⁿ + δx_m),
//!
//! with the weights w of the contact points, which are also those by which a force at the contact points acts on the
//! nodes. The forces that the model has found stay as they are, in direction and weights, until it
//! finds new ones.

use super::candidates::approach;
use super::closest_points::ClosestPoints;
use super::contact_system::ContactSystem;
use super::contacts::{ActiveContact, Bodies, ContactConstraint, PlaneContact};
use crate::mechanics::Vector3;

impl ContactSystem {
    /// Lists the contacts that the unhindered motion from `positions`, of at most `reaches` (m) per node, may close,
    /// without forces. Friction slows the motion since `previous`.
    pub fn list_constraints(&mut self, positions: &[Vector3], reaches: &[f64]) {
        let slack = self.parameters().reach();
        self.constraints.clear();
        self.candidates.motion(positions, &mut self.motion);
        let pairs = self.candidates.pairs().iter().zip(self.candidates.gaps());
        for (candidate, (pair, earlier)) in pairs.enumerate() {
            let closing = approach(pair, reaches) + slack;
            if earlier - approach(pair, &self.motion) >= closing {
                continue;
            }
            let closest = ClosestPoints::of(&pair.nodes.map(|node| positions[node]));
            let (distance, threshold) = (closest.distance(), self.surface.threshold(pair.edges));
            if distance - threshold < closing {
                self.constraints.push(ContactConstraint::new(
                    Bodies::Edges(candidate),
                    pair.nodes,
                    closest.weights(),
                    closest.separation / distance,
                    [distance - threshold, threshold, self.parameters().friction],
                ));
            }
        }
        for (index, plane) in self.planes.iter().enumerate() {
            for surface in self.surface.nodes() {
                let (node, radius) = (surface.node, surface.radius);
                let gap = plane.distance(&positions[node]) - radius;
                if gap < reaches[node] + slack {
                    self.constraints.push(ContactConstraint::new(
                        Bodies::Plane(index),
                        [node; 4],
                        [1.0, 0.0, 0.0, 0.0],
                        plane.normal,
                        [gap, radius, plane.friction],
                    ));
                }
            }
        }
    }

    /// The contacts that [`Self::list_constraints`] found.
    pub fn constraints(&self) -> &[ContactConstraint] {
        &self.constraints
    }

    /// Gives the listed contacts their forces, N, and drops those without; `components` has the component along the normal
    /// for each, or those along all three axes of its frame.
    pub fn load_constraints(&mut self, components: &[f64]) {
        let directions = components.len() / self.constraints.len().max(1);
        for (constraint, components) in self
            .constraints
            .iter_mut()
            .zip(components.chunks(directions.max(1)))
        {
            let axes = constraint.frame.iter().zip(components);
            constraint.force = axes.map(|(axis, component)| axis * *component).sum();
        }
        self.constraints
            .retain(|constraint| constraint.force != Vector3::zeros());
    }

    /// Drops all constraints with their forces.
    pub fn release_constraints(&mut self) {
        self.constraints.clear();
    }

    /// Writes the forces of the loaded constraints as contacts, with the gaps at `positions`.
    pub(super) fn evaluate_constraints(&mut self, positions: &[Vector3]) {
        for constraint in &self.constraints {
            let ContactConstraint {
                nodes,
                weights,
                force,
                threshold,
                ..
            } = *constraint;
            let normal_force = force.dot(&constraint.frame[0]);
            match constraint.bodies {
                Bodies::Edges(candidate) => self.contacts.push(ActiveContact {
                    candidate,
                    nodes,
                    distance: ClosestPoints::of(&nodes.map(|node| positions[node])).distance(),
                    threshold,
                    normal: constraint.frame[0],
                    normal_force,
                    force: std::array::from_fn(|row| weights[row / 3] * force[row % 3]),
                }),
                Bodies::Plane(plane) => self.plane_contacts.push(PlaneContact {
                    node: nodes[0],
                    plane,
                    distance: self.planes[plane].distance(&positions[nodes[0]]),
                    threshold,
                    normal_force,
                    force: force.into(),
                }),
            }
        }
        self.contact_count = self.constraints.len();
    }
}
