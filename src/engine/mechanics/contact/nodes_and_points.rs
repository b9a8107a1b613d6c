//! Contact points for nodes: positions of points from nodes, and forces on nodes from points.
//!
//! The contact points of polylines are the nodes themselves; those of smooth curves are linear in
//! them ([`super::curve_points`]). All public functions of [`ContactSystem`] take positions of
//! nodes; contacts and their forces are those of points.

use super::contact_system::ContactSystem;
use super::contacts::{ActiveContact, PlaneContact};
use super::curve_points::CurvePoints;
use crate::mechanics::Vector3;
use std::borrow::Cow;
use std::sync::Arc;

impl ContactSystem {
    /// Makes contact act at the points of smooth curves; the surface must consist of these points.
    pub(crate) fn with_curves(mut self, curves: Option<CurvePoints>) -> Self {
        self.curves = curves.map(Arc::new);
        self
    }

    /// The smooth curves, if contact has smooth geometry.
    pub(crate) fn curves(&self) -> Option<&CurvePoints> {
        self.curves.as_deref()
    }

    /// Positions of the contact points for given nodes, m: these nodes themselves for polylines.
    pub(super) fn placed<'a>(&self, nodes: &'a [Vector3]) -> Cow<'a, [Vector3]> {
        match &self.curves {
            Some(curves) if !nodes.is_empty() => Cow::Owned(curves.place(nodes)),
            _ => Cow::Borrowed(nodes),
        }
    }

    /// Motion of a contact point on a rod for a motion of all nodes.
    pub(crate) fn motion_of_point(
        &self,
        point: usize,
        of_node: impl Fn(usize) -> Vector3,
    ) -> Vector3 {
        match &self.curves {
            Some(curves) => curves.interpolated(point, of_node),
            None => of_node(point),
        }
    }

    /// Spreads a force on a contact point of a rod over the nodes.
    pub(crate) fn spread(
        &self,
        point: usize,
        force: [f64; 3],
        mut add: impl FnMut(usize, [f64; 3]),
    ) {
        match &self.curves {
            Some(curves) => {
                for (node, weight) in curves.terms(point) {
                    add(node, force.map(|part| part * weight));
                }
            }
            None => add(point, force),
        }
    }

    /// The node at or before a contact point of a rod.
    pub(crate) fn node_of(&self, point: usize) -> usize {
        let curves = self.curves.as_ref();
        curves.map_or(point, |curves| curves.edge_of(point)[0])
    }

    /// The contacts of the last evaluation between edges of rods: those between chords are
    /// assigned to the edges that contain these, with the forces of the chords.
    pub(crate) fn contacts_of_edges(&self) -> Cow<'_, [ActiveContact]> {
        let Some(curves) = &self.curves else {
            return Cow::Borrowed(self.contacts());
        };
        let assigned = self.contacts().iter().map(|contact| {
            let [first, _, second, _] = contact.nodes;
            let [a, b] = curves.edge_of(first);
            let [c, d] = match self.is_of_rod(second) {
                true => curves.edge_of(second),
                // The vertices of an obstacle.
                false => [second, contact.nodes[3]],
            };
            ActiveContact {
                nodes: [a, b, c, d],
                ..*contact
            }
        });
        Cow::Owned(assigned.collect())
    }

    /// The contacts of the last evaluation with planes, at the nodes before their contact points.
    pub(crate) fn plane_contacts_of_nodes(&self) -> Cow<'_, [PlaneContact]> {
        if self.curves.is_none() {
            return Cow::Borrowed(self.plane_contacts());
        }
        let contacts = self.plane_contacts().iter();
        let at_nodes = contacts.map(|contact| PlaneContact {
            node: self.node_of(contact.node),
            ..*contact
        });
        Cow::Owned(at_nodes.collect())
    }
}
