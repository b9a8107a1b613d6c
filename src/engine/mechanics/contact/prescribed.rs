//! Contacts whose points are both prescribed: of nodes that clamps hold, of held rods, and of obstacles.
//!
//! A contact force cannot move such points, and so no law determines it: any force is balanced by what holds
//! them. Every model sets it to zero. Overlaps due to their clamps are still checked.
//!
//! The weight of a free node in a contact goes to zero as the contact point comes to the end of an edge that is held, and the
//! force on that node with it. So forces on free nodes do not jump.

use super::contact_system::ContactSystem;
use super::contacts::Proximity;

impl ContactSystem {
    /// Sets for every node of the rods whether its position is prescribed.
    pub(crate) fn set_prescribed(&mut self, prescribed: impl Iterator<Item = bool>) {
        self.prescribed.clear();
        self.prescribed.extend(prescribed);
    }

    /// Whether the position of a node is prescribed; vertices of obstacles are.
    pub(super) fn is_prescribed(&self, node: usize) -> bool {
        match self.prescribed.get(node) {
            Some(prescribed) => *prescribed,
            None => !self.is_of_rod(node),
        }
    }

    /// Whether both points of a contact with these weights are prescribed.
    pub(super) fn are_prescribed(&self, nodes: &[usize; 4], weights: &[f64; 4]) -> bool {
        let mut corners = nodes.iter().zip(weights);
        corners.all(|(node, weight)| *weight == 0.0 || self.is_prescribed(*node))
    }

    /// Prescribed points that touched at the last evaluation, without a force.
    pub(super) fn touching_without_force(&self) -> impl Iterator<Item = Proximity> {
        self.without_force.iter().copied()
    }
}
