//! All pairs of edges of rods whose surfaces are nearer than a clearance, by sweep and prune.
//!
//! Every edge gets an axis-aligned box, inflated by its radius and half the clearance. The boxes
//! are sorted along the axis on which the edges spread most and swept in that order, separately in
//! slabs across another axis. Pairs of boxes that overlap on all axes are tested for neighbourhood
//! and by their exact distance. The cost is O(N log N) for the sort plus the number of pairs that
//! overlap along the sweep axis within a slab, which is a small multiple of N.

use super::closest_points::edge_distance;
use super::contacts::CandidatePair;
use super::surface::ContactSurface;
use crate::mechanics::Vector3;
use rayon::prelude::*;

/// Boxes that are swept without slabs.
const FEW: usize = 256;
/// Boxes that are swept in parallel.
const MANY: usize = 4096;
/// Least width of a slab, relative to the mean extent of the boxes across it: few boxes then belong
/// to two slabs.
const SLAB_WIDTH: f64 = 2.0;
/// Pairs of boxes that are tested by one thread.
const TESTED_TOGETHER: usize = 2048;

/// Sweep and prune, with reused storage.
#[derive(Clone, Debug, Default)]
pub(super) struct BroadPhase {
    boxes: Vec<EdgeBox>,
    slabs: Slabs,
    /// Pairs of edges whose boxes overlap, by [`key_of`].
    overlapping: Vec<u64>,
}

/// An axis-aligned box around an edge; axis 0 is the one that is swept.
#[derive(Clone, Copy, Debug)]
struct EdgeBox {
    lower: [f64; 3],
    upper: [f64; 3],
    edge: u32,
    /// First slab to which it belongs.
    slab: u32,
}

/// The boxes of each slab across axis 1, in the order of the sweep; with reused storage.
#[derive(Clone, Debug, Default)]
struct Slabs {
    boxes: Vec<EdgeBox>,
    /// End of the boxes of each slab.
    ends: Vec<usize>,
    /// Pairs found in each slab.
    overlapping: Vec<Vec<u64>>,
}

impl EdgeBox {
    fn overlaps_across(&self, other: &Self) -> bool {
        self.lower[1] <= other.upper[1]
            && other.lower[1] <= self.upper[1]
            && self.lower[2] <= other.upper[2]
            && other.lower[2] <= self.upper[2]
    }
}

impl BroadPhase {
    /// Collects in `found` all pairs that may touch and have Δ < h_i + h_j + `clearance` (m), with
    /// their distance Δ, sorted by edges.
    pub(crate) fn find(
        &mut self,
        surface: &ContactSurface,
        positions: &[Vector3],
        clearance: f64,
        found: &mut Vec<(CandidatePair, f64)>,
    ) {
        self.build_boxes(surface, positions, clearance);
        self.sweep();
        found.clear();
        let edges = surface.edges();
        let tested = |key: &u64| {
            let [i, j] = edges_of(*key);
            if !surface.may_touch(i, j) {
                return None;
            }
            let ([a, b], [c, d]) = (edges[i].nodes, edges[j].nodes);
            let nodes = [a, b, c, d];
            let distance = edge_distance(&nodes.map(|node| positions[node]));
            let is_near = distance < surface.threshold([i, j]) + clearance;
            let pair = CandidatePair {
                edges: [i, j],
                nodes,
                side: 0,
                start: 0,
            };
            is_near.then_some((pair, distance))
        };
        if self.overlapping.len() <= TESTED_TOGETHER {
            return found.extend(self.overlapping.iter().filter_map(tested));
        }
        let parts = self.overlapping.par_chunks(TESTED_TOGETHER);
        let near: Vec<Vec<_>> = parts
            .map(|keys| keys.iter().filter_map(tested).collect())
            .collect();
        near.iter().for_each(|own| found.extend_from_slice(own));
    }

