//! Bound on a step so that it does not cross the barrier of incremental potential contact.

use super::body_faces::safe_fraction_at_triangle;
use super::candidates::approach;
use super::closest_points::ClosestPoints;
use super::contact_system::ContactSystem;
use super::contacts::{CandidatePair, EDGE, TUBE};
use super::continuous_collision::{KEPT_GAP, safe_fraction};
use super::foot::{Foot, Points};
use super::patch::PatchPoint;
use super::rim::safe_fraction_at_rim;
use crate::mechanics::Vector3;

/// Maximum number of times that the candidates are built on one path. Each time the nodes may move
/// by a radius of the thickest rod; a longer path is shortened.
const SEGMENTS: usize = 16;

/// Maximum number of advances along a path over a smooth part of a mesh, and the part of the kept
/// gap by which the gap at the end may differ from it.
const MOST_ADVANCES: usize = 100;
const USED_UP: f64 = 0.1;
/// Bisections for the point at which a path comes over a smooth part of a mesh.
const BISECTIONS: usize = 40;
/// Shortest advance over a smooth part of a mesh, in units of the distance from it.
const SHORTEST: f64 = 1e-9;

/// Bound on the displacement of nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LargestStep {
    /// Fraction of the path that is free, from 0 to 1.
    pub fraction: f64,
    /// Whether the candidates were rebuilt on the path and have changed.
    pub candidates_changed: bool,
}

impl ContactSystem {
    /// Largest fraction of the straight path of all nodes from `start` by `displacements` (m)
    /// along which every pair of surfaces that may touch keeps a tenth of its present gap. The
    /// whole path with the implicit contact model, which allows penetration.
    ///
    /// All pairs that come near anywhere on the path count: if the nodes leave the margin of the
    /// candidates, these are rebuilt on the path. They are complete at the end of the free
    /// fraction.
    ///
    /// Surfaces that touch or overlap at `start` may not move at all.
    pub(crate) fn largest_step(
        &mut self,
        start: &[Vector3],
        displacements: &[Vector3],
    ) -> LargestStep {
        let mut step = LargestStep {
            fraction: 1.0,
            candidates_changed: false,
        };
        if !self.parameters().is_barrier() {
            return step;
        }
        let (start, displacements) = (self.placed(start), self.placed(displacements));
        let (start, displacements) = (start.as_ref(), displacements.as_ref());
        let free = self.safe_fraction_over_planes(start, displacements);
        let mut positions = std::mem::take(&mut self.scratch_positions);
        positions.clear();
        positions.extend_from_slice(start);
        step.fraction = 0.0;
        for _ in 0..SEGMENTS {
            let segment = self.candidates.covered_fraction(&positions, displacements);
            let segment = segment.min(free - step.fraction);
            let safe = self.safe_fraction_between_edges(&positions, displacements, segment);
            step.fraction += safe;
            if safe < segment || step.fraction >= free {
                break;
            }
            for ((position, start), displacement) in
                positions.iter_mut().zip(start).zip(displacements)
            {
                *position = start + displacement * step.fraction;
            }
            step.candidates_changed |= self.renew_candidates(&positions);
        }
        self.scratch_positions = positions;
        step
    }

