//! Contacts with two prescribed points: of nodes held by clamps, of held rods, and of obstacles.
//!
//! A contact force cannot move such points, so no law determines it: the constraints that hold
//! them balance any force. Every model sets the force to zero. Overlaps due to moving clamps are
//! still checked.
//!
//! As the contact point approaches a held end of an edge, the weight of its free node in the
//! contact goes to zero, and the force on that node with it. So forces on free nodes do not jump.

use super::contact_system::ContactSystem;
use super::contacts::Proximity;

impl ContactSystem {
    /// Sets whether the position of each node of the rods is prescribed.
    pub(crate) fn set_prescribed(&mut self, prescribed: impl Iterator<Item = bool>) {
        self.prescribed.clear();
        self.prescribed.extend(prescribed);
        if let Some(curves) = &self.curves {
            self.prescribed = curves.all(&self.prescribed);
        }
    }

    /// Whether the position of a node is prescribed; always true for vertices of obstacles.
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

    /// Contacts of prescribed points that touched at the last evaluation, without a force.
    pub(super) fn touching_without_force(&self) -> impl Iterator<Item = Proximity> {
        self.without_force.iter().copied()
    }
}
