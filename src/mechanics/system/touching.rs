//! The contact model of a scene, and words for what touches.

use super::{Assembly, copy_positions};
use crate::mechanics::contact::{
    ContactPair, ContactPlane, ContactSurface, ImplicitContact, Proximity,
};
use crate::mechanics::scene::Scene;
use crate::mechanics::{Overlap, Vector3};

/// The contact model of a scene with its first candidates; `None` where everything passes through.
///
/// # Errors
/// [`Overlap`] names two bodies that overlap as placed.
pub(super) fn contact_of(
    scene: &Scene,
    assembly: &Assembly,
) -> Result<Option<ImplicitContact>, Overlap> {
    let Some(parameters) = scene.contact else {
        return Ok(None);
    };
    let mut surface = ContactSurface::new();
    for (range, rod) in assembly.rods.rods.iter().zip(&scene.rods) {
        surface.add_rod(
            range.first_node,
            &rod.centreline,
            rod.closed,
            rod.radius,
            rod.held,
        );
    }
    let planes = scene.planes.iter().map(|plane| ContactPlane {
        point: plane.point,
        normal: plane.normal,
        friction: plane.friction.unwrap_or(parameters.friction),
    });
    let stiffness_per_force = parameters.stiffness_per_force(surface.largest_moving_radius());
    let least_stiffness = stiffness_per_force * assembly.force_scale;
    let mut contact = ImplicitContact::new(parameters, surface, planes.collect(), least_stiffness);
    let mut positions = vec![Vector3::zeros(); assembly.rods.nodes];
    copy_positions(&assembly.unknowns, &mut positions);
    if let Some(overlap) = contact.initial_overlaps(&positions).first() {
        return Err(name_overlap(overlap, &contact, assembly));
    }
    contact.update_candidates(&positions);
    Ok(Some(contact))
}

/// Names the two bodies of `proximity` that are too close.
pub fn name_overlap(
    proximity: &Proximity,
    contact: &ImplicitContact,
    assembly: &Assembly,
) -> Overlap {
    let edge_name = |edge: usize| {
        let edge = contact.surface().edges()[edge];
        let (rod, node) = assembly.locate(edge.nodes[0]);
        format!("edge {node} of rod `{}`", assembly.names[rod])
    };
    let (first, second) = match proximity.pair {
        ContactPair::Edges([a, b]) => (edge_name(a), edge_name(b)),
        ContactPair::NodeAndPlane { node, plane } => {
            let (rod, along) = assembly.locate(node);
            (
                format!("node {along} of rod `{}`", assembly.names[rod]),
                format!("plane {plane}"),
            )
        }
    };
    Overlap {
        first,
        second,
        distance: proximity.distance,
        least: proximity.threshold,
        exclusive: contact.parameters().is_barrier(),
    }
}
