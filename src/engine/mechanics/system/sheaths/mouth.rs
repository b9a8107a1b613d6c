//! The mouth of a sheath between nodes.
//!
//! The mouth is at an arc length m of the rod, between nodes. The vertex between the last edge
//! that is held and the first free one, at the node j, bends only over the part l = s_{j+½} − m of
//! its Voronoi length that is outside. The complementary energy ½ ∫ M²/EI ds over this part, with M²
//! linear between the nodes j and j+1 at the distance h, is that of the lengths
//!
//! ```text
//! wⱼ = l − l (h − l)/2h,     wⱼ₊₁ = l̄ⱼ₊₁ + l (h − l)/2h
//! ```
//!
//! of the two vertices, whose stiffnesses are therefore EI/w and GJ/w, with the natural bending κ̃ w.
//! (Inside, the rod has its natural twist, which stays that of the whole vertex.) The stiffness of
//! the free edge is EA l̄/l, since it would otherwise be released with a jump of its tension. So the
//! wall is at the mouth for every m, with an error of second order in the edge length, and the
//! vertex is rigid when its edge is released or held.
//!
//! **Force.** The energy depends on m by itself. The work of the sheath on the rod is F δ(fed), so
//! that
//!
//! ```text
//! F = Σ R·d + ∂E/∂l,     ∂E/∂l = −½ EI κ² − ½ GJ τ² − ½ EA ε²
//! ```
//!
//! with the reactions R of the held nodes and the direction d, and the curvature κ interpolated to
//! the mouth. The second part is the force by which a bent rod moves itself out of a sleeve:
//! D. Bigoni, F. Dal Corso, F. Bosi and D. Misseroni (2015), *Eshelby-like forces acting on elastic
//! structures: theoretical and experimental proof*, Mechanics of Materials 80, 368.

use super::placed::{LEAST_PART, PlacedSheath};
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::vertex::VertexStrains;
use crate::mechanics::rod::{ElasticRods, RodGeometry, STRIDE};
use crate::mechanics::system::build::Assembly;

/// Largest ratio of an edge to the next one for which the length at the mouth is shared with the
/// next vertex.
const LARGEST_RATIO: f64 = 2.0;

impl PlacedSheath {
    /// Gives the vertices and the edge at the mouth their natural strains and stiffness at a time, s.
    pub(super) fn stiffen(&mut self, time: f64, rods: &mut ElasticRods) {
        if let Some((number, _)) = self.mouth.take() {
            for number in [number, number + 1] {
                self.set_vertex(number, 1.0, rods);
            }
            self.set_edge(number, 1.0, rods);
        }
        let number = self.held;
        if number < self.edges.len() {
            let outside = self.middle(number) - self.mouth_at(time);
            // A pushed rod may leave this range within a step.
            let whole = self.voronoi(number);
            let outside = outside.clamp(LEAST_PART * whole, whole);
            for (number, [length, _]) in self.lengths(number, outside) {
                self.set_vertex(number, length / self.voronoi(number), rods);
            }
            self.set_edge(number, outside / self.voronoi(number), rods);
            self.mouth = Some((number, outside));
        }
    }

    /// The vertices at the mouth, their lengths w (m), and dw/dl.
    fn lengths(&self, number: usize, outside: f64) -> Vec<(usize, [f64; 2])> {
        let next = number + 1;
        let edge = self.along[next] - self.along[number];
        let before = self.along[number] - self.along[number - 1];
        if next == self.edges.len()
            || self.vertices[next].is_none()
            || before > LARGEST_RATIO * edge
        {
            return vec![(number, [outside, 1.0])];
        }
        let shared = outside * (edge - outside) / (2.0 * edge);
        let rate = 0.5 - outside / edge;
        vec![
            (number, [outside - shared, 1.0 - rate]),
            (next, [self.voronoi(next) + shared, rate]),
        ]
    }

    /// Sets the length of a vertex, over its Voronoi length.
    fn set_vertex(&self, number: usize, part: f64, rods: &mut ElasticRods) {
        let Some(&Some((index, natural, stiffness))) = self.vertices.get(number) else {
            return;
        };
        let vertex = &mut rods.vertices[index];
        vertex.natural.curvature = natural.curvature.map(|strain| part * strain);
        vertex.stiffness = stiffness.times(1.0 / part);
    }

    /// Sets the part of an edge that stretches.
    fn set_edge(&self, number: usize, part: f64, rods: &mut ElasticRods) {
        rods.edges[self.edge(number)].stretching = self.stretching[number] / part;
    }

    /// Index of an edge among those of all rods.
    fn edge(&self, number: usize) -> usize {
        let [first, last] = [0, self.edges.len() - 1].map(|number| self.edges[number].start);
        self.first_edge + self.edges[number].start - first.min(last)
    }

    /// Bending energy of a vertex that is straight, J.
    fn straightened(&self, number: usize, assembly: &Assembly) -> f64 {
        let Some((index, natural, stiffness)) = self.vertices[number] else {
            return 0.0;
        };
        let mut vertex = assembly.rods.vertices[index];
        (vertex.natural, vertex.stiffness) = (natural, stiffness);
        vertex.energies(&VertexStrains::default()).0
    }

    /// Bending energy of the part of the vertex at the mouth that is inside, where the sheath
    /// straightens it, J.
    pub(super) fn energy_inside(&self, assembly: &Assembly) -> f64 {
        self.mouth.map_or(0.0, |(number, outside)| {
            (1.0 - outside / self.voronoi(number)) * self.straightened(number, assembly)
        })
    }

    /// Force on the rod in the direction in which it is fed, N, and moment about this direction, N m,
    /// at a residual, N and N m.
    pub(super) fn force(
        &self,
        assembly: &Assembly,
        geometry: &RodGeometry,
        residual: &[f64],
    ) -> [f64; 2] {
        let nodes = self.nodes[..=self.held].iter();
        let reactions = nodes.map(|&node| position(residual, node).dot(&self.axis));
        let edges = self.edges[..self.held].iter();
        let moments = edges.map(|edge| residual[STRIDE * edge.start + 3]);
        [
            reactions.sum::<f64>() - self.push(assembly, geometry),
            moments.sum::<f64>() * self.tangent.dot(&self.axis),
        ]
    }

    /// −∂E/∂l of the vertices and the edge at the mouth, N.
    fn push(&self, assembly: &Assembly, geometry: &RodGeometry) -> f64 {
        let Some((number, outside)) = self.mouth else {
            return 0.0;
        };
        let mut push = self.straightened(number, assembly) / self.voronoi(number);
        for (number, [length, rate]) in self.lengths(number, outside) {
            let Some((index, ..)) = self.vertices[number] else {
                continue;
            };
            let mut vertex = assembly.rods.vertices[index];
            vertex.natural.curvature = [0.0; 4];
            let (bending, twisting) = vertex.energies(&geometry.strains(index, &vertex));
            let straightened = self.straightened(number, assembly) / self.voronoi(number);
            push += rate * ((bending + twisting) / length - straightened);
        }
        let edge = &assembly.rods.edges[self.edge(number)];
        let stretch = geometry.edges[edge.start].length / edge.natural_length - 1.0;
        push + 0.5 * edge.stretching * stretch * stretch * edge.natural_length / outside
    }
}
