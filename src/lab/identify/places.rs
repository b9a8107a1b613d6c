//! Places on rods as weighted nodes.

use super::data::{At, Place};
use crate::run::PreparedRun;
use rodlab_engine::mechanics::scene::{NaturalShape, RodDescription};

/// Returns the nodes, counted over the scene, whose weighted positions give a place, with their
/// weights.
pub(super) fn weights(prepared: &PreparedRun, place: &Place) -> Result<Vec<(usize, f64)>, String> {
    let rods = &prepared.scene.rods;
    let names = || {
        rods.iter()
            .map(|rod| rod.name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let index = match &place.rod {
        Some(name) => {
            let found = rods.iter().position(|rod| rod.name == *name);
            found.ok_or_else(|| format!("no rod is called `{name}`; the rods are: {}", names()))?
        }
        None if rods.len() == 1 => 0,
        None => {
            return Err(format!(
                "the column `rod` is missing; the rods are: {}",
                names()
            ));
        }
    };
    let first: usize = rods[..index].iter().map(|rod| rod.centreline.len()).sum();
    let rod = &rods[index];
    let count = rod.centreline.len();
    let own = match place.at {
        At::Node(node) if node < count => vec![(node, 1.0)],
        At::Node(node) => {
            return Err(format!(
                "there is no node {node}; `{}` has nodes 0 to {}",
                rod.name,
                count - 1
            ));
        }
        At::ArcLength(length) => interpolated(rod, length)?,
        At::Part(part) => {
            let lengths = arc_lengths(rod);
            interpolated(rod, part * lengths[lengths.len() - 1])?
        }
    };
    Ok(own
        .into_iter()
        .map(|(node, weight)| (first + node % count, weight))
        .collect())
}

/// Arc lengths of the nodes of a rod without stress, m; a closed rod ends with its first node
/// again.
pub fn arc_lengths(rod: &RodDescription) -> Vec<f64> {
    let points = match &rod.natural_shape {
        NaturalShape::Centreline(points) => points,
        _ => &rod.centreline,
    };
    let edges = points.len() - usize::from(!rod.closed);
    let along = |edge: usize| (points[(edge + 1) % points.len()] - points[edge]).norm();
    let mut lengths = vec![0.0];
    for edge in 0..edges {
        let length = match &rod.natural_shape {
            NaturalShape::Strains(natural) => natural.lengths[edge],
            _ => along(edge),
        };
        lengths.push(lengths[edge] + length);
    }
    lengths
}

/// Weights of Lagrange's polynomial through the four nodes about an arc length, m.
fn interpolated(rod: &RodDescription, length: f64) -> Result<Vec<(usize, f64)>, String> {
    let lengths = arc_lengths(rod);
    let whole = lengths[lengths.len() - 1];
    // Measured lengths may exceed the end by round-off.
    if !(-1e-6 * whole..=(1.0 + 1e-6) * whole).contains(&length) {
        return Err(format!(
            "the arc length {length} m is beyond `{}`; allowed: 0 to {whole} m",
            rod.name
        ));
    }
    let order = lengths.len().min(4);
    let after = lengths.partition_point(|node| *node <= length);
    let start = after.saturating_sub(2).min(lengths.len() - order);
    let nodes = start..start + order;
    let weight = |node: usize| {
        let others = nodes.clone().filter(|other| *other != node);
        let factor = |other: usize| (length - lengths[other]) / (lengths[node] - lengths[other]);
        others.map(factor).product()
    };
    Ok(nodes.clone().map(|node| (node, weight(node))).collect())
}
