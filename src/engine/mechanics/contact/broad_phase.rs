//! All pairs of edges of rods whose surfaces are nearer than a clearance, by sweep and prune.
//!
//! Every edge gets an axis-aligned box, inflated by its radius and half the clearance. The boxes
//! are sorted along the axis on which the edges spread most and swept in that order. Pairs of
//! boxes that overlap on all axes are tested for neighbourhood and by their exact distance. The
//! cost is O(N log N) for the sort plus the number of pairs that overlap along the sweep axis,
//! which for rods is a small multiple of N.

use super::closest_points::edge_distance;
use super::contacts::CandidatePair;
use super::surface::ContactSurface;
use crate::mechanics::Vector3;

/// Sweep and prune, with reused storage.
#[derive(Clone, Debug, Default)]
pub(super) struct BroadPhase {
    boxes: Vec<EdgeBox>,
    /// Pairs of edges whose boxes overlap, by [`key_of`].
    overlapping: Vec<u64>,
}

/// An axis-aligned box around an edge; axis 0 is the one that is swept.
#[derive(Clone, Copy, Debug)]
struct EdgeBox {
    lower: [f64; 3],
    upper: [f64; 3],
    edge: u32,
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
        self.overlapping.sort_unstable();
        found.clear();
        let edges = surface.edges();
        for &key in &self.overlapping {
            let [i, j] = edges_of(key);
            if !surface.may_touch(i, j) {
                continue;
            }
            let ([a, b], [c, d]) = (edges[i].nodes, edges[j].nodes);
            let nodes = [a, b, c, d];
            let distance = edge_distance(&nodes.map(|node| positions[node]));
            if distance < surface.threshold([i, j]) + clearance {
                let pair = CandidatePair {
                    edges: [i, j],
                    nodes,
                    side: 0,
                    start: 0,
                };
                found.push((pair, distance));
            }
        }
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
        self.sort_boxes();
        self.sweep();
        self.overlapping.sort_unstable();
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

    /// Collects all pairs of boxes that overlap.
    fn sweep(&mut self) {
        self.overlapping.clear();
        for (index, first) in self.boxes.iter().enumerate() {
            let reached = self.boxes[index + 1..]
                .iter()
                .take_while(|second| second.lower[0] <= first.upper[0]);
            for second in reached {
                if first.overlaps_across(second) {
                    self.overlapping.push(key_of(first.edge, second.edge));
                }
            }
        }
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
                }
            }));
        self.sort_boxes();
    }

    fn sort_boxes(&mut self) {
        self.boxes
            .sort_unstable_by(|a, b| a.lower[0].total_cmp(&b.lower[0]).then(a.edge.cmp(&b.edge)));
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
    fn tangles_of_the_test_above_do_touch() {
        let (surface, positions) = tangle(1, 4, 20);
        assert!(by_brute_force(&surface, &positions, 0.3).len() > 30);
    }
}
