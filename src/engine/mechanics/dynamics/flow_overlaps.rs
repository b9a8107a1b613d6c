//! Rods that pass through each other in a fluid, in a scene without contact.
//!
//! Regularized Stokeslets describe the flow between rods whose distance is at least about the sum
//! of their radii. The velocities of nodes deep inside other rods hardly differ, so that rods that
//! overlap are nearly stuck together, and a small change of the motion, as by another time step,
//! changes it altogether.

use super::validity_memory::FlowOverlap;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactSurface, overlapping_edges};
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::Scene;
use crate::mechanics::system::{System, copy_positions, surface_of_rods};
use std::collections::BTreeSet;

/// Distance of centrelines, as a fraction of the sum of the radii, below which rods overlap.
const DEEP: f64 = 0.9;

/// Finds rods that overlap.
#[derive(Clone, Debug)]
pub(super) struct FlowOverlaps {
    surface: ContactSurface,
    /// Pairs of edges that overlap as placed, as those of two rods whose ends a spring joins.
    at_start: BTreeSet<[usize; 2]>,
    /// Those among them of which one has an end inside the other, in this order.
    inside_at_start: BTreeSet<[usize; 2]>,
}

impl FlowOverlaps {
    /// For a scene in which rods interact through a fluid alone, and never touch; `None` for others.
    pub(crate) fn of(scene: &Scene, system: &System, unknowns: &[f64]) -> Option<Self> {
        let interacts = matches!(scene.fluid, Some(FluidModel::RegularizedStokeslets { .. }));
        if !interacts || scene.contact.is_some() {
            return None;
        }
        let surface = surface_of_rods(scene, &system.assembly);
        let positions = positions_of(system, unknowns);
        let at_start: BTreeSet<_> = overlapping_edges(&surface, &positions, DEEP).collect();
        let inside = at_start.iter().flat_map(either_way);
        let inside_at_start =
            inside.filter(|edges| surface.has_end_inside(*edges, &positions, DEEP));
        Some(Self {
            inside_at_start: inside_at_start.collect(),
            at_start,
            surface,
        })
    }

    /// The first nodes of two edges that overlap, and did not as placed; or of which one has an end
    /// inside the other, and had not.
    pub(crate) fn find(&self, system: &System, unknowns: &[f64]) -> Option<[usize; 2]> {
        let positions = positions_of(system, unknowns);
        let surface = &self.surface;
        let is_new = |edges: &[usize; 2]| {
            let has_slid_in = |edges: [usize; 2]| {
                !self.inside_at_start.contains(&edges)
                    && surface.has_end_inside(edges, &positions, DEEP)
            };
            !self.at_start.contains(edges) || either_way(edges).into_iter().any(has_slid_in)
        };
        let edges = overlapping_edges(surface, &positions, DEEP).find(is_new)?;
        Some(edges.map(|edge| surface.first_node_of(edge)))
    }
}

fn either_way(&[one, other]: &[usize; 2]) -> [[usize; 2]; 2] {
    [[one, other], [other, one]]
}

impl FlowOverlap {
    /// Describes the overlap.
    pub(super) fn in_words(&self, system: &System) -> String {
        let [first, second] = self.nodes.map(|node| {
            let (rod, along) = system.assembly.locate(node);
            format!("edge {along} of rod `{}`", system.assembly.names[rod])
        });
        format!(
            "from t = {:.4} s {first} and {second} overlap in the fluid, where the drag model is not valid: add a table [contact], or keep them apart",
            self.time
        )
    }
}

fn positions_of(system: &System, unknowns: &[f64]) -> Vec<Vector3> {
    let mut positions = vec![Vector3::zeros(); system.assembly.rods.nodes];
    copy_positions(unknowns, &mut positions);
    positions
}

#[cfg(test)]
mod tests {
    use super::super::Simulation;
    use super::*;
    use crate::mechanics::contact::ContactParameters;
    use crate::mechanics::dynamics::Scheme;
    use crate::mechanics::scene::RodDescription;
    use crate::mechanics::test_support::{fixed_steps, free_rods, straight_rod};

    /// Two rods across each other; one falls on the other in a fluid.
    fn crossing() -> Scene {
        let thin = RodDescription {
            radius: 5e-4,
            ..straight_rod(8, 0.02)
        };
        let mut above = RodDescription {
            name: "above".into(),
            velocity: Vector3::z() * -0.5,
            ..thin.clone()
        };
        for node in &mut above.centreline {
            *node = Vector3::new(0.01, node.x - 0.01, 5e-3);
        }
        Scene {
            fluid: Some(FluidModel::RegularizedStokeslets {
                viscosity: 1e-3,
                regularization: 1.02,
                far_field_error: 0.0,
            }),
            ..free_rods(vec![thin, above])
        }
    }

    #[test]
    fn rods_that_pass_through_each_other_are_remarked_on_once() {
        let remarks = |scene: &Scene| {
            let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-4);
            let mut simulation = Simulation::new(scene, &parameters).unwrap();
            while simulation.time() < 0.02 {
                simulation.advance(0.02).unwrap();
            }
            let remarks = simulation.remarks();
            let of_overlaps = remarks.into_iter().filter(|text| text.contains("overlap"));
            of_overlaps.collect::<Vec<_>>()
        };
        let mut scene = crossing();
        let found = remarks(&scene);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            found[0].contains("`rod`") && found[0].contains("`above`"),
            "{found:?}"
        );
        scene.contact = Some(ContactParameters::default());
        assert_eq!(remarks(&scene), [""; 0], "they touch");
        // Rods end to end overlap as placed at their ends alone, at whatever angle they move on.
        let mut scene = crossing();
        for (node, along) in scene.rods[1].centreline.iter_mut().zip(0..) {
            *node = Vector3::x() * (0.0202 + 2.5e-3 * f64::from(along));
        }
        for (velocity, count) in [(Vector3::y(), 0), (Vector3::x(), 0), (-Vector3::x(), 1)] {
            scene.rods[1].velocity = velocity * 0.5;
            assert_eq!(remarks(&scene).len(), count, "{velocity}");
        }
    }
}
