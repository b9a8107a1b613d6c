//! The largest strains, against what the theory of rods is for.

use super::System;
use crate::mechanics::rod::topology::position;

/// A large strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strain {
    /// "stretched" or "compressed".
    pub kind: &'static str,
    /// Its size: 0.1 is 10 %.
    pub size: f64,
    /// A node of the whole scene next to it.
    pub node: usize,
}

impl System {
    /// The largest stretch or compression of an edge at `unknowns`, where it is beyond `least`.
    pub fn largest_stretch(&self, unknowns: &[f64], least: f64) -> Option<Strain> {
        let edges = self.assembly.rods.edges.iter();
        let strains = edges
            .filter(|edge| !self.assembly.obstacle[edge.start])
            .map(|edge| {
                let span = position(unknowns, edge.end) - position(unknowns, edge.start);
                (edge.start, span.norm() / edge.natural_length - 1.0)
            });
        let (node, strain) = strains.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        (strain.abs() > least).then(|| Strain {
            kind: if strain > 0.0 {
                "stretched"
            } else {
                "compressed"
            },
            size: strain.abs(),
            node,
        })
    }
}
