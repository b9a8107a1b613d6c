//! Certificate that no bodies passed through each other in an accepted step.
//!
//! Within a step the nodes are assumed to move along straight lines. At both ends the surfaces
//! overlap by at most the fraction p of their touching distance T = h_i + h_j that the parameters
//! allow: Δ ≥ (1 − p) T. Two edges whose nodes move by at most M approach by at most 2M s in the
//! part s of the step, so that in between
//!
//! Δ ≥ max{(1 − p) T − 2M s, (1 − p) T − 2M (1 − s)} ≥ (1 − p) T − M,
//!
//! and centrelines keep [`KEPT_PART`] of the allowed distance if M ≤ (1 − [`KEPT_PART`])(1 − p) T.
//! For most steps of most scenes the certificate therefore costs one comparison per node. For
//! larger M, boxes around the whole paths find the pairs whose paths come near each other, and
//! continuous collision detection tests these pairs.
//!
//! For planes the two ends suffice, since the distance of a node from a plane is linear in time. A
//! node has passed through a face of an obstacle if it ends on the other side of the plane of the
//! face and was within the edges of the face when it crossed the plane. A tube is convex, so a
//! node that is inside at both ends stays inside. Rods that touch the rim of a tube keep their
//! distance from it.

use super::closest_points::ClosestPoints;
use super::contact_system::ContactSystem;
use super::contacts::{CandidatePair, ContactPair, TUBE};
use super::continuous_collision::fraction_beyond;
use super::foot::crossing;
use super::rim::{RimPoint, fraction_beyond_rim};
use crate::mechanics::Vector3;

/// Fraction of the least distance allowed at the ends of a step that centrelines must keep within
/// the step. Zero would be enough to detect passing through. One half needs only a few advances of
/// continuous collision detection, and none if the nodes move by less than 0.95 radii.
const KEPT_PART: f64 = 0.5;

/// Tolerance of the certificate: a pair may come nearer than required by a tenth of the kept
/// distance.
const TOLERANCE: f64 = 0.1;

/// Weight of a corner by which a node may pass beside a curved face and still count as passing through
/// it, so that none slips through between two faces.
const BESIDE: f64 = 1e-6;

impl ContactSystem {
    /// Finds two edges that pass, or nearly pass, through each other if all nodes move along
    /// straight lines from `start` to `end`, m; `None` if there are certainly none.
    ///
    /// At `start` and `end` no surfaces may overlap by more than `maximum_penetration`.
    pub(crate) fn passage(&mut self, start: &[Vector3], end: &[Vector3]) -> Option<ContactPair> {
        let allowed = 1.0 - self.parameters.maximum_penetration;
        let (start, end) = (self.placed(start), self.placed(end));
        let (start, end) = (start.as_ref(), end.as_ref());
        let moved = start.iter().zip(end).map(|(a, b)| (b - a).norm_squared());
        let largest = moved.fold(0.0, f64::max);
        let largest = largest.max(self.obstacles.largest_move().powi(2));
        let certain = (1.0 - KEPT_PART) * allowed * self.surface.least_threshold();
        if largest <= certain * certain {
            return None;
        }
        let mut pairs = std::mem::take(&mut self.swept_pairs);
        self.broad_phase
            .find_swept(&self.surface, start, end, &mut pairs);
        self.surface.find_swept_at_bodies(start, end, &mut pairs);
        self.obstacles
            .find_swept(&self.surface, start, end, &mut pairs);
        let passing = pairs
            .iter()
            .find_map(|pair| self.passage_of(pair, start, end));
        self.swept_pairs = pairs;
        passing
    }

    fn passage_of(
        &self,
        pair: &CandidatePair,
        start: &[Vector3],
        end: &[Vector3],
    ) -> Option<ContactPair> {
        let nodes = self.obstacles.points_at_start(start).of(pair.nodes);
        let ends = self.obstacles.points(end).of(pair.nodes);
        if pair.is_with_face() {
            let is_smooth = self.surface.is_smooth_face(pair.edges[1])
                && self.surface.is_rod_node(pair.nodes[0]);
            // Sides of other faces are tested against the edges of rods.
            let beside = if is_smooth { BESIDE } else { 0.0 };
            let (_, weights) = crossing(&nodes, &ends, -beside)?;
            let stays = is_smooth && self.stays_over_patch(pair, [start, end], &weights);
            return (!stays).then_some(ContactPair::Edges(pair.edges));
        }
        if pair.is_with_rim() {
            let (before, after) = (
                self.obstacles.points_at_start(start),
                self.obstacles.points(end),
            );
            let rims = [before, after].map(|points| self.surface.rim_of(pair, &points));
            RimPoint::of(pair.side, &nodes, &rims[0])?;
            let threshold = self.surface.threshold(pair.edges);
            let kept = KEPT_PART * (1.0 - self.parameters.maximum_penetration) * threshold;
            let (paths, rims) = ([&nodes, &ends], [&rims[0], &rims[1]]);
            let bounds = [kept, TOLERANCE * kept];
            let fraction = fraction_beyond_rim(pair.side, paths, rims, bounds, 1.0);
            return (fraction < 1.0).then_some(ContactPair::Edges(pair.edges));
        }
        if pair.side == TUBE {
            let wall = -self.surface.core(pair);
            let [before, after] = [nodes, ends].map(|nodes| ClosestPoints::within_tube(&nodes));
            let is_inside = |closest: ClosestPoints| -closest.distance() < wall;
            let passes = before.is_some_and(is_inside) && after.is_some_and(|at| !is_inside(at));
            return passes.then_some(ContactPair::Edges(pair.edges));
        }
        let displacements = std::array::from_fn(|k| ends[k] - nodes[k]);
        let threshold = self.surface.threshold(pair.edges);
        let kept = KEPT_PART * (1.0 - self.parameters.maximum_penetration) * threshold;
        let least = [self.surface.core(pair) + kept, TOLERANCE * kept];
        let fraction = fraction_beyond(&nodes, &displacements, least, 1.0);
        (fraction < 1.0).then_some(ContactPair::Edges(pair.edges))
    }

