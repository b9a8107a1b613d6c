//! The adaptive contact stiffness (thesis Eqs. 2.18, 2.19).
//!
//! k = s max‖F‖ over the nodes in contact, where F is the total force on a node without contact
//! and friction. At this stiffness a contact carries the force F within δ of touching. The barrier
//! of incremental potential contact follows the same rule, with the factor at which it carries F
//! at δ/2.
//!
//! The forces change from step to step, and the stiffness should not follow every fluctuation. The
//! contact force grows exponentially with the gap, so an error of a factor of two in the stiffness
//! moves the gap of a contact that does not penetrate by less than δ/20. So k rises to its new
//! value only if that is more than [`BAND`] times as large. If the new value is that much smaller,
//! k falls by at most this factor at a time: a peak of one step leaves the contacts of the next
//! steps stiff.
//!
//! Each pair of bodies has its own least stiffness: that for the forces that bend the softer body.

use super::candidates::approach;
use super::contact_system::ContactSystem;
use super::nearest_points::separation;
use crate::mechanics::Vector3;

/// Factor of change below which the stiffness stays the same.
const BAND: f64 = 2.0;

/// Rule for the adapted stiffness of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Adaption {
    /// A factor (J/N) times the force on a node.
    OfForce { node: usize, factor: f64 },
    /// A fraction of the previous stiffness.
    Falls(f64),
    /// The least one.
    Least,
}

/// The stiffness that follows `present`, given the largest force `force` (N), the factor s =
/// `factor` (J/N) and the least stiffness allowed.
fn adapted_stiffness(present: f64, force: f64, factor: f64, least: f64) -> f64 {
    let target = (factor * force).max(least);
    if target > BAND * present {
        target
    } else if target < present / BAND {
        target.max(present / BAND)
    } else {
        present
    }
}

impl ContactSystem {
    /// Contact stiffness k.
    pub(crate) fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Sets the least contact stiffness of every node; a contact has the smaller value of its two
    /// bodies. Use infinity for a node whose value must not count, such as that of an obstacle.
    ///
    /// A soft rod presses on a stiff one with its own, small forces.
    pub(crate) fn set_least_stiffness_of_nodes(&mut self, least: Vec<f64>) {
        self.least_of_nodes = (0..self.surface.node_count())
            .map(|point| least[self.node_of(point)])
            .collect();
    }

    /// Contact stiffness between two nodes; contact with a plane passes its node twice.
    pub(super) fn stiffness_between(&self, first: usize, second: usize) -> f64 {
        let least = match self.least_of_nodes.as_slice() {
            [] => return self.stiffness,
            nodes => {
                let of_node = |node: usize| nodes.get(node).copied().unwrap_or(f64::INFINITY);
                of_node(first).min(of_node(second))
            }
        };
        if least.is_finite() {
            self.stiffness.max(least)
        } else {
            self.stiffness
        }
    }

    /// Increases the stiffness of all contacts of the last evaluation by at least this factor.
    pub(crate) fn stiffen(&mut self, factor: f64) {
        let pairs = self.contacts.iter().map(|c| [c.nodes[0], c.nodes[3]]);
        let planes = self.plane_contacts.iter().map(|c| [c.node; 2]);
        let stiffest = pairs
            .chain(planes)
            .map(|[first, second]| self.stiffness_between(first, second))
            .fold(self.stiffness, f64::max);
        self.stiffness = factor * stiffest;
    }

    /// Sets the contact stiffness k.
    pub(crate) fn set_stiffness(&mut self, stiffness: f64) {
        self.stiffness = stiffness;
    }

    /// Product of δ and the design force of contacts at the present stiffness, J.
    pub(crate) fn work_over_tolerance(&self) -> f64 {
        let parameters = &self.parameters;
        let per_force = parameters.stiffness_per_force(self.surface.largest_moving_radius());
        self.stiffness / per_force * parameters.distance_tolerance
    }

