//! Friction coefficients of bodies.
//!
//! A coefficient belongs to a pair of surfaces, and no law gives it for a pair from those of other
//! pairs. Here bodies may have a coefficient of their own: it holds where they touch bodies without
//! one. Where both have one, it is their geometric mean, which is symmetric and zero if either
//! surface has no friction. Bodies without one have the coefficient of the contact model with each
//! other. A node has the mean of both edges.

use super::contact_system::ContactSystem;
use super::contacts::CandidatePair;
use super::plane::ContactPlane;
use super::surface::{ContactNode, ContactSurface};

/// The coefficient between two bodies with these of their own; `None` if neither has one.
fn combined(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    match (one, other) {
        (Some(one), Some(other)) => Some((one * other).sqrt()),
        _ => one.or(other),
    }
}

impl ContactSurface {
    /// Sets the own friction coefficients of the edges of the rod that was added last.
    pub fn set_frictions(&mut self, frictions: &[Option<f64>]) {
        let first = self.edges.len() - frictions.len();
        for (edge, friction) in self.edges[first..].iter_mut().zip(frictions) {
            edge.friction = *friction;
        }
        self.has_own_frictions |= frictions.iter().any(Option::is_some);
    }

    /// The coefficients that rods, free bodies and obstacles have of their own.
    fn own_frictions(&self) -> impl Iterator<Item = Option<f64>> {
        let of_rods = self.rod_edges().iter().map(|edge| edge.friction);
        of_rods.chain(self.frictions.iter().copied())
    }

    /// The edge of the same rod that ends at a node where another edge starts, if any of its edges
    /// has a friction coefficient of its own.
    fn edge_before(&self, node: usize, edge: usize) -> Option<usize> {
        if !self.has_own_frictions || self.edges[edge].nodes[0] != node {
            return None;
        }
        let rod = self.edges[edge].rod;
        let ends_here = |one: &usize| self.edges[*one].nodes[1] == node;
        let is_own = |one: &usize| self.edges[*one].rod == rod;
        let before = edge.checked_sub(1).filter(is_own);
        match before {
            Some(before) => Some(before).filter(ends_here),
            // The first edge of a closed rod.
            None => (edge + 1..self.edges.len())
                .take_while(is_own)
                .find(ends_here),
        }
    }

    /// Own friction coefficient of a body.
    fn own_friction(&self, body: usize) -> Option<f64> {
        match self.obstacle_of(body) {
            Some(obstacle) => self.frictions[obstacle],
            None => match self.edges.get(body) {
                Some(edge) => edge.friction,
                None => self.faces()[body - self.edges.len()].friction,
            },
        }
    }
}

impl ContactSystem {
    /// Friction coefficient of a pair.
    pub(super) fn friction_between(&self, pair: &CandidatePair) -> f64 {
        let [first, second] = pair.edges;
        let other = self.surface.own_friction(second);
        match pair.is_of_node() {
            true => self.friction_of_node(pair.nodes[0], first, other),
            false => self.friction_of_edge(first, other),
        }
    }

    /// Friction coefficient between a node and a plane.
    pub(super) fn friction_over(&self, plane: &ContactPlane, own: &ContactNode) -> f64 {
        self.friction_of_node(own.node, own.edge, plane.friction)
    }

    /// Friction coefficient of a node of an edge with a body that may have its `own`.
    fn friction_of_node(&self, node: usize, edge: usize, own: Option<f64>) -> f64 {
        let after = self.friction_of_edge(edge, own);
        match self.surface.edge_before(node, edge) {
            Some(before) => 0.5 * (self.friction_of_edge(before, own) + after),
            None => after,
        }
    }

    fn friction_of_edge(&self, edge: usize, own: Option<f64>) -> f64 {
        combined(self.surface.own_friction(edge), own).unwrap_or(self.parameters.friction)
    }

    /// A bound of all friction coefficients: the largest of the contact model, rods, free bodies,
    /// planes and obstacles.
    pub(crate) fn largest_friction(&self) -> f64 {
        let planes = self.planes.iter().map(|plane| plane.friction);
        planes
            .chain(self.surface.own_frictions())
            .flatten()
            .fold(self.parameters.friction, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_coefficients_have_a_symmetric_mean() {
        for (one, other, expected) in [
            (None, None, None),
            (Some(0.3), None, Some(0.3)),
            (None, Some(0.2), Some(0.2)),
            (Some(0.5), Some(0.02), Some(0.1)),
            (Some(0.0), Some(0.7), Some(0.0)),
        ] {
            let found = [combined(one, other), combined(other, one)];
            for found in found {
                let error = found.unwrap_or(0.0) - expected.unwrap_or(0.0);
                assert!(found.is_some() == expected.is_some() && error.abs() < 1e-15);
            }
        }
    }
}
