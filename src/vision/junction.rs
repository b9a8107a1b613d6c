//! Grouping of the junctions of a skeleton into crossings.
//!
//! Two strands that cross at a small angle share the middle of their skeletons: a link between two
//! forks. Since a single strand has no forks, forks occur in pairs joined by a link, and a link is
//! identified by its two forks.

use super::Point;
use super::path_energy::unit;
use super::skeleton::{Arm, Skeleton, median};

/// Longest link between two forks, in widths: that of strands that cross at 15°.
const LONGEST_LINK: f64 = 6.0;
/// Distance below which junctions are one crossing, regardless of their arms, in widths.
const SAME_JUNCTION: f64 = 0.5;
/// Distance below which two forks are halves of one crossing, regardless of the direction of their
/// arms, in widths.
const SAME_CROSSING: f64 = 1.5;
/// Cosine of the widest angle between a longer link and the arms that continue it.
const FORK_COSINE: f64 = 0.5;

/// Median width of the branches that meet.
pub(super) fn width_at(skeleton: &Skeleton, arms: &[Arm]) -> f64 {
    let widths: Vec<f64> = arms
        .iter()
        .map(|arm| 2.0 * skeleton.branches[arm.branch].half_width())
        .collect();
    median(&widths).max(1.0)
}

/// Returns, for each node, the node that represents its crossing, and for each branch, whether it
/// is a link.
pub(super) fn group_junctions(skeleton: &Skeleton) -> (Vec<usize>, Vec<bool>) {
    let mut groups = Groups::new(skeleton);
    let mut links = groups.links(skeleton);
    links.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    for (branch, length, width) in &links {
        if *length < SAME_JUNCTION * width {
            groups.join(skeleton, *branch);
        }
    }
    for (branch, length, width) in &links {
        let [begin, end] = skeleton.branches[*branch].nodes.expect("a link has nodes");
        let (a, b) = (groups.root(begin), groups.root(end));
        let odd = |arms: &[Arm]| arms.len() % 2 == 1;
        let link = Arm {
            branch: *branch,
            side: 0,
        };
        let is_fork = |groups: &Groups, root: usize, side: usize| {
            let others = groups.arms[root]
                .iter()
                .filter(|arm| **arm != Arm { side, ..link });
            others.copied().all(|arm| {
                let away = rough_direction(skeleton, arm, *width);
                let along = rough_direction(skeleton, Arm { side, ..link }, *width);
                away.dot(&along) < -FORK_COSINE
            })
        };
        let are_forks = odd(&groups.arms[a]) && odd(&groups.arms[b]);
        // If three strands cross at nearly the same place, two junctions have four arms each.
        let are_whole = !odd(&groups.arms[a]) && !odd(&groups.arms[b]);
        let is_short = *length < SAME_CROSSING * width;
        if a != b
            && *length < LONGEST_LINK * width
            && (is_short && (are_forks || are_whole)
                || are_forks && is_fork(&groups, a, 0) && is_fork(&groups, b, 1))
        {
            groups.join(skeleton, *branch);
        }
    }
    let roots = (0..skeleton.nodes.len()).map(|node| groups.root(node));
    (roots.collect(), groups.is_link)
}

/// Groups of junctions that are one crossing, by union–find.
struct Groups {
    parent: Vec<usize>,
    /// Arms of each group, stored at the root of the group.
    arms: Vec<Vec<Arm>>,
    /// Whether each branch is a link.
    is_link: Vec<bool>,
}

impl Groups {
    fn new(skeleton: &Skeleton) -> Self {
        let mut arms = vec![Vec::new(); skeleton.nodes.len()];
        for (branch, ends) in skeleton.branches.iter().enumerate() {
            for (side, node) in ends.nodes.into_iter().flatten().enumerate() {
                arms[node].push(Arm { branch, side });
            }
        }
        Self {
            parent: (0..skeleton.nodes.len()).collect(),
            arms,
            is_link: vec![false; skeleton.branches.len()],
        }
    }

    fn root(&self, mut node: usize) -> usize {
        while self.parent[node] != node {
            node = self.parent[node];
        }
        node
    }

    /// Branches between different junctions, with the distance between the junctions and the width
    /// of the strands there.
    fn links(&self, skeleton: &Skeleton) -> Vec<(usize, f64, f64)> {
        let mut links = Vec::new();
        for (branch, ends) in skeleton.branches.iter().enumerate() {
            let Some([begin, end]) = ends.nodes else {
                continue;
            };
            if begin == end || self.arms[begin].len() < 3 || self.arms[end].len() < 3 {
                continue;
            }
            let ways = [skeleton.nodes[begin].position, skeleton.nodes[end].position];
            let length = match (ends.pixels.first(), ends.pixels.last()) {
                (Some(first), Some(last)) => {
                    (first - ways[0]).norm() + ends.length() + (last - ways[1]).norm()
                }
                _ => (ways[0] - ways[1]).norm(),
            };
            let others: Vec<Arm> = self.arms[begin]
                .iter()
                .chain(&self.arms[end])
                .filter(|arm| arm.branch != branch)
                .copied()
                .collect();
            links.push((branch, length, width_at(skeleton, &others)));
        }
        links
    }

    fn join(&mut self, skeleton: &Skeleton, branch: usize) {
        let [begin, end] = skeleton.branches[branch].nodes.expect("a link has nodes");
        let (a, b) = (self.root(begin), self.root(end));
        self.is_link[branch] = true;
        if a != b {
            let moved = std::mem::take(&mut self.arms[b]);
            self.arms[a].extend(moved);
            self.parent[b] = a;
        }
        self.arms[a].retain(|arm| arm.branch != branch);
    }
}

/// Direction of an arm away from its node, over its first two widths.
fn rough_direction(skeleton: &Skeleton, arm: Arm, width: f64) -> Point {
    let branch = &skeleton.branches[arm.branch];
    let ends = branch.nodes.expect("an arm has nodes");
    let from = skeleton.nodes[ends[arm.side]].position;
    let reach = (2.0 * width).ceil() as usize;
    let towards = match branch.pixels.len().min(reach) {
        0 => skeleton.nodes[ends[1 - arm.side]].position,
        count if arm.side == 0 => branch.pixels[count - 1],
        count => branch.pixels[branch.pixels.len() - count],
    };
    unit(towards - from)
}