    /// Collects in `found` all pairs that may touch if the boxes around their straight paths from
    /// `start` to `end` overlap, sorted by edges.
    pub(crate) fn find_swept(
        &mut self,
        surface: &ContactSurface,
        start: &[Vector3],
        end: &[Vector3],
        found: &mut Vec<CandidatePair>,
    ) {
        self.build_boxes(surface, start, 0.0);
        let axes = axes_by_spread(surface, start);
        for swept in &mut self.boxes {
            let edge = &surface.edges()[swept.edge as usize];
            let (a, b) = (&end[edge.nodes[0]], &end[edge.nodes[1]]);
            for (k, axis) in axes.into_iter().enumerate() {
                swept.lower[k] = swept.lower[k].min(a[axis].min(b[axis]) - edge.radius);
                swept.upper[k] = swept.upper[k].max(a[axis].max(b[axis]) + edge.radius);
            }
        }
        self.sweep();
        found.clear();
        let edges = surface.edges();
        for &key in &self.overlapping {
            let [i, j] = edges_of(key);
            if surface.may_touch(i, j) {
                let ([a, b], [c, d]) = (edges[i].nodes, edges[j].nodes);
                found.push(CandidatePair {
                    edges: [i, j],
                    nodes: [a, b, c, d],
                    side: 0,
                    start: 0,
                });
            }
        }
    }

    /// Collects all pairs of boxes that overlap, sorted.
    fn sweep(&mut self) {
        self.boxes
            .sort_unstable_by(|a, b| a.lower[0].total_cmp(&b.lower[0]).then(a.edge.cmp(&b.edge)));
        self.overlapping.clear();
        if self.boxes.len() <= FEW {
            sweep_slab(0, &self.boxes, &mut self.overlapping);
        } else {
            self.slabs.fill(&mut self.boxes);
            self.slabs.sweep();
            let found = self.slabs.overlapping.iter();
            found.for_each(|own| self.overlapping.extend_from_slice(own));
        }
        self.overlapping.sort_unstable();
    }

    fn build_boxes(&mut self, surface: &ContactSurface, positions: &[Vector3], clearance: f64) {
        let axes = axes_by_spread(surface, positions);
        self.boxes.clear();
        self.boxes
            .extend(surface.rod_edges().iter().enumerate().map(|(index, edge)| {
                let (a, b) = (&positions[edge.nodes[0]], &positions[edge.nodes[1]]);
                let inflation = edge.radius + 0.5 * clearance;
                EdgeBox {
                    lower: axes.map(|axis| a[axis].min(b[axis]) - inflation),
                    upper: axes.map(|axis| a[axis].max(b[axis]) + inflation),
                    edge: index as u32,
                    slab: 0,
                }
            }));
    }
}

impl Slabs {
    /// Distributes boxes among slabs of equal width, and keeps their order in each.
    fn fill(&mut self, boxes: &mut [EdgeBox]) {
        let (mut lowest, mut highest, mut extent) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for own in boxes.iter() {
            lowest = lowest.min(own.lower[1]);
            highest = highest.max(own.upper[1]);
            extent += own.upper[1] - own.lower[1];
        }
        let width = SLAB_WIDTH * extent / boxes.len() as f64;
        // A cast turns what is not a number into zero.
        let count = (((highest - lowest) / width) as usize).clamp(1, boxes.len());
        let last = count - 1;
        let slab_of = |place: f64| (((place - lowest) / width) as usize).min(last);
        let slabs_of = |own: &EdgeBox| slab_of(own.lower[1])..slab_of(own.upper[1]) + 1;
        self.ends.clear();
        self.ends.resize(count, 0);
        for own in boxes.iter_mut() {
            let slabs = slabs_of(own);
            own.slab = slabs.start as u32;
            self.ends[slabs].iter_mut().for_each(|size| *size += 1);
        }
        // Each slab begins where the one before it ends; storing a box moves its end.
        let mut total = 0;
        for end in &mut self.ends {
            total += std::mem::replace(end, total);
        }
        if let Some(first) = boxes.first() {
            self.boxes.resize(total, *first);
        }
        for own in boxes.iter() {
            for end in &mut self.ends[slabs_of(own)] {
                self.boxes[*end] = *own;
                *end += 1;
            }
        }
    }

    /// Collects the pairs of boxes that overlap in each slab.
    fn sweep(&mut self) {
        self.overlapping.resize_with(self.ends.len(), Vec::new);
        let (ends, boxes) = (&self.ends, &self.boxes);
        let sweep = |(slab, found): (usize, &mut Vec<u64>)| {
            let start = slab.checked_sub(1).map_or(0, |before| ends[before]);
            found.clear();
            sweep_slab(slab as u32, &boxes[start..ends[slab]], found);
        };
        if boxes.len() < MANY || rayon::current_num_threads() == 1 {
            self.overlapping.iter_mut().enumerate().for_each(sweep);
        } else {
            self.overlapping.par_iter_mut().enumerate().for_each(sweep);
        }
    }
}

