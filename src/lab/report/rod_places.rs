//! Indices of places on rods among all nodes of a results directory.

use crate::scenario::Place;
use rodlab_files::results::RodRecord;
use std::ops::RangeInclusive;

/// The nodes of a rod, first and last, among all.
pub fn nodes_of(rods: &[RodRecord], name: &str) -> Option<RangeInclusive<usize>> {
    let rod = rods.iter().position(|rod| rod.name == name)?;
    let first: usize = rods[..rod].iter().map(|rod| rod.nodes).sum();
    Some(first..=first + rods[rod].nodes - 1)
}

/// The node at a place on the rod of these nodes.
pub fn node_at(nodes: &RangeInclusive<usize>, place: Place) -> usize {
    let (first, last) = (*nodes.start(), *nodes.end());
    match place {
        Place::Start => first,
        Place::End => last,
        Place::Number(number) => (first + number).min(last),
    }
}
