//! Reflex edges of a mesh, at the bottom of a valley: a rod that touches such an edge also touches
//! a face or another edge.
//!
//! Suppose that two faces make an angle of less than π on the side of a rod. A point near their
//! common edge is nearer still to one of the faces: with the directions b₁ and b₂ in which the
//! faces leave the edge e, and the direction d from the edge to the point, d = α b₁ + β b₂ up to a
//! part along e with positive α and β, so that d·b₁ > 0 or d·b₂ > 0. The least distance of a
//! straight edge of a rod from the mesh is then the distance of one of its ends from a face, or its
//! distance from another edge. Contact with these faces and edges is therefore enough. This also
//! holds for the ends of such an edge: if all edges at a vertex are reflex, the free space around
//! it is convex.

use super::contacts::{CandidatePair, EDGE};
use super::foot::Points;
use super::surface::ContactSurface;
use crate::mechanics::Vector3;

impl ContactSurface {
    /// Whether a pair consists of an edge of a rod and a reflex edge of an obstacle, seen along
    /// the `direction` from the obstacle's edge to the rod's.
    pub(super) fn is_at_reflex_edge(
        &self,
        pair: &CandidatePair,
        direction: &Vector3,
        points: &Points,
    ) -> bool {
        if pair.side != EDGE {
            return false;
        }
        let Some(opposite) = self.opposite(pair.edges[1]) else {
            return false;
        };
        let [start, end] = points.of([pair.nodes[2], pair.nodes[3]]);
        is_between(
            direction,
            &(end - start),
            &points.of(opposite).map(|x| x - start),
        )
    }
}

/// Whether a direction, seen along an edge, is between two others on the side where they make an
/// angle of less than π.
fn is_between(direction: &Vector3, edge: &Vector3, [first, second]: &[Vector3; 2]) -> bool {
    let turn = |from: &Vector3, to: &Vector3| edge.dot(&from.cross(to));
    let whole = turn(first, second);
    turn(first, direction) * whole > 0.0 && turn(direction, second) * whole > 0.0
}

#[cfg(test)]
mod tests {
    use super::super::closest_points::ClosestPoints;
    use super::super::foot::Foot;
    use super::super::placed_obstacles::PlacedObstacles;
    use super::super::test_support::Random;
    use super::*;
    use crate::mechanics::rigid_body::RigidBody;

    /// Two triangles on either side of an edge, and an edge of a rod near it.
    struct Fold {
        surface: ContactSurface,
        vertices: [Vector3; 4],
        rod: [Vector3; 2],
    }

    impl Fold {
        fn random(random: &mut Random) -> Self {
            let vertices = [
                Vector3::new(0.0, -1.0, 0.0),
                Vector3::new(0.0, 1.0, 0.0),
                Vector3::new(-1.0, 0.0, 0.0) + random.vector() * 0.7,
                Vector3::new(1.0, 0.0, 0.0) + random.vector() * 0.7,
            ];
            let middle = Vector3::z() * 0.6 + random.vector();
            let along = random.vector();
            let rod = [middle - along, middle + along];
            let mut surface = ContactSurface::new();
            surface.add_rod(0, &rod, false, 0.1, false);
            let faces = vec![[0, 2, 1], [0, 1, 3]];
            let sheet = RigidBody::of_mesh(vertices.to_vec(), faces, false);
            surface.add_obstacle(sheet.unwrap(), None);
            Self {
                surface,
                vertices,
                rod,
            }
        }

        fn distance(&self, ends: [usize; 2]) -> f64 {
            let [a, b] = ends.map(|vertex| self.vertices[vertex]);
            ClosestPoints::of(&[self.rod[0], self.rod[1], a, b]).distance()
        }

        /// Whether the common edge is ignored, and its distance from the edge of the rod.
        fn common_edge(&self) -> (bool, f64) {
            let edges = self.surface.edges();
            let common = (1..edges.len()).find(|edge| self.surface.opposite(*edge).is_some());
            let edge = common.expect("an edge with two faces");
            let [c, d] = edges[edge].nodes;
            let pair = CandidatePair {
                edges: [0, edge],
                nodes: [0, 1, c, d],
                side: EDGE,
                start: 0,
            };
            let placed = PlacedObstacles::new(&self.surface);
            let points = placed.points(&self.rod);
            let closest = ClosestPoints::of(&points.of(pair.nodes));
            let hidden = self
                .surface
                .is_at_reflex_edge(&pair, &closest.separation, &points);
            (hidden, closest.distance())
        }

        /// The least distance from all features except the common edge.
        fn other_distance(&self) -> f64 {
            let rims = [[0, 2], [2, 1], [0, 3], [3, 1]].map(|ends| self.distance(ends));
            let faces = [[0, 2, 1], [0, 1, 3]].map(|face| face.map(|vertex| self.vertices[vertex]));
            let feet = faces.iter().flat_map(|&[a, b, c]| {
                let foot = move |node: &Vector3| Foot::of(&[*node, a, b, c], 1.0);
                self.rod.iter().filter_map(foot)
            });
            let feet = feet.map(|foot| foot.distance.abs());
            rims.into_iter().chain(feet).fold(f64::INFINITY, f64::min)
        }

        /// Whether an edge of the rod passes through a triangle, so that distances from its sides
        /// do not apply.
        fn is_pierced(&self) -> bool {
            [[0, 2, 1], [0, 1, 3]].into_iter().any(|face| {
                let [a, b, c] = face.map(|vertex| self.vertices[vertex]);
                let path = |node: Vector3| [node, a, b, c];
                super::super::foot::crossing(&path(self.rod[0]), &path(self.rod[1]), 0.0).is_some()
            })
        }
    }

    #[test]
    fn what_is_not_felt_is_never_the_nearest() {
        let mut random = Random::new(41);
        let (mut hidden, mut nearest) = (0, 0);
        for _ in 0..4000 {
            let fold = Fold::random(&mut random);
            if fold.is_pierced() {
                continue;
            }
            let (is_hidden, distance) = fold.common_edge();
            let other = fold.other_distance();
            if is_hidden {
                assert!(other <= distance + 1e-12, "{other} {distance}");
                hidden += 1;
            } else if distance < other {
                nearest += 1;
            }
        }
        // Both cases are frequent: reflex edges are ignored, and convex edges under the rod have
        // contact.
        assert!(hidden > 300 && nearest > 300, "{hidden} {nearest}");
    }
}
