//! Gaps: a strand that is interrupted where another one lies on it, and by the shadow of that one.

use super::Point;
use super::crossing::{Arm, Crossing, Departure, END_ENERGY, departure, pair_energy};
use super::mask::Mask;
use super::skeleton::Skeleton;
use std::collections::BTreeSet;

/// Widest gap under another strand, in widths.
const WIDEST_COVERED: f64 = 4.5;
/// Widest gap where nothing lies on the strand, in widths.
const WIDEST_OPEN: f64 = 1.5;
/// Part of a gap that another strand fills for it to be covered.
const COVERED: f64 = 0.35;
/// With more loose ends than this the mask is noise.
const MOST_LOOSE_ENDS: usize = 400;

/// Joins loose ends of strands that face each other and go on in the same direction and colour.
pub(super) fn close_gaps(
    skeleton: &Skeleton,
    mask: &Mask,
    links: &[bool],
    crossings: &mut Vec<Crossing>,
    colour: impl Fn(Point) -> [f64; 3],
) {
    let loose = loose_ends(skeleton, links, crossings);
    if loose.len() > MOST_LOOSE_ENDS {
        return;
    }
    let departures: Vec<Departure> = loose
        .iter()
        .map(|(arm, position)| departure(skeleton, *arm, *position, &colour))
        .collect();
    let mut candidates = Vec::new();
    for i in 0..loose.len() {
        for j in i + 1..loose.len() {
            let width = |k: usize| 2.0 * skeleton.branches[loose[k].0.branch].half_width();
            let width = width(i).max(width(j)).max(1.0);
            let (from, to) = (loose[i].1, loose[j].1);
            let gap = (to - from).norm();
            let widest = if covered(mask, from, to) >= COVERED {
                WIDEST_COVERED
            } else {
                WIDEST_OPEN
            };
            // Ends lie half a width inside of the mask.
            if gap > (widest + 1.0) * width {
                continue;
            }
            let energy = pair_energy(&departures[i], &departures[j], width);
            if energy < 0.5 * END_ENERGY {
                candidates.push((energy, i, j));
            }
        }
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut joined = vec![false; loose.len()];
    for (_, i, j) in candidates {
        if !joined[i] && !joined[j] {
            joined[i] = true;
            joined[j] = true;
            let arms = [loose[i].0, loose[j].0];
            crossings.push(Crossing {
                position: (loose[i].1 + loose[j].1) * 0.5,
                arms: arms.to_vec(),
                pairs: vec![arms],
            });
        }
    }
}

/// Ends of branches that nothing continues, and where they are.
fn loose_ends(skeleton: &Skeleton, links: &[bool], crossings: &[Crossing]) -> Vec<(Arm, Point)> {
    let pairs = crossings.iter().flat_map(|crossing| &crossing.pairs);
    let paired: BTreeSet<Arm> = pairs.flatten().copied().collect();
    let mut loose = Vec::new();
    for (branch, ends) in skeleton.branches.iter().enumerate() {
        for (side, node) in ends.nodes.into_iter().flatten().enumerate() {
            let arm = Arm { branch, side };
            if !links[branch] && !paired.contains(&arm) {
                loose.push((arm, skeleton.nodes[node].position));
            }
        }
    }
    loose
}

/// Part of the way between two points that lies in the mask, their own half widths left out.
fn covered(mask: &Mask, from: Point, to: Point) -> f64 {
    const SAMPLES: usize = 24;
    let inside = (0..SAMPLES).filter(|index| {
        let point = from + (to - from) * ((*index as f64 + 0.5) / SAMPLES as f64);
        mask.contains(point.x.round() as usize, point.y.round() as usize)
    });
    inside.count() as f64 / SAMPLES as f64
}
