//! The largest strains, to check them against the range of validity of rod theory.
//!
//! If a rod is bent by Δκ beyond its natural curvature, its outer fibres stretch by c Δκ; if it is
//! twisted by Δτ per length, its surface shears by c Δτ. Here c is the distance of the outer
//! fibres from the centreline, h for a circular section.

use super::System;
use crate::mechanics::rod::topology::position;
use crate::mechanics::scene::RodDescription;

/// Largest strain of a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strain {
    /// Magnitude of the strain: 0.1 is 10 %. Stretch is signed.
    pub size: f64,
    /// The node of the whole scene at which the strain occurs.
    pub node: usize,
}

/// The largest strains, by magnitude, of all rods that are not obstacles; `None` without such
/// rods.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LargestStrains {
    /// Stretch of an edge; negative for compression.
    pub stretch: Option<Strain>,
    /// Strain of the outer fibres by bending.
    pub bending: Option<Strain>,
    /// Shear strain at the surface due to twist.
    pub twist: Option<Strain>,
}

/// Ratios of the strains at the surface of a section to those of its centreline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SectionScale {
    /// Distances, m, of the outer fibres that are strained by bending about the first and the
    /// second director.
    fibres: [f64; 2],
    /// Bending stiffness EI₂, N m².
    bending_2: f64,
}

impl SectionScale {
    /// Computes the scale of a section. c_i = 2 √(EI_i/EA) is h for a circular section, and 15 %
    /// more than half the side for a rectangle. For freely given stiffnesses it is that of the
    /// ellipse with these stiffnesses.
    fn of(stretching: f64, bending: [f64; 2]) -> Self {
        let fibre = |bending: f64| 2.0 * (bending / stretching).sqrt();
        Self {
            fibres: bending.map(fibre),
            bending_2: bending[1],
        }
    }

    /// The scale of a node whose halves have different sections. Both halves carry the moment of
    /// the node, so the strain M c_i/EI_i is that of the half with the larger c_i/EI_i. The scale
    /// is relative to the mean curvature M/EI, with the harmonic mean of EI_i.
    fn of_halves(one: ([f64; 2], Self), other: ([f64; 2], Self)) -> Self {
        let mean = |axis: usize| 2.0 / (1.0 / one.0[axis] + 1.0 / other.0[axis]);
        let fibre = |axis: usize| {
            let per_moment = [one, other].map(|(bending, own)| own.fibres[axis] / bending[axis]);
            mean(axis) * per_moment[0].max(per_moment[1])
        };
        Self {
            fibres: [fibre(0), fibre(1)],
            bending_2: mean(1),
        }
    }
}

/// The scales of a rod: one for all nodes, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SectionScales(Vec<SectionScale>);

impl SectionScales {
    /// Computes the scales of a rod.
    pub(crate) fn of(rod: &RodDescription) -> Self {
        let stiffness = &rod.stiffness;
        let edges = rod.sections.len();
        if edges == 0 {
            return Self(vec![SectionScale::of(
                stiffness.stretching,
                stiffness.bending,
            )]);
        }
        let half = |edge: usize, end: usize| {
            let section = &rod.sections[edge];
            let bending = section.bending[end];
            (bending, SectionScale::of(section.stretching, bending))
        };
        let of_node = |node: usize| {
            let before = (node + edges - 1) % edges;
            match node {
                0 if !rod.closed => half(0, 0).1,
                _ if node == edges => half(edges - 1, 1).1,
                _ => SectionScale::of_halves(half(before, 1), half(node, 0)),
            }
        };
        Self((0..rod.centreline.len()).map(of_node).collect())
    }

    fn at(&self, node: usize) -> &SectionScale {
        &self.0[node.min(self.0.len() - 1)]
    }
}

impl System {
    /// The largest strains at `unknowns`; those of bending and twist are from the last evaluation.
    /// `sections` has an entry for each rod.
    pub(crate) fn largest_strains(
        &self,
        unknowns: &[f64],
        sections: &[SectionScales],
    ) -> LargestStrains {
        let rods = &self.assembly.rods;
        let mut largest = LargestStrains::default();
        for edge in &rods.edges {
            if !self.assembly.obstacle[edge.start] {
                let span = position(unknowns, edge.end) - position(unknowns, edge.start);
                let stretch = span.norm() / edge.natural_length - 1.0;
                keep_larger(&mut largest.stretch, stretch, edge.start);
            }
        }
        for (index, vertex) in rods.vertices.iter().enumerate() {
            let node = self.assembly.node_of(vertex);
            if self.assembly.obstacle[node] {
                continue;
            }
            let (rod, along) = self.assembly.locate(node);
            let section = sections[rod].at(along);
            let [fibre_1, fibre_2] = section.fibres;
            let strains = self.geometry.strains(index, vertex);
            // κ¹ = m₂·κb turns about m₂.
            let inverse_length = 2.0 * vertex.stiffness.bending[0] / section.bending_2;
            let elastic = vertex.elastic_strains(&strains);
            let mean = |axis: usize| {
                0.5 * inverse_length * (elastic.curvature[axis] + elastic.curvature[axis + 2])
            };
            let bending = libm::hypot(fibre_2 * mean(0), fibre_1 * mean(1));
            keep_larger(&mut largest.bending, bending, node);
            let inverse_length = inverse_length * vertex.weights.bending / vertex.weights.twisting;
            let twist = inverse_length * elastic.twist;
            let rim = std::f64::consts::FRAC_1_SQRT_2 * libm::hypot(fibre_1, fibre_2);
            keep_larger(&mut largest.twist, rim * twist.abs(), node);
        }
        largest
    }
}

fn keep_larger(kept: &mut Option<Strain>, size: f64, node: usize) {
    if kept.is_none_or(|kept| kept.size.abs() < size.abs()) {
        *kept = Some(Strain { size, node });
    }
}
