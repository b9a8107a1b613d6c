//! Points at which surfaces touch, for pictures; forces and stored data are not used.

use super::broad_phase::BroadPhase;
use super::closest_points::ClosestPoints;
use super::nearest_points::NearestPoints;
use super::placed_obstacles::PlacedObstacles;
use super::plane::ContactPlane;
use super::surface::ContactSurface;
use crate::mechanics::Vector3;
use crate::mechanics::rotation::Pose;

/// Points at which rods touch each other, a plane or an obstacle: where the gap between the surfaces is below
/// `clearance` (m). A point is in the middle of the gap between two rods, or on the plane or obstacle.
///
/// `positions` are those of all nodes, m; `poses` are those of all obstacles.
pub fn touching_points(
    surface: &ContactSurface,
    planes: &[ContactPlane],
    poses: &[Pose],
    positions: &[Vector3],
    clearance: f64,
) -> Vec<Vector3> {
    let mut pairs = Vec::new();
    BroadPhase::default().find(surface, positions, clearance, &mut pairs);
    let mut points: Vec<Vector3> = pairs
        .iter()
        .map(|(pair, _)| {
            let nodes = pair.nodes.map(|node| positions[node]);
            let closest = ClosestPoints::of(&nodes);
            let on_second = nodes[2] + (nodes[3] - nodes[2]) * closest.ratios[1];
            let [first, second] = pair.edges.map(|edge| surface.edges()[edge].radius);
            // The middle of the gap: nearer to the centreline of the thinner rod.
            let part = 0.5 * (1.0 + (second - first) / closest.distance());
            on_second + closest.separation * part
        })
        .collect();
    let mut obstacles = PlacedObstacles::new(surface);
    for (index, pose) in poses.iter().enumerate() {
        obstacles.place(surface, index, *pose);
    }
    pairs.clear();
    obstacles.find(surface, positions, clearance, &mut pairs);
    let placed = obstacles.points(positions);
    let counted = pairs.iter().filter(|(pair, _)| pair.sign() > 0.0);
    points.extend(counted.filter_map(|(pair, distance)| {
        let nearest = NearestPoints::of(surface, pair, &placed, 0.0)?;
        let first = pair
            .nodes
            .iter()
            .zip(nearest.weights())
            .take(pair.first_body());
        let on_rod: Vector3 = first.map(|(node, weight)| placed.at(*node) * weight).sum();
        Some(on_rod - nearest.normal() * *distance)
    }));
    for plane in planes {
        for node in surface.nodes() {
            let position = positions[node.node];
            let distance = plane.distance(&position);
            if distance < node.radius + clearance {
                points.push(position - plane.normal * distance);
            }
        }
    }
    points
}

impl ContactSurface {
    /// Whether an end of the second of two edges of rods is inside the first: nearer to its
    /// centreline than `part` of the sum of the radii, and farther from its ends than this sum.
    pub(crate) fn has_end_inside(
        &self,
        [edge, other]: [usize; 2],
        positions: &[Vector3],
        part: f64,
    ) -> bool {
        let sum = self.threshold([edge, other]);
        let [start, end] = self.edges[edge].nodes.map(|node| positions[node]);
        let length = (end - start).norm();
        let along = (end - start) / length;
        self.edges[other].nodes.iter().any(|node| {
            let from_start = positions[*node] - start;
            let way = from_start.dot(&along);
            sum < way && way < length - sum && (from_start - along * way).norm() < part * sum
        })
    }
}

/// Pairs of edges that may touch and whose centrelines are nearer to each other than `part` of the
/// sum of their radii, for the positions of all nodes, m.
pub(crate) fn overlapping_edges(
    surface: &ContactSurface,
    positions: &[Vector3],
    part: f64,
) -> impl Iterator<Item = [usize; 2]> {
    let mut pairs = Vec::new();
    BroadPhase::default().find(surface, positions, 0.0, &mut pairs);
    let deep = pairs
        .into_iter()
        .filter(move |(pair, distance)| *distance < part * surface.threshold(pair.edges));
    deep.map(|(pair, _)| pair.edges)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thin rod along x on the plane z = 0, a thick one along y above it.
    fn cross(gap: f64) -> (ContactSurface, Vec<Vector3>) {
        let mut surface = ContactSurface::new();
        let low = [
            Vector3::new(-1.0, 0.0, 0.1),
            Vector3::new(1.0, 0.0, 0.1 + 1e-6),
        ];
        let height = 0.1 + 0.1 + 0.3 + gap;
        let high = [
            Vector3::new(0.0, -1.0, height),
            Vector3::new(0.0, 1.0, height),
        ];
        surface.add_rod(0, &low, false, 0.1, false);
        surface.add_rod(2, &high, false, 0.3, false);
        (surface, [low, high].concat())
    }

    #[test]
    fn rods_of_unlike_radius_touch_between_their_surfaces() {
        let (surface, positions) = cross(0.01);
        let points = touching_points(&surface, &[], &[], &positions, 0.02);
        assert_eq!(points.len(), 1);
        assert!(
            (points[0] - Vector3::new(0.0, 0.0, 0.205)).norm() < 1e-5,
            "{points:?}"
        );
        assert!(touching_points(&surface, &[], &[], &positions, 0.005).is_empty());
    }

    #[test]
    fn nodes_touch_planes_at_their_feet() {
        let (surface, positions) = cross(1.0);
        let floor = ContactPlane {
            point: Vector3::zeros(),
            normal: Vector3::z(),
            friction: None,
            directed_friction: None,
        };
        let points = touching_points(&surface, &[floor], &[], &positions, 1e-3);
        assert_eq!(points, [-Vector3::x(), Vector3::x()]);
    }
}
