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
    /// Computes the scale of a rod. c_i = 2 √(EI_i/EA) is h for a circular section, and 15 % more
    /// than half the side for a rectangle. For freely given stiffnesses it is that of the ellipse
    /// with these stiffnesses.
    pub(crate) fn of(rod: &RodDescription) -> Self {
        let stiffness = &rod.stiffness;
        let fibre = |bending: f64| 2.0 * (bending / stiffness.stretching).sqrt();
        Self {
            fibres: stiffness.bending.map(fibre),
            bending_2: stiffness.bending[1],
        }
    }
}

impl System {
    /// The largest strains at `unknowns`; those of bending and twist are from the last evaluation.
    /// `sections` has an entry for each rod.
    pub(crate) fn largest_strains(
        &self,
        unknowns: &[f64],
        sections: &[SectionScale],
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
            let section = &sections[self.assembly.locate(node).0];
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
