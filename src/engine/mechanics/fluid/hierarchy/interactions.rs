//! Pairs of clusters that interact through expansions, and pairs that must be summed exactly.

use super::tree::{Cluster, Tree};

/// Largest ratio of the sum of two clusters' radii to the distance of their centres for an
/// interaction through expansions. Errors fall with the order p like OPENING^p. A smaller ratio
/// needs lower orders, but leaves more pairs of nodes to be summed exactly.
const OPENING: f64 = 0.5;
/// Least distance over ε. The expansions hold the kernel's terms up to ε²/r². Truncation costs at
/// most 15/8 (ε/r)⁴ of the kernel, that is 10⁻⁵ here.
const REGULARIZATIONS: f64 = 20.0;
/// Least distance over the longest segment. Two Gauss points per segment have an error of about
/// 0.006 (L/r)⁴.
const SEGMENTS: f64 = 4.0;

/// The clusters that act on each cluster.
#[derive(Default)]
pub(super) struct Interactions {
    /// Through expansions.
    pub far: Vec<Vec<usize>>,
    /// Summed node by node; both are leaves.
    pub near: Vec<Vec<usize>>,
}

impl Interactions {
    /// Finds the interactions: every pair of nodes is in exactly one pair of clusters.
    pub(crate) fn find(&mut self, tree: &Tree) {
        for lists in [&mut self.far, &mut self.near] {
            lists.iter_mut().for_each(Vec::clear);
            lists.resize(tree.clusters.len(), Vec::new());
        }
        self.visit(tree, 0, 0);
    }

    fn visit(&mut self, tree: &Tree, target: usize, source: usize) {
        let (on, by) = (&tree.clusters[target], &tree.clusters[source]);
        if are_far(on, by) {
            self.far[target].push(source);
            return;
        }
        match (on.children, by.children) {
            (None, None) => self.near[target].push(source),
            (Some(targets), sources) if sources.is_none() || on.nodes.len() >= by.nodes.len() => {
                for child in targets {
                    self.visit(tree, child, source);
                }
            }
            (_, Some(sources)) => {
                for child in sources {
                    self.visit(tree, target, child);
                }
            }
            (Some(_), None) => unreachable!("the second arm takes all targets with such sources"),
        }
    }
}

fn are_far(target: &Cluster, source: &Cluster) -> bool {
    let distance = (target.centre - source.centre).norm();
    let radii = target.target_radius + source.source_radius;
    let gap = distance - radii;
    radii <= OPENING * distance
        && gap >= REGULARIZATIONS * source.regularization_squared.sqrt()
        && gap >= SEGMENTS * source.longest_segment
}
