//! Forces and moments inside the rods and at clamps, at the last evaluation.
//!
//! A vertex with the bending stiffness EI/l̄ and twisting stiffness GJ/l̄ carries the moments EI
//! (κ − κ̃)/l̄ about the two material directors and GJ (τ − τ̃)/l̄ about the tangent. Here κ is
//! the mean of the integrated curvatures with respect to its two edges, or the turning angle for
//! rods that use that angle as strain. An edge carries the tension EA (l/l̃ − 1). The moments and
//! tensions of material dashpots are added.
//!
//! **Moment of a clamp.** The energy E of the half vertex at a ghost edge does not change when the
//! whole half vertex is turned. So turning only the ghost edge by δφ changes E by M·δφ, where
//! −M·δφ is the change when only the rod's edge is turned. M is the moment of the clamp on the
//! rod: the generalised force that holds the ghost edge. Turning an edge of length l and tangent t
//! by δφ moves its end by δφ×t l and spins its frame by δφ·t; parallel transport alone contributes
//! c·(δφ×t l) to this spin ([`crate::mechanics::rod::vertex`]). With the gradients g with respect
//! to the edge vector and s with respect to the spin, M = −(l t×(g − c s) + s t).

use super::System;
use crate::mechanics::Vector3;
use crate::mechanics::rod::vertex::{EdgeFrame, VertexStrains, curvature_binormal};
use crate::mechanics::rod::{BendingStrain, ElasticEnergy, STRIDE, Vertex};

/// Internal forces and moments of a rod at a node, and the curvature of the rod there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resultants {
    /// Magnitude of the bending moment, N m.
    pub bending_moment: f64,
    /// Twisting moment, N m.
    pub twisting_moment: f64,
    /// Curvature |κb|/l̄ of the centreline with the present Voronoi length, 1/m.
    pub curvature: f64,
    /// Twist per length, rad/m.
    pub twist: f64,
}

impl System {
    /// Tension of the edge that starts at a node, N; `None` where no edge starts.
    pub(crate) fn tension(&self, edge: usize) -> Option<f64> {
        let edges = &self.acting_rods().edges;
        let index = edges.binary_search_by_key(&edge, |edge| edge.start).ok()?;
        let strain = self.geometry.edges[edge].length / edges[index].natural_length - 1.0;
        Some(edges[index].stretching * strain)
    }

    /// Internal forces and moments at each node; `None` at free and hinged ends. If a clamp holds
    /// the frame of an inner node, the entry is for the side with the larger bending moment.
    pub(crate) fn resultants(&self) -> Vec<Option<Resultants>> {
        let mut all: Vec<Option<Resultants>> = vec![None; self.assembly.rods.nodes];
        for (index, vertex) in self.assembly.rods.vertices.iter().enumerate() {
            let found = self.resultants_of(index, vertex);
            let kept = &mut all[self.assembly.node_of(vertex)];
            if kept.is_none_or(|kept| kept.bending_moment < found.bending_moment) {
                *kept = Some(found);
            }
        }
        all
    }

    /// Moment of the clamps at a node on the rod, and on springs that turn against these clamps, N
    /// m; zero if no clamp holds a frame.
    pub(crate) fn clamp_moment(&self, node: usize) -> Vector3 {
        let rods = &self.assembly.rods;
        let mut moment = Vector3::zeros();
        for (index, vertex) in rods.vertices.iter().enumerate() {
            let is_wall = vertex.before.max(vertex.after) >= rods.nodes;
            if !is_wall || self.assembly.node_of(vertex) != node {
                continue;
            }
            let frames = [vertex.before, vertex.after].map(|edge| &self.geometry.edges[edge]);
            let strains = self.geometry.strains(index, vertex);
            let gradient = self.acting_rods().vertices[index].gradient(frames, &strains);
            moment -= if vertex.before < rods.nodes {
                turning(frames[0], &gradient.e0, gradient.phi0)
            } else {
                turning(frames[1], &gradient.e1, gradient.phi1)
            };
        }
        let drives = self.assembly.drives.iter().enumerate();
        for (number, drive) in drives.filter(|(_, drive)| drive.node == node && !drive.released) {
            // Edges that are walls themselves are held by their angles.
            for edge in &drive.edges {
                let spin = self.residual[STRIDE * edge.start + 3];
                moment += self.geometry.edges[edge.start].tangent * spin;
            }
            moment -= self.terms.springs.moment_on_clamp(number);
        }
        moment
    }

