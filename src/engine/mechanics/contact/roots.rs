//! Pairs that contact ignores at roots, and distances of clamped nodes from bodies in which they
//! may be rooted.

use super::closest_points::{ClosestPoints, edge_distance};
use super::contact_system::ContactSystem;
use super::foot::Foot;
use super::root::{Root, RootBody};
use super::surface::ContactSurface;
use crate::mechanics::Vector3;

impl ContactSurface {
    fn add_root(&mut self, root: &Root) {
        if let RootBody::HeldRod(held) = root.body {
            return self.join([root.rod, held], [Some(root.arc_length), None], root.reach);
        }
        let (mut edges, mut nodes) = (Vec::new(), Vec::new());
        for (index, edge) in self.rod_edges().iter().enumerate() {
            if edge.rod == root.rod && self.way_to(edge, root.arc_length) < root.reach {
                edges.push(index);
            }
        }
        for edge in self.rod_edges().iter().filter(|edge| edge.rod == root.rod) {
            for (node, place) in edge.nodes.iter().zip(edge.arc_length) {
                let mut end = *edge;
                end.arc_length = [place; 2];
                if self.way_to(&end, root.arc_length) < root.reach {
                    nodes.push(*node);
                }
            }
        }
        let roots = &mut self.roots;
        let list = match root.body {
            RootBody::Plane(plane) => {
                roots.planes.extend(nodes.iter().map(|node| [*node, plane]));
                &mut roots.planes
            }
            RootBody::Obstacle(obstacle) => {
                let passing = edges.iter().map(|edge| [*edge, obstacle]);
                roots.edges.extend(passing);
                roots.edges.sort_unstable();
                roots.edges.dedup();
                (roots.nodes).extend(nodes.iter().map(|node| [*node, obstacle]));
                &mut roots.nodes
            }
            RootBody::HeldRod(_) => return,
        };
        list.sort_unstable();
        list.dedup();
    }
}

impl ContactSystem {
    /// Ignores contact of a rod with the body in which it is rooted. Call this before the first
    /// candidates.
    pub(crate) fn pass_over_root(&mut self, root: &Root) {
        self.surface.add_root(root);
    }

    /// Ignores contact of a rod with a free body near a joint at an arc length, m. Call this before
    /// the first candidates.
    pub(crate) fn join_body(&mut self, rods: [usize; 2], arc_length: f64, reach: f64) {
        self.surface
            .join(rods, [Some(arc_length), Some(0.0)], reach);
    }

    /// Ignores contact of two rods near two clamped nodes without relative motion, as at a joint.
    /// The nodes are given by their arc lengths (m), and `angle` (rad) is the angle at which the
    /// rods leave them. Returns the reach, m. Call this before the first candidates.
    pub(crate) fn pass_over_common_root(
        &mut self,
        rods: [usize; 2],
        arc_length: [f64; 2],
        angle: f64,
    ) -> f64 {
        self.surface.add_joint(rods, arc_length, angle)
    }

    /// Distance between the surface of a body and a sphere of radius `radius` around a point, m,
    /// with all nodes at `positions`. For a point inside a closed obstacle it is less than minus
    /// the radius.
    pub(crate) fn gap_to(
        &self,
        body: RootBody,
        point: &Vector3,
        radius: f64,
        positions: &[Vector3],
    ) -> f64 {
        match body {
            RootBody::Plane(plane) => self.planes[plane].distance(point) - radius,
            RootBody::HeldRod(rod) => {
                let edges = self.surface.rod_edges().iter();
                let gaps = edges.filter(|edge| edge.rod == rod).map(|edge| {
                    let [a, b] = edge.nodes.map(|node| positions[node]);
                    edge_distance(&[*point, *point, a, b]) - edge.radius
                });
                gaps.fold(f64::INFINITY, f64::min) - radius
            }
            RootBody::Obstacle(obstacle) => {
                self.gap_to_obstacle(obstacle, point, positions) - radius
            }
        }
    }

    /// Distance of a point from the surface of an obstacle, m.
    fn gap_to_obstacle(&self, obstacle: usize, point: &Vector3, positions: &[Vector3]) -> f64 {
        let body = &self.surface.obstacles()[obstacle];
        let points = self.obstacles.points(positions);
        let own = |index: &usize| self.surface.obstacle_of(*index) == Some(obstacle);
        let first = self.surface.rod_edges().len();
        let segments = (first..self.surface.edges().len()).filter(own).map(|edge| {
            let [a, b] = points.of(self.surface.edges()[edge].nodes);
            let nodes = [*point, *point, a, b];
            if body.hollow {
                // There is no contact outside the wall; a point on the wall counts as inside.
                let inside = ClosestPoints::in_tube(&nodes);
                inside.map_or(f64::INFINITY, |inside| {
                    (inside.distance() + body.radius).abs()
                })
            } else {
                edge_distance(&nodes) - body.radius
            }
        });
        let faces = self.surface.faces().iter();
        let faces = faces
            .filter(|face| face.obstacle == Some(obstacle))
            .filter_map(|face| {
                let [a, b, c] = points.of(face.vertices);
                let foot = Foot::of(&[*point, a, b, c], 1.0)?;
                Some(foot.distance.abs() - body.radius)
            });
        let nearest = segments.chain(faces).fold(f64::INFINITY, f64::min);
        if body.closed && self.surface.is_inside(obstacle, point, &points) {
            -nearest.abs() - 2.0 * body.radius
        } else {
            nearest
        }
    }
}