    /// The fraction up to `longest` that the candidates allow.
    fn safe_fraction_between_edges(
        &mut self,
        start: &[Vector3],
        displacements: &[Vector3],
        longest: f64,
    ) -> f64 {
        let (reach, standoff) = (self.parameters().reach(), self.parameters().standoff());
        self.candidates.motion(start, &mut self.motion);
        for (motion, displacement) in self.motion.iter_mut().zip(displacements) {
            *motion += longest * displacement.norm();
        }
        let points = self.obstacles.points(start);
        let mut fraction = longest;
        for (pair, earlier) in self.candidates.pairs().iter().zip(self.candidates.gaps()) {
            if earlier - approach(pair, &self.motion) < reach {
                let nodes = points.of(pair.nodes);
                if pair.side == EDGE
                    && let direction = ClosestPoints::of(&nodes).separation
                    && self.surface.is_at_reflex_edge(pair, &direction, &points)
                {
                    continue;
                }
                let of_node = |node: usize| displacements.get(node).copied();
                let moves = pair.nodes.map(|node| of_node(node).unwrap_or_default());
                let touch = self.surface.core(pair) + self.surface.threshold(pair.edges);
                fraction = match pair.side {
                    EDGE => safe_fraction(&nodes, &moves, touch + standoff, fraction),
                    TUBE => safe_fraction_in_tube(&nodes, &moves[0], touch, fraction),
                    // A counter-pair is never nearer than the pairs from which it is subtracted.
                    _ if pair.sign() < 0.0 => fraction,
                    side if pair.is_with_rim() => {
                        let rim = self.surface.rim_of(pair, &points);
                        let bounds = [touch, KEPT_GAP];
                        safe_fraction_at_rim(side, &nodes, &moves, &rim, bounds, fraction)
                    }
                    _ if pair.is_with_patch() => {
                        self.safe_fraction_over_patch(pair, &points, &moves[0], touch, fraction)
                    }
                    _ if self.is_of_rod(pair.nodes[3]) => {
                        safe_fraction_at_triangle(&nodes, &moves, touch, fraction)
                    }
                    side => {
                        let side = f64::from(side);
                        safe_fraction_over_face(&nodes, &moves[0], side, touch, fraction)
                    }
                };
            }
        }
        fraction
    }

    /// The fraction, at most `longest`, of a straight path of the node of a pair by `displacement`
    /// that a smooth part of a mesh allows: until its gap is a tenth of the gap at which the node is
    /// first over the surface.
    ///
    /// From each point the path advances as far as the slope of the gap and twice its present
    /// curvature allow, and at most by the distance of the node from the surface.
    fn safe_fraction_over_patch(
        &self,
        pair: &CandidatePair,
        points: &Points,
        displacement: &Vector3,
        touch: f64,
        longest: f64,
    ) -> f64 {
        let start = points.at(pair.nodes[0]);
        let length = displacement.norm();
        let at = |fraction: f64| {
            let there = start + displacement * fraction;
            self.surface.foot_over(pair, &there, points)
        };
        let (mut fraction, mut foot) = match at(0.0) {
            Some(foot) => (0.0, foot),
            None => match first_over(&at, longest) {
                Some((first, foot)) if foot.distance > touch => (first, foot),
                _ => return longest, // it comes from beside, where edges of the rod are bounded
            },
        };
        let gap = (foot.distance - touch).max(0.0);
        let kept = KEPT_GAP * gap;
        for _ in 0..MOST_ADVANCES {
            let slack = foot.distance - touch - kept;
            if slack <= USED_UP * kept {
                break;
            }
            // slack + a s − b s² = 0
            let a = foot.normal.dot(displacement);
            let bend = self.surface.bend_at(pair, &foot, points);
            let b = bend.turning.norm() * length * length;
            let reach = 2.0 * slack / ((a * a + 4.0 * b * slack).sqrt() - a).max(f64::MIN_POSITIVE);
            let mut advance = reach.min(touch / length).min(longest - fraction);
            loop {
                let Some(next) = at(fraction + advance) else {
                    return longest;
                };
                if next.distance - touch >= (1.0 - USED_UP) * kept {
                    foot = next;
                    break;
                }
                advance *= 0.5;
                if advance * length < SHORTEST * touch {
                    return fraction;
                }
            }
            fraction += advance;
            if fraction >= longest {
                return longest;
            }
        }
        fraction
    }

    /// The fraction that the planes allow: the nodes approach them at constant speed.
    fn safe_fraction_over_planes(&self, start: &[Vector3], displacements: &[Vector3]) -> f64 {
        let mut fraction = 1.0;
        for (index, plane) in self.planes().iter().enumerate() {
            for surface in self.surface.nodes() {
                if self.surface.roots.frees_from_plane(surface.node, index) {
                    continue;
                }
                let gap = plane.distance(&start[surface.node]) - surface.radius;
                let fall = -displacements[surface.node].dot(&plane.normal);
                let slack = ((1.0 - KEPT_GAP) * gap).max(0.0);
                if gap <= 0.0 {
                    return 0.0;
                }
                if fall * fraction > slack {
                    fraction = slack / fall;
                }
            }
        }
        fraction
    }
}

