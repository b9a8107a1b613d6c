//! The order in which nodes are eliminated: of the orders tried, the one with the fewest products.

use super::dissection::dissection_order;
use super::elimination_tree::EliminationTree;
use super::node_graph::NodeGraph;
use super::supernodes::Supernodes;
use crate::random::scrambled;
use rayon::prelude::*;

/// Number of block products, some milliseconds of work, above which other orders than one by
/// minimum degree are tried.
///
/// Minimum degree is quick to compute and best for rods that touch at a few points. In heaps its
/// number of products varies by a third with the numbering of the nodes, which decides between
/// equal degrees. For nets with all crossings tied to their neighbours, it takes up to seven times
/// the products of nested dissection.
const MANY_PRODUCTS: usize = 1_000_000;

/// Number of other node numberings tried.
const NUMBERINGS: u64 = 3;

/// The elimination tree of the order chosen, and its supernodes.
pub(super) fn best_tree(graph: &NodeGraph) -> (EliminationTree, Supernodes) {
    let with_supernodes = |order: &[usize]| {
        let tree = EliminationTree::new(graph, order);
        let supernodes = Supernodes::new(&tree);
        (tree, supernodes)
    };
    let by_degree = with_supernodes(&graph.minimum_degree_order());
    if by_degree.1.products() <= MANY_PRODUCTS {
        return by_degree;
    }
    let others = (0..=NUMBERINGS).into_par_iter().map(|seed| match seed {
        NUMBERINGS => with_supernodes(&dissection_order(graph)),
        _ => with_supernodes(&renumbered_order(graph, seed)),
    });
    let mut all: Vec<_> = others.collect();
    all.push(by_degree);
    let best = all
        .into_iter()
        .min_by_key(|(_, supernodes)| supernodes.products());
    best.expect("one is tried")
}

/// The order by minimum degree for a pseudorandom numbering of the nodes.
fn renumbered_order(graph: &NodeGraph, seed: u64) -> Vec<usize> {
    let mut nodes: Vec<u32> = (0..graph.nodes as u32).collect();
    nodes.sort_by_key(|node| scrambled(seed << 32 | u64::from(*node)));
    let order = graph.renumbered(&nodes).minimum_degree_order();
    order.into_iter().map(|k| nodes[k] as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A net whose rods share a node at each crossing. Nodes up to two apart along a rod are
    /// coupled.
    fn net(rods: usize, between: usize) -> NodeGraph {
        let count = (rods - 1) * between + 1;
        let node = |rod: usize, place: usize| match (rod < rods, place % between) {
            // Where the second family of rods crosses the first, both have the same nodes.
            (false, 0) => (place / between * count + (rod - rods) * between) as u32,
            _ => (rod * count + place) as u32,
        };
        let neighbours = |rod: usize, place: usize| {
            let next = (place + 1..count).take(2);
            next.map(move |other| (node(rod, place), node(rod, other)))
        };
        let all = (0..2 * rods).flat_map(|rod| (0..count).map(move |place| (rod, place)));
        let pairs: Vec<_> = all
            .flat_map(|(rod, place)| neighbours(rod, place))
            .collect();
        NodeGraph::of_pairs(2 * rods * count, &pairs)
    }

    #[test]
    fn a_net_is_dissected() {
        let graph = net(20, 5);
        let tree = EliminationTree::new(&graph, &graph.minimum_degree_order());
        let by_degree = Supernodes::new(&tree).products();
        let best = best_tree(&graph).1.products();
        assert!(
            3 * best < by_degree,
            "{best} products, {by_degree} by degree"
        );
    }
}