    /// Elastic energy of one rod.
    pub(crate) fn elastic_energy_of(&self, rod: usize) -> ElasticEnergy {
        let rods = &self.assembly.rods;
        let nodes = rods.rods[rod].node_indices();
        let mut energy = self
            .terms
            .damping
            .relaxing_energy(&self.assembly, Some(rod));
        let yielding = &self.terms.plasticity;
        energy = energy + yielding.energy_at(rods, &self.geometry, |node| nodes.contains(&node));
        for edge in rods.edges.iter().filter(|edge| nodes.contains(&edge.start)) {
            let length = self.geometry.edges[edge.start].length;
            let strain = length / edge.natural_length - 1.0;
            energy.stretching += 0.5 * edge.stretching * strain * strain * edge.natural_length;
        }
        for (index, vertex) in rods.vertices.iter().enumerate() {
            if nodes.contains(&self.assembly.node_of(vertex)) {
                let strains = self.geometry.strains(index, vertex);
                let (bending, twisting) = vertex.energies(&strains);
                energy.bending += bending;
                energy.twisting += twisting;
            }
        }
        energy
    }

    /// Twist of all vertices of a rod, rad.
    pub(crate) fn total_twist(&self, rod: usize) -> f64 {
        let nodes = self.assembly.rods.rods[rod].node_indices();
        let vertices = self.assembly.rods.vertices.iter().enumerate();
        let own = vertices.filter(|(_, vertex)| nodes.contains(&self.assembly.node_of(vertex)));
        own.map(|(index, _)| self.geometry.twist(index)).sum()
    }

    fn resultants_of(&self, index: usize, vertex: &Vertex) -> Resultants {
        let strains = self.geometry.strains(index, vertex);
        let [before, after] = [vertex.before, vertex.after].map(|edge| &self.geometry.edges[edge]);
        let acting = &self.acting_rods().vertices[index];
        let elastic = acting.elastic_strains(&strains);
        let moment = |axis: usize| {
            acting.stiffness.bending[axis] * (elastic.curvature[axis] + elastic.curvature[axis + 2])
        };
        let half_length = |frame: &EdgeFrame| {
            if frame.length.is_finite() {
                0.5 * frame.length
            } else {
                0.0
            }
        };
        let length = half_length(before) + half_length(after);
        let binormal = curvature_binormal(&before.tangent, &after.tangent);
        let turned = if vertex.weights.bending == 1.0 && vertex.strain == BendingStrain::Tangent {
            binormal.norm()
        } else {
            let turning = vertex.strain.of(&strains);
            // Beside a clamp the turning angle is not the mean curvature around the node, but the
            // moment is correct.
            let over_length = |axis: usize| {
                let of_edges =
                    |of: &VertexStrains| 0.5 * (of.curvature[axis] + of.curvature[axis + 2]);
                let natural = of_edges(&vertex.natural);
                natural + (of_edges(&turning) - natural) / vertex.weights.bending
            };
            libm::hypot(over_length(0), over_length(1))
        };
        let natural_twist = vertex.natural.twist;
        let twisted = if vertex.weights.twisting == 1.0 {
            strains.twist
        } else {
            natural_twist + (strains.twist - natural_twist) / vertex.weights.twisting
        };
        Resultants {
            bending_moment: libm::hypot(moment(0), moment(1)),
            twisting_moment: acting.stiffness.twisting * elastic.twist,
            curvature: turned / length,
            twist: twisted / length,
        }
    }
}

/// Change of an energy per rotation of an edge, from its gradients with respect to the edge vector
/// and the spin of the frame.
fn turning(frame: &EdgeFrame, gradient: &Vector3, spin: f64) -> Vector3 {
    let across = gradient - frame.holonomy * spin;
    frame.tangent.cross(&across) * frame.length + frame.tangent * spin
}