/// Collects the pairs of boxes of a slab that overlap, except those that overlap in an earlier one,
/// too.
fn sweep_slab(slab: u32, boxes: &[EdgeBox], overlapping: &mut Vec<u64>) {
    for (index, first) in boxes.iter().enumerate() {
        let reached = boxes[index + 1..]
            .iter()
            .take_while(|second| second.lower[0] <= first.upper[0]);
        for second in reached {
            let is_first = first.slab == slab || second.slab == slab;
            if is_first && first.overlaps_across(second) {
                overlapping.push(key_of(first.edge, second.edge));
            }
        }
    }
}

/// Encodes a pair of edges, smaller edge first, as one integer: it sorts like the pair, but much
/// faster.
fn key_of(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

fn edges_of(key: u64) -> [usize; 2] {
    [(key >> 32) as usize, (key & 0xffff_ffff) as usize]
}

/// The axes x, y, z in cyclic order from the one with the largest variance of the edges' first nodes.
fn axes_by_spread(surface: &ContactSurface, positions: &[Vector3]) -> [usize; 3] {
    let (mut sum, mut squares) = (Vector3::zeros(), Vector3::zeros());
    for edge in surface.rod_edges() {
        let position = &positions[edge.nodes[0]];
        sum += position;
        squares += position.component_mul(position);
    }
    let count = surface.rod_edges().len().max(1) as f64;
    let variance = squares / count - (sum / count).component_mul(&(sum / count));
    let widest = variance.imax();
    [widest, (widest + 1) % 3, (widest + 2) % 3]
}

#[cfg(test)]
mod tests {
    use super::super::test_support::Random;
    use super::*;
    use proptest::prelude::*;

    /// Rods that wander at random, close to each other.
    fn tangle(seed: u64, rods: usize, nodes: usize) -> (ContactSurface, Vec<Vector3>) {
        let mut random = Random::new(seed);
        let mut surface = ContactSurface::new();
        let mut positions = Vec::new();
        for rod in 0..rods {
            let mut walker = random.vector() * 3.0;
            let centreline: Vec<Vector3> = (0..nodes)
                .map(|_| {
                    walker += random.vector();
                    walker
                })
                .collect();
            let radius = 0.15 + 0.05 * random.symmetric();
            surface.add_rod(positions.len(), &centreline, rod == 0, radius, rod % 3 == 1);
            positions.extend(centreline);
        }
        (surface, positions)
    }

    fn by_brute_force(
        surface: &ContactSurface,
        positions: &[Vector3],
        clearance: f64,
    ) -> Vec<[usize; 2]> {
        let edges = surface.edges();
        let mut pairs = Vec::new();
        for i in 0..edges.len() {
            for j in i + 1..edges.len() {
                let [a, b] = edges[i].nodes.map(|node| positions[node]);
                let [c, d] = edges[j].nodes.map(|node| positions[node]);
                let near =
                    edge_distance(&[a, b, c, d]) < edges[i].radius + edges[j].radius + clearance;
                if near && surface.may_touch(i, j) {
                    pairs.push([i, j]);
                }
            }
        }
        pairs
    }

    proptest! {
        #[test]
        fn all_pairs_of_brute_force_are_found_in_order(
            seed in any::<u64>(), rods in 1..6_usize, nodes in 2..25_usize, clearance in 0.0..1.0f64,
        ) {
            let (surface, positions) = tangle(seed, rods, nodes);
            let mut found = Vec::new();
            BroadPhase::default().find(&surface, &positions, clearance, &mut found);
            let pairs: Vec<[usize; 2]> = found.iter().map(|(pair, _)| pair.edges).collect();
            prop_assert_eq!(pairs, by_brute_force(&surface, &positions, clearance));
        }
    }

    #[test]
    fn slabs_find_each_pair_once() {
        let (surface, positions) = tangle(3, 40, 30);
        let mut broad = BroadPhase::default();
        for clearance in [0.0, 0.4, 0.1] {
            let mut found = Vec::new();
            broad.find(&surface, &positions, clearance, &mut found);
            assert!(broad.boxes.len() > FEW && broad.slabs.ends.len() > 3);
            let pairs: Vec<[usize; 2]> = found.iter().map(|(pair, _)| pair.edges).collect();
            assert_eq!(pairs, by_brute_force(&surface, &positions, clearance));
        }
    }

    #[test]
    fn tangles_of_the_test_above_do_touch() {
        let (surface, positions) = tangle(1, 4, 20);
        assert!(by_brute_force(&surface, &positions, 0.3).len() > 30);
    }
}