/// The first part of a path, up to `longest`, at which the node is over a smooth part of a mesh that
/// it is not over at the beginning, with its foot there; `None` if it is not over it at the end.
fn first_over(at: &impl Fn(f64) -> Option<PatchPoint>, longest: f64) -> Option<(f64, PatchPoint)> {
    let (mut before, mut first) = (0.0, (longest, at(longest)?));
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (before + first.0);
        match at(middle) {
            Some(foot) => first = (middle, foot),
            None => before = middle,
        }
    }
    Some(first)
}

/// The fraction, at most `longest`, of a straight path of a node in a tube, by `displacement`,
/// along which its gap from the wall, measured across the axis, stays above a tenth of its present
/// value.
fn safe_fraction_in_tube(
    nodes: &[Vector3; 4],
    displacement: &Vector3,
    touch: f64,
    longest: f64,
) -> f64 {
    let Some(closest) = ClosestPoints::within_tube(nodes) else {
        return longest;
    };
    let gap = (closest.distance() - touch).max(0.0);
    let axis = (nodes[3] - nodes[2]).normalize();
    let across = displacement - axis * displacement.dot(&axis);
    // |ρ + s u| = r for the part s of the way at which a tenth of the gap is left.
    let (start, way) = (closest.separation, across);
    let limit = -closest.distance() + (1.0 - KEPT_GAP) * gap;
    let (square, mixed) = (way.norm_squared(), start.dot(&way));
    if square == 0.0 {
        return longest;
    }
    let room = (limit * limit - start.norm_squared()).max(0.0);
    let meets = ((mixed * mixed + square * room).sqrt() - mixed) / square;
    meets.min(longest)
}

/// The fraction, at most `longest`, of a straight path of the first node, by `displacement`, that
/// a face allows: until its gap over the face is a tenth of the gap at which the node first comes
/// over the face.
fn safe_fraction_over_face(
    nodes: &[Vector3; 4],
    displacement: &Vector3,
    side: f64,
    touch: f64,
    longest: f64,
) -> f64 {
    let [node, a, b, c] = *nodes;
    let (Some(start), Some(end)) = (
        Foot::in_plane(nodes, side),
        Foot::in_plane(&[node + displacement, a, b, c], side),
    ) else {
        return longest;
    };
    let fall = start.distance - end.distance;
    if fall <= 0.0 {
        return longest;
    }
    // Interval in which the foot is within the triangle: its weights are linear along the path.
    let (mut first, mut last) = (0.0_f64, longest);
    for (before, after) in start.weights.iter().zip(end.weights) {
        if *before < 0.0 && after <= *before {
            return longest;
        }
        let meets = before / (before - after);
        if *before < 0.0 {
            first = first.max(meets);
        } else if after < 0.0 {
            last = last.min(meets);
        }
    }
    let gap = start.distance - first * fall - touch;
    if first > last || (gap <= 0.0 && first > 0.0) {
        return longest; // it comes from beside, where the rim has watched over it
    }
    let meets = (first + (1.0 - KEPT_GAP) * gap.max(0.0) / fall).max(0.0);
    if meets > last {
        longest
    } else {
        meets.min(longest)
    }
}

#[cfg(test)]
mod tests {
    use super::super::closest_points::edge_distance;
    use super::super::test_support::Random;
    use super::super::{ContactModel, ContactParameters, ContactPlane, ContactSurface};
    use super::*;

    const RADIUS: f64 = 1e-3;
    const GAP: f64 = 1e-5;

