//! Strands: paths through a skeleton from one end to another, as straight as possible through
//! crossings.

use super::Point;
use super::crossing::Crossing;
use super::skeleton::{Arm, Skeleton};
use std::collections::BTreeMap;

/// Branches in order. In a closed strand, the first branch follows the last one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Path {
    /// Each branch, given by the arm at which the path enters it.
    pub entries: Vec<Arm>,
    /// For each branch, the path to the next branch, if known.
    pub bridges: Vec<Vec<Point>>,
    pub closed: bool,
}

/// The pixels of branches in order, each given by the arm at which it is entered.
fn pixels_along(skeleton: &Skeleton, route: &[Arm]) -> Vec<Point> {
    let mut along = Vec::new();
    for entry in route {
        let pixels = skeleton.branches[entry.branch].pixels.iter();
        if entry.side == 0 {
            along.extend(pixels);
        } else {
            along.extend(pixels.rev());
        }
    }
    along
}

/// Follows all strands. Open ones are first, in order of their branches.
pub(super) fn paths(skeleton: &Skeleton, crossings: &[Crossing], links: &[bool]) -> Vec<Path> {
    let pairs = crossings.iter().flat_map(|crossing| &crossing.pairs);
    let partner: BTreeMap<Arm, Arm> = pairs.flat_map(|[a, b]| [(*a, *b), (*b, *a)]).collect();
    let mut via: BTreeMap<Arm, Vec<Point>> = BTreeMap::new();
    let mut used = links.to_vec();
    for crossing in crossings {
        let pixels = pixels_along(skeleton, &crossing.route);
        for [a, b] in &crossing.pairs {
            via.insert(*a, pixels.clone());
            via.insert(*b, pixels.iter().rev().copied().collect());
        }
    }
    // A branch between two unpaired arms along which two strands are joined is not a third one.
    let routes = || crossings.iter().flat_map(|crossing| &crossing.route);
    for entry in routes() {
        let is_unpaired = |arm: &Arm| !partner.contains_key(arm);
        let count = routes()
            .filter(|other| other.branch == entry.branch)
            .count();
        used[entry.branch] |= count > 1 && is_unpaired(entry) && is_unpaired(&entry.opposite());
    }
    let bridges = |entries: &[Arm]| {
        let exits = entries.iter().map(|entry| entry.opposite());
        exits
            .map(|exit| via.get(&exit).cloned().unwrap_or_default())
            .collect()
    };
    let mut paths = Vec::new();
    let path = |entries: Vec<Arm>, closed| Path {
        bridges: bridges(&entries),
        entries,
        closed,
    };
    let follow = |start: Arm, used: &mut Vec<bool>| {
        let (mut entries, mut entry) = (Vec::new(), start);
        loop {
            entries.push(entry);
            used[entry.branch] = true;
            match partner.get(&entry.opposite()) {
                Some(next) if !used[next.branch] => entry = *next,
                Some(next) => return (entries, *next == start),
                None => return (entries, false),
            }
        }
    };
    let branches = 0..skeleton.branches.len();
    for branch in branches.clone() {
        for side in 0..2 {
            let start = Arm { branch, side };
            let is_end = !partner.contains_key(&start) && skeleton.branches[branch].nodes.is_some();
            if is_end && !used[branch] {
                let (entries, closed) = follow(start, &mut used);
                paths.push(path(entries, closed));
            }
        }
    }
    for branch in branches {
        if !used[branch] {
            let start = Arm { branch, side: 0 };
            let (entries, closed) = follow(start, &mut used);
            let closed = closed || skeleton.branches[branch].nodes.is_none();
            paths.push(path(entries, closed));
        }
    }
    paths
}
