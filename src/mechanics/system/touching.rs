//! The contact model of a scene, and words for what touches.

use super::{Assembly, System, copy_positions};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{
    ContactPair, ContactPlane, ContactSurface, ImplicitContact, Proximity,
};
use crate::mechanics::scene::Scene;

/// The contact model of a scene with its first candidates; `None` where everything passes through.
///
/// # Errors
/// A sentence that names two bodies that overlap as placed.
pub(super) fn contact_of(
    scene: &Scene,
    assembly: &Assembly,
) -> Result<Option<ImplicitContact>, String> {
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
        return Err(describe_overlap(overlap, &contact, assembly));
    }
    contact.update_candidates(&positions);
    Ok(Some(contact))
}

impl System {
    /// Names the bodies that overlap beyond what is allowed at `unknowns`, wherever contact was last evaluated; candidates
    /// are brought up to date.
    pub fn excessive_penetration_at(&mut self, unknowns: &[f64]) -> Option<String> {
        if !self.candidates_are_complete(unknowns) {
            self.update_candidates(unknowns);
        }
        let contact = self.contact.as_mut()?;
        copy_positions(unknowns, &mut self.positions);
        let overlap = contact.excessive_penetration_at(&self.positions)?;
        Some(describe_overlap(&overlap, contact, &self.assembly))
    }

    /// Names two edges that pass through each other, or nearly so, on the straight paths of all nodes from one set of
    /// unknowns to another.
    pub fn passage(&mut self, from: &[f64], to: &[f64]) -> Option<String> {
        let contact = self.contact.as_mut()?;
        copy_positions(from, &mut self.positions);
        copy_positions(to, &mut self.displacements);
        let pair = contact.passage(&self.positions, &self.displacements)?;
        let [first, second] = names(&pair, contact, &self.assembly);
        Some(format!("{first} and {second} pass through each other"))
    }
}

/// A sentence that names two bodies that are too close.
pub fn describe_overlap(
    overlap: &Proximity,
    contact: &ImplicitContact,
    assembly: &Assembly,
) -> String {
    let [first, second] = names(overlap, contact, assembly);
    let (meet, least) = if contact.parameters().is_barrier() {
        ("touch or interpenetrate", "more than")
    } else {
        ("interpenetrate", "at least")
    };
    format!(
        "{first} and {second} {meet}: distance {:.6e} m, allowed is {least} {:.6e} m",
        overlap.distance, overlap.threshold
    )
}

fn names(pair: &Proximity, contact: &ImplicitContact, assembly: &Assembly) -> [String; 2] {
    let edge_name = |edge: usize| {
        let edge = contact.surface().edges()[edge];
        let (rod, node) = assembly.locate(edge.nodes[0]);
        format!("edge {node} of rod `{}`", assembly.names[rod])
    };
    match pair.pair {
        ContactPair::Edges([a, b]) => [edge_name(a), edge_name(b)],
        ContactPair::NodeAndPlane { node, plane } => {
            let (rod, along) = assembly.locate(node);
            [
                format!("node {along} of rod `{}`", assembly.names[rod]),
                format!("plane {plane}"),
            ]
        }
    }
}
