//! A binary tree of clusters of nodes.

use super::super::chain::Link;
use crate::mechanics::Vector3;
use std::ops::Range;

/// Nodes of a leaf at most.
const LEAF: usize = 32;

/// Nodes near each other, and the ball that encloses them.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    /// Their range in [`Tree::order`].
    pub nodes: Range<usize>,
    /// The two halves; none for a leaf.
    pub children: Option<[usize; 2]>,
    /// Centre of the ball and of all expansions, m.
    pub centre: Vector3,
    /// Radius of the ball around the nodes, where the flow is evaluated, m.
    pub target_radius: f64,
    /// Radius of the ball around the segments that end at the nodes, where the force acts, m.
    pub source_radius: f64,
    /// Largest ε² of the nodes, m².
    pub regularization_squared: f64,
    /// Length of the longest segment, m.
    pub longest_segment: f64,
}

/// Clusters, each halved along its longest extent down to leaves; a function of the positions alone.
#[derive(Default)]
pub(super) struct Tree {
    /// All nodes, in an order in which the nodes of each cluster are consecutive.
    pub order: Vec<usize>,
    /// Clusters with the root first; every cluster precedes its children.
    pub clusters: Vec<Cluster>,
}

impl Tree {
    /// Rebuilds the tree.
    pub(crate) fn build(&mut self, links: &[Link], positions: &[Vector3]) {
        self.order.clear();
        self.order.extend(0..positions.len());
        self.clusters.clear();
        self.grow(0..positions.len(), links, positions);
    }

    fn grow(&mut self, nodes: Range<usize>, links: &[Link], positions: &[Vector3]) -> usize {
        let members = &mut self.order[nodes.clone()];
        let (lower, upper) = corners(members, positions);
        let index = self.clusters.len();
        let centre = (lower + upper) * 0.5;
        self.clusters
            .push(enclose(nodes.clone(), members, centre, links, positions));
        if nodes.len() > LEAF {
            let axis = (upper - lower).imax();
            let half = nodes.len() / 2;
            members.select_nth_unstable_by(half, |&a, &b| {
                (positions[a][axis].total_cmp(&positions[b][axis])).then(a.cmp(&b))
            });
            let middle = nodes.start + half;
            let first = self.grow(nodes.start..middle, links, positions);
            let second = self.grow(middle..nodes.end, links, positions);
            self.clusters[index].children = Some([first, second]);
        } else {
            members.sort_unstable();
        }
        index
    }
}

/// Opposite corners of the box around some nodes.
fn corners(nodes: &[usize], positions: &[Vector3]) -> (Vector3, Vector3) {
    let first = positions[nodes[0]];
    nodes.iter().fold((first, first), |(lower, upper), &node| {
        (lower.inf(&positions[node]), upper.sup(&positions[node]))
    })
}

fn enclose(
    nodes: Range<usize>,
    members: &[usize],
    centre: Vector3,
    links: &[Link],
    positions: &[Vector3],
) -> Cluster {
    let mut cluster = Cluster {
        nodes,
        children: None,
        centre,
        target_radius: 0.0,
        source_radius: 0.0,
        regularization_squared: 0.0,
        longest_segment: 0.0,
    };
    for &node in members {
        let link = &links[node];
        let x = positions[node];
        cluster.target_radius = cluster.target_radius.max((x - centre).norm());
        cluster.regularization_squared = cluster
            .regularization_squared
            .max(link.regularization_squared);
        for neighbour in [link.previous, link.next].into_iter().flatten() {
            let y = positions[neighbour];
            cluster.source_radius = cluster.source_radius.max((y - centre).norm());
            cluster.longest_segment = cluster.longest_segment.max((y - x).norm());
        }
    }
    cluster.source_radius = cluster.source_radius.max(cluster.target_radius);
    cluster
}