    /// Whether the node of a pair with a curved face stays on one side of the smooth surface though
    /// it crosses the flat face, at a point with these weights of the corners. The flat face is
    /// above a concave surface, and below a convex one.
    fn stays_over_patch(
        &self,
        pair: &CandidatePair,
        [start, end]: [&[Vector3]; 2],
        [a, b, c]: &[f64; 3],
    ) -> bool {
        let face = pair.edges[1] - self.surface.edges().len();
        let (before, after) = (
            self.obstacles.points_at_start(start),
            self.obstacles.points(end),
        );
        let [p, q, r] = after.of(self.surface.faces()[face].vertices);
        let places = [
            (before.at(pair.nodes[0]), before),
            (p * *a + q * *b + r * *c, after),
            (after.at(pair.nodes[0]), after),
        ];
        let heights = places.map(|(place, points)| {
            let foot = self.surface.foot_from(face, 1.0, &place, &points);
            foot.map(|foot| foot.distance)
        });
        let all = |is_so: fn(f64) -> bool| heights.iter().all(|height| height.is_some_and(is_so));
        all(|height| height > 0.0) || all(|height| height < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::closest_points::edge_distance;
    use super::super::test_support::Random;
    use super::super::{ContactModel, ContactParameters, ContactSurface};
    use super::*;

    const RADIUS: f64 = 1e-3;

    /// Two layers of straight rods of six edges across each other, a radius apart.
    fn layers() -> (ContactSystem, Vec<Vector3>) {
        let mut surface = ContactSurface::new();
        let mut positions = Vec::new();
        for rod in 0..6 {
            let (layer, row) = (rod / 3, f64::from(rod % 3));
            let centreline: Vec<Vector3> = (0..7)
                .map(|k| {
                    let along = [3.0 * f64::from(k) - 9.0, 6.0 * row - 6.0].map(|x| x * RADIUS);
                    let turned = layer as usize;
                    let height = 3.0 * RADIUS * f64::from(layer);
                    Vector3::new(along[turned], along[1 - turned], height)
                })
                .collect();
            surface.add_rod(positions.len(), &centreline, false, RADIUS, rod == 0);
            positions.extend(centreline);
        }
        let parameters = ContactParameters {
            model: ContactModel::Complementarity,
            ..ContactParameters::default()
        };
        let contact = ContactSystem::new(parameters, surface, Vec::new(), 1.0);
        (contact, positions)
    }

    /// Least ratio of the distance of centrelines to the distance at which their surfaces touch.
    fn least_ratio(contact: &ContactSystem, positions: &[Vector3]) -> f64 {
        let edges = contact.surface().edges();
        let pairs = (0..edges.len()).flat_map(|i| (i + 1..edges.len()).map(move |j| [i, j]));
        pairs
            .filter(|&[i, j]| contact.surface().may_touch(i, j))
            .map(|pair| {
                let [[a, b], [c, d]] = pair.map(|k| edges[k].nodes);
                edge_distance(&[a, b, c, d].map(|node| positions[node])) / (2.0 * RADIUS)
            })
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn no_passage_is_missed_and_none_invented() {
        let (mut passed, mut near, mut free) = (0, 0, 0);
        for seed in 0..600 {
            let (mut contact, start) = layers();
            let mut random = Random::new(seed);
            let size = RADIUS * 10f64.powf(0.9 * random.symmetric());
            let sink = RADIUS * 4.0 * (1.0 + random.symmetric());
            let end: Vec<Vector3> = start
                .iter()
                .enumerate()
                .map(|(node, x)| {
                    let held = node < 7;
                    let fall = Vector3::z() * if x.z > 0.0 { -sink } else { 0.0 };
                    let moved = fall + random.vector() * size;
                    if held { *x } else { x + moved }
                })
                .collect();
            if least_ratio(&contact, &end) < 0.95 {
                continue;
            }
            let least = (0..=100)
                .map(|sample| {
                    let t = f64::from(sample) / 100.0;
                    let between: Vec<Vector3> = start
                        .iter()
                        .zip(&end)
                        .map(|(a, b)| a + (b - a) * t)
                        .collect();
                    least_ratio(&contact, &between)
                })
                .fold(f64::INFINITY, f64::min);
            let found = contact.passage(&start, &end);
            if least < 0.47 {
                assert!(found.is_some(), "{seed}: {least}");
                passed += 1;
            } else if least > 0.55 {
                assert!(found.is_none(), "{seed}: {least}");
                free += 1;
            } else {
                near += 1;
            }
        }
        assert!(passed > 20 && free > 20, "{passed} {near} {free}");
    }
}