    /// Adapts the stiffness to `forces`, the total force on every node without contact and friction, N
    /// (Eqs. 2.18, 2.19); returns whether it changed.
    ///
    /// The thesis takes the largest force over the nodes in contact. Here all nodes of pairs with
    /// surfaces nearer than a quarter of the candidates' margin count, so a contact that begins
    /// within the step has a suitable stiffness. Without such nodes the stiffness does not change.
    /// Call this once per step: the stiffness must be constant within Newton's method.
    pub(crate) fn adapt_stiffness(&mut self, positions: &[Vector3], forces: &[Vector3]) -> bool {
        let Some((_, force)) = self.largest_force_near_contact(positions, forces) else {
            return false;
        };
        let before = self.stiffness;
        let factor = self.stiffness_per_force();
        self.stiffness = adapted_stiffness(before, force, factor, self.least_stiffness);
        self.stiffness != before
    }

    /// Ratio of k to the force near contact, J/N.
    fn stiffness_per_force(&self) -> f64 {
        let radius = self.surface.largest_moving_radius();
        self.parameters.stiffness_per_force(radius)
    }

    /// The stiffness that [`Self::adapt_stiffness`] would set in place of `before`, and the rule;
    /// `None` if it does not change.
    pub(crate) fn adaption(
        &mut self,
        positions: &[Vector3],
        forces: &[Vector3],
        before: f64,
    ) -> Option<(f64, Adaption)> {
        let (node, force) = self.largest_force_near_contact(positions, forces)?;
        let factor = self.stiffness_per_force();
        let adapted = adapted_stiffness(before, force, factor, self.least_stiffness);
        let how = if adapted == before {
            return None;
        } else if adapted == factor * force {
            Adaption::OfForce { node, factor }
        } else if adapted == self.least_stiffness {
            Adaption::Least
        } else {
            Adaption::Falls(1.0 / BAND)
        };
        Some((adapted, how))
    }

    /// The node with the largest force among those near contact, and that force, N.
    fn largest_force_near_contact(
        &mut self,
        positions: &[Vector3],
        forces: &[Vector3],
    ) -> Option<(usize, f64)> {
        let (positions, forces) = (self.placed(positions), self.placed(forces));
        let (positions, forces) = (positions.as_ref(), forces.as_ref());
        let near = 0.25 * self.candidates.margin();
        // Obstacles have no forces of their own.
        let of_node = |node: usize| forces.get(node).map_or(0.0, Vector3::norm_squared);
        let mut largest: Option<(usize, f64)> = None;
        let exceeds = |force: f64, largest: Option<(usize, f64)>| {
            largest.is_none_or(|(_, largest)| force > largest)
        };
        self.candidates.motion(positions, &mut self.motion);
        let points = self.obstacles.points(positions);
        let pairs = self.candidates.pairs().iter();
        for (pair, earlier) in pairs.zip(self.candidates.gaps()) {
            let of_nodes = pair.nodes.map(|node| (node, of_node(node)));
            let (node, force) = (of_nodes.into_iter())
                .fold((pair.nodes[0], 0.0), |a, b| if b.1 > a.1 { b } else { a });
            // Most pairs have nodes whose forces are already included or are not larger.
            if exceeds(force, largest)
                && earlier - approach(pair, &self.motion) < near
                && separation(&self.surface, pair, &points)
                    .is_some_and(|distance| distance < self.surface.threshold(pair.edges) + near)
            {
                largest = Some((node, force));
            }
        }
        for (index, plane) in self.planes.iter().enumerate() {
            for surface in self.surface.nodes() {
                if self.surface.roots.frees_from_plane(surface.node, index) {
                    continue;
                }
                let force = of_node(surface.node);
                if exceeds(force, largest)
                    && plane.distance(&positions[surface.node]) < surface.radius + near
                {
                    largest = Some((surface.node, force));
                }
            }
        }
        largest.map(|(node, square)| (node, square.sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_rises_at_once_and_ignores_flicker() {
        assert_eq!(adapted_stiffness(1.0, 5e-3, 1e5, 0.1), 500.0);
        assert_eq!(adapted_stiffness(500.0, 3e-3, 1e5, 0.1), 500.0);
        assert_eq!(adapted_stiffness(500.0, 9e-3, 1e5, 0.1), 500.0);
    }

    #[test]
    fn it_falls_by_steps_to_the_least_value() {
        let mut stiffness = 1000.0;
        for expected in [500.0, 250.0, 125.0, 62.5, 31.25, 31.25] {
            stiffness = adapted_stiffness(stiffness, 0.0, 1e5, 20.0);
            assert_eq!(stiffness, expected);
        }
    }
}
