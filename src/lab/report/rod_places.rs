//! Indices of points on rods among all nodes of a results directory.

use crate::scenario::Place;
use rodlab_files::results::RodRecord;
use std::ops::RangeInclusive;

/// Range of the nodes of a rod among all nodes.
pub fn nodes_of(rods: &[RodRecord], name: &str) -> Option<RangeInclusive<usize>> {
    let rod = rods.iter().position(|rod| rod.name == name)?;
    let first: usize = rods[..rod].iter().map(|rod| rod.nodes).sum();
    Some(first..=first + rods[rod].nodes - 1)
}

/// The node at a given point of the rod with these nodes.
pub fn node_at(nodes: &RangeInclusive<usize>, place: Place) -> usize {
    let (first, last) = (*nodes.start(), *nodes.end());
    match place {
        Place::Start => first,
        Place::End => last,
        Place::Number(number) => (first + number).min(last),
    }
}