    /// Layers of straight rods across each other, a hundredth of a radius apart, the lowest layer
    /// over a plane.
    fn stack(model: ContactModel) -> (ContactSystem, Vec<Vector3>) {
        let mut surface = ContactSurface::new();
        let mut positions = Vec::new();
        for rod in 0..16 {
            let (layer, row) = (rod / 4, f64::from(rod % 4));
            let height = RADIUS + GAP + f64::from(layer) * (2.0 * RADIUS + GAP);
            let centreline: Vec<Vector3> = (0..8)
                .map(|k| {
                    let offset = [4.3 * f64::from(k) - 6.0, 5.0 * row].map(|x| x * RADIUS);
                    let turned = layer as usize % 2;
                    Vector3::new(offset[turned], offset[1 - turned], height)
                })
                .collect();
            surface.add_rod(positions.len(), &centreline, false, RADIUS, false);
            positions.extend(centreline);
        }
        let plane = ContactPlane {
            point: Vector3::zeros(),
            normal: Vector3::z(),
            friction: None,
            directed_friction: None,
        };
        let parameters = ContactParameters {
            model,
            ..ContactParameters::default()
        };
        let contact = ContactSystem::new(parameters, surface, vec![plane], 1.0);
        (contact, positions)
    }

    /// Least gap between all surfaces, m, by brute force.
    fn least_gap(contact: &ContactSystem, positions: &[Vector3]) -> f64 {
        let edges = contact.surface().edges();
        let mut least = f64::INFINITY;
        for i in 0..edges.len() {
            for j in i + 1..edges.len() {
                if contact.surface().may_touch(i, j) {
                    let [a, b] = edges[i].nodes.map(|node| positions[node]);
                    let [c, d] = edges[j].nodes.map(|node| positions[node]);
                    least = least.min(edge_distance(&[a, b, c, d]) - 2.0 * RADIUS);
                }
            }
        }
        let heights = positions.iter().map(|x| x.z - RADIUS);
        heights.fold(least, f64::min)
    }

    #[test]
    fn nothing_crosses_on_the_path_however_long_it_is() {
        let (mut longest, mut rebuilt) = (0.0_f64, 0);
        for seed in 0..60 {
            let (mut contact, start) = stack(ContactModel::IncrementalPotential);
            let mut random = Random::new(seed);
            // Moves apart or together, by up to a hundred radii.
            let size = RADIUS * 10f64.powf(2.0 * random.symmetric());
            let spread = Vector3::new(0.0, 0.0, 30.0 * (1.0 + random.symmetric()));
            let moves: Vec<Vector3> = start
                .iter()
                .map(|x| spread * x.z + random.vector() * size)
                .collect();
            contact.update_candidates(&start);
            let step = contact.largest_step(&start, &moves);
            assert!(step.fraction > 0.0 && step.fraction <= 1.0);
            for sample in 0..=40 {
                let t = step.fraction * f64::from(sample) / 40.0;
                let there: Vec<Vector3> =
                    start.iter().zip(&moves).map(|(x, m)| x + m * t).collect();
                assert!(least_gap(&contact, &there) > 0.099 * GAP, "{seed} at {t}");
            }
            let end: Vec<Vector3> = start
                .iter()
                .zip(&moves)
                .map(|(x, m)| x + m * step.fraction)
                .collect();
            assert!(contact.candidates_are_complete(&end));
            longest = longest.max(step.fraction);
            rebuilt += usize::from(step.candidates_changed);
        }
        assert!(longest == 1.0 && rebuilt > 10, "{longest} {rebuilt}");
    }

    #[test]
    fn a_penalty_sets_no_bound() {
        let (mut contact, start) = stack(ContactModel::ImplicitContact);
        let moves = vec![Vector3::z() * -1.0; start.len()];
        assert_eq!(contact.largest_step(&start, &moves).fraction, 1.0);
    }

    #[test]
    fn surfaces_in_contact_may_not_move() {
        let (mut contact, mut positions) = stack(ContactModel::IncrementalPotential);
        for x in &mut positions {
            x.z -= GAP;
        }
        let moves = vec![Vector3::z(); positions.len()];
        assert_eq!(contact.largest_step(&positions, &moves).fraction, 0.0);
    }
}
