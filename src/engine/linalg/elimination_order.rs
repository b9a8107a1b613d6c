//! The order in which nodes are eliminated: the one that takes the fewest products of those tried.

use super::dissection::dissection_order;
use super::elimination_tree::EliminationTree;
use super::node_graph::NodeGraph;
use super::supernodes::Supernodes;
use crate::random::scrambled;
use rayon::prelude::*;

/// Products of blocks above which other orders than one by minimum degree are tried: those of some milliseconds.
///
/// Minimum degree is quick to find and best for rods that touch here and there. In heaps its products vary by a third with the
/// numbering of the nodes, which decides between equal degrees. For nets, all of whose crossings are tied to their
/// neighbours, it takes up to seven times the products of nested dissection.
const MANY_PRODUCTS: usize = 1_000_000;

/// Other numberings of the nodes that are tried.
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

/// The order by minimum degree where nodes are numbered in some other way.
fn renumbered_order(graph: &NodeGraph, seed: u64) -> Vec<usize> {
    let mut nodes: Vec<u32> = (0..graph.nodes as u32).collect();
    nodes.sort_by_key(|node| scrambled(seed << 32 | u64::from(*node)));
    let order = graph.renumbered(&nodes).minimum_degree_order();
    order.into_iter().map(|k| nodes[k] as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A net whose rods share a node where they cross, with nodes coupled up to two apart along each.
    fn net(rods: usize, between: usize) -> NodeGraph {
        let count = (rods - 1) * between + 1;
        let node = |rod: usize, place: usize| match (rod < rods, place % between) {
            // The second family of rods has the nodes of the first where it crosses them.
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
