//! Faces of free bodies: search for nodes of rods and vertices of other bodies near them, and
//! contact with a face that moves.
//!
//! With the weights λₖ of the corners xₖ at the foot of a node p, the unit normal n and the
//! distance d = n·(p − Σ λₖ xₖ) of the node,
//!
//! ```text
//! δd = n·δu,    δn = −Σ ∇λₖ (n·δxₖ),    δλₖ = ∇λₖ·(δu − d δn),    δu = δp − Σ λⱼ δxⱼ.
//! ```
//!
//! The force is that of two edges ([`super::edge_contact`]) with four nodes.

use super::box_tree::AlignedBox;
use super::contacts::{CandidatePair, ContactMotion, EdgeJacobian, Linearised};
use super::continuous_collision::safe_fraction_from;
use super::foot::Foot;
use super::normal_response::NormalResponse;
use super::surface::{ContactFace, ContactNode, ContactSurface};
use crate::mechanics::Vector3;

impl ContactSurface {
    /// Index of a free body, counted from 0, among the rods.
    pub(crate) fn index_of_body(&self, body: usize) -> Option<usize> {
        let (nodes, _) = self.bodies().get(body)?;
        let edges = self.rod_edges().iter();
        let mut own = edges.filter(|edge| nodes.contains(&edge.nodes[0]));
        own.next().map(|edge| edge.rod)
    }

    /// Index among the rods of that to which an edge or a face belongs.
    pub(crate) fn body_of(&self, index: usize) -> usize {
        match self.edges().get(index) {
            Some(edge) => edge.rod,
            None => self.faces()[index - self.edges().len()].rod,
        }
    }

    /// Whether a node may touch a face of a free body: it belongs to another body, and is not near a
    /// joint with that one.
    fn may_meet(&self, node: &ContactNode, face: &ContactFace) -> bool {
        if self.edges()[node.edge].rod == face.rod {
            return false;
        }
        let (mut point, mut body) = (self.edges()[node.edge], self.edges()[node.edge]);
        let end = usize::from(point.nodes[0] != node.node);
        point.arc_length = [point.arc_length[end]; 2];
        (body.rod, body.arc_length) = (face.rod, [0.0; 2]);
        !self.are_joined(&point, &body)
    }

    /// Adds all pairs of a node and a face of another, free body that are nearer than `clearance`
    /// (m) beyond their radii, together with their distance. The node may be behind the face: within
    /// a step it may come in front of it, or pass through the body in iterations.
    pub(super) fn find_at_bodies(
        &self,
        positions: &[Vector3],
        clearance: f64,
        found: &mut Vec<(CandidatePair, f64)>,
    ) {
        let sides = [positions; 2];
        for pair in self.pairs_at_bodies(sides, clearance) {
            let distance = distance_from_triangle(&pair.nodes.map(|node| positions[node]));
            if distance < self.threshold(pair.edges) + clearance {
                found.push((pair, distance));
            }
        }
    }

    /// Whether the second body of a pair is a face of a solid: of a free body, or of an obstacle that
    /// is closed.
    pub(super) fn is_with_solid(&self, pair: &CandidatePair) -> bool {
        let face = pair.edges[1].checked_sub(self.edges().len());
        face.is_some_and(|face| {
            let obstacle = self.faces()[face].obstacle;
            obstacle.is_none_or(|obstacle| self.obstacles()[obstacle].closed)
        })
    }

    /// Adds all pairs of a node and a face of another, free body whose paths from `start` to `end`
    /// come near each other.
    pub(super) fn find_swept_at_bodies(
        &self,
        start: &[Vector3],
        end: &[Vector3],
        found: &mut Vec<CandidatePair>,
    ) {
        found.extend(self.pairs_at_bodies([start, end], 0.0));
    }

    /// Pairs of a node and a face with boxes around both positions that overlap, if they are
    /// enlarged by the radii and a clearance, m.
    fn pairs_at_bodies<'a>(
        &'a self,
        [start, end]: [&'a [Vector3]; 2],
        clearance: f64,
    ) -> impl Iterator<Item = CandidatePair> + 'a {
        let around = move |nodes: &[usize], radius: f64| {
            let both = [start, end].into_iter();
            let points = both.flat_map(|of| nodes.iter().map(move |&node| of[node]));
            AlignedBox::around(points, radius)
        };
        let edges = self.edges().len();
        let faces = self.body_faces().iter().enumerate();
        faces.flat_map(move |(index, face)| {
            let near = around(&face.vertices, face.radius + clearance);
            let nodes = self.nodes().iter();
            let others = nodes.filter(move |one| self.may_meet(one, face));
            let touching = others.filter(move |one| near.meets(&around(&[one.node], one.radius)));
            touching.map(move |one| CandidatePair {
                edges: [one.edge, edges + index],
                nodes: ContactFace::with(face, one.node),
                side: 1,
                start: 0,
            })
        })
    }

    /// Vertices of free bodies and nodes of rods within other free bodies: the pair with the
    /// nearest face, and the depth, m.
    pub(super) fn within_bodies(&self, positions: &[Vector3]) -> Vec<(CandidatePair, f64)> {
        let mut deepest = Vec::new();
        let faces = self.body_faces();
        let mut first = 0;
        while first < faces.len() {
            let count = faces[first..]
                .iter()
                .take_while(|face| face.rod == faces[first].rod)
                .count();
            let own = first..first + count;
            let others = self.nodes().iter();
            for one in others.filter(|one| self.may_meet(one, &faces[first])) {
                let depths = own.clone().map(|index| {
                    let nodes = ContactFace::with(&faces[index], one.node);
                    let foot = Foot::in_plane(&nodes.map(|node| positions[node]), 1.0);
                    (index, nodes, foot.map_or(0.0, |foot| -foot.distance))
                });
                let nearest = depths.min_by(|a, b| a.2.total_cmp(&b.2));
                if let Some((index, nodes, depth)) = nearest.filter(|(_, _, depth)| *depth > 0.0) {
                    let pair = CandidatePair {
                        edges: [one.edge, self.edges().len() + index],
                        nodes,
                        side: 1,
                        start: 0,
                    };
                    deepest.push((pair, depth));
                }
            }
            first += count;
        }
        deepest
    }
}

/// Distance of the first point from the triangle of the others, m.
pub(super) fn distance_from_triangle(corners: &[Vector3; 4]) -> f64 {
    separation_from_triangle(corners).norm()
}

/// Vector to the first point from the nearest point of the triangle of the others, m.
fn separation_from_triangle(corners: &[Vector3; 4]) -> Vector3 {
    if let Some(foot) = Foot::of(corners, 1.0) {
        return foot.normal * foot.distance;
    }
    let [point, a, b, c] = corners;
    let from_side = |from: &Vector3, to: &Vector3| {
        let side = to - from;
        let along = (point - from).dot(&side) / side.norm_squared();
        point - from - side * along.clamp(0.0, 1.0)
    };
    let sides = [from_side(a, b), from_side(b, c), from_side(c, a)];
    let nearest = (sides.into_iter()).min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    nearest.unwrap_or_else(Vector3::zeros)
}

/// The largest fraction of the path `displacements` of a node and the corners of a triangle, at
/// most `longest`, along which they stay farther apart than `threshold` (m) plus a tenth of their
/// present gap beyond it. See [`super::continuous_collision`].
pub(super) fn safe_fraction_at_triangle(
    corners: &[Vector3; 4],
    displacements: &[Vector3; 4],
    threshold: f64,
    longest: f64,
) -> f64 {
    safe_fraction_from(
        separation_from_triangle(corners),
        [corners, displacements],
        &[(0, 1), (0, 2), (0, 3)],
        separation_from_triangle,
        [threshold, longest],
    )
}

impl Foot {
    /// Motion of the contact with a node and the corners of a face, all of which move; normal and
    /// contact point are fixed unless it `turns`.
    pub(super) fn motion_with(&self, [_, a, b, c]: &[Vector3; 4], turns: bool) -> ContactMotion {
        let (weights, normal) = (self.all_weights(), self.normal);
        let mut motion = ContactMotion {
            weights,
            gap_gradient: std::array::from_fn(|k| weights[k / 3] * normal[k % 3]),
            ..ContactMotion::over_plane(&normal)
        };
        if !turns {
            return motion;
        }
        let [ab, ac] = [b - a, c - a];
        let area = ab.cross(&ac);
        let square = area.norm_squared();
        let (along_b, along_c) = (ac.cross(&area) / square, area.cross(&ab) / square);
        let slopes = [Vector3::zeros(), -along_b - along_c, along_b, along_c];
        for column in 0..12 {
            let (node, axis) = (column / 3, column % 3);
            let turn = -slopes[node] * normal[axis];
            for row in 0..3 {
                motion.normal_jacobian[row][column] = turn[row];
            }
            for corner in 1..4 {
                let moved = weights[node] * slopes[corner][axis];
                // The weights of corners in the separation are negative.
                motion.weight_rates[corner][column] =
                    self.distance * slopes[corner].dot(&turn) - moved;
            }
        }
        motion
    }
}

/// Derivative of the force N w ⊗ n of a contact without friction with respect to the coordinates of
/// its four nodes, N/m. Friction at free bodies has the derivatives of [`super::body_turns`].
pub(super) fn motion_jacobian(
    motion: &ContactMotion,
    response: &NormalResponse,
) -> Linearised<EdgeJacobian> {
    let mut jacobian = [[0.0; 12]; 12];
    for (row, entries) in jacobian.iter_mut().enumerate() {
        let (node, axis) = (row / 3, row % 3);
        let weight = motion.weights[node];
        for (column, entry) in entries.iter_mut().enumerate() {
            let nodal = weight * response.force_slope * motion.gap_gradient[column]
                + response.force * motion.weight_rates[node][column];
            *entry = nodal * motion.normal[axis]
                + response.force * weight * motion.normal_jacobian[axis][column];
        }
    }
    Linearised {
        jacobian,
        gap_gradient: motion.gap_gradient,
        traction_gradient: [[0.0; 12]; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::super::contact_system::ContactSystem;
    use super::super::parameters::ContactParameters;
    use super::super::test_support::Random;
    use super::*;
    use crate::mechanics::UnitQuaternion;
    use crate::mechanics::rigid_body::RigidBody;

    /// A node and a triangle of the size of one.
    fn corners(random: &mut Random) -> [Vector3; 4] {
        std::array::from_fn(|_| random.vector())
    }

    #[test]
    fn nothing_comes_nearer_on_the_free_part_of_a_path() {
        let mut random = Random::new(5);
        let (mut stopped, mut free) = (0, 0);
        for _ in 0..400 {
            let start = corners(&mut random);
            let moves = corners(&mut random).map(|x| x * 2.0);
            let distance = distance_from_triangle(&start);
            let threshold = 0.5 * distance;
            let found = safe_fraction_at_triangle(&start, &moves, threshold, 1.0);
            for sample in 0..=200 {
                let part = found * f64::from(sample) / 200.0;
                let there = std::array::from_fn(|k| start[k] + moves[k] * part);
                let least = threshold + 0.099 * (distance - threshold);
                assert!(distance_from_triangle(&there) > least, "{part} of {found}");
            }
            let end = std::array::from_fn(|k| start[k] + moves[k] * (found + 1e-3));
            if found < 1.0 {
                assert!(distance_from_triangle(&end) < distance);
                stopped += 1;
            } else {
                free += 1;
            }
        }
        assert!(stopped > 50 && free > 50, "{stopped} {free}");
    }

    #[test]
    fn a_solid_repels_a_node_that_was_behind_its_face_when_candidates_were_built() {
        let radius = 0.05;
        let upright = UnitQuaternion::identity();
        let body = RigidBody::cuboid(Vector3::zeros(), Vector3::repeat(1.0), &upright, radius);
        let tip = |height: f64| Vector3::new(0.1, 0.15, height);
        let rod = |height: f64| vec![tip(height), tip(height + 2.0)];
        for is_free in [true, false] {
            let mut surface = ContactSurface::new();
            surface.add_rod(0, &rod(1.0), false, radius, false);
            if is_free {
                surface.add_body(2, &body, None);
            } else {
                surface.add_obstacle(body.clone(), None);
            }
            let parameters = ContactParameters {
                distance_tolerance: 0.01,
                friction: 0.0,
                ..ContactParameters::default()
            };
            let mut contact = ContactSystem::new(parameters, surface, Vec::new(), 1.0);
            let at = |height: f64| {
                let vertices = body.vertices.iter().filter(|_| is_free);
                rod(height).iter().chain(vertices).copied().collect()
            };
            // The face is at 0.45; the surfaces touch at 0.55.
            let [touching, above, within]: [Vec<Vector3>; 3] = [0.549, 0.8, 0.4].map(at);
            contact.update_candidates(&within);
            let pushed = |contact: &mut ContactSystem, now: &[Vector3], start: &[Vector3]| {
                contact.begin_at(start);
                contact.evaluate_forces(now, start, 1e-3);
                let forces = contact.contacts().iter().filter(|one| one.nodes[0] == 0);
                forces.map(|one| one.force[2]).sum::<f64>()
            };
            let light = pushed(&mut contact, &touching, &above);
            assert!(light > 0.0);
            // A node that comes through the face is pushed back, one that was always behind it is
            // not.
            assert!(pushed(&mut contact, &within, &above) > 10.0 * light);
            assert_eq!(pushed(&mut contact, &within, &within), 0.0);
        }
    }

    #[test]
    fn the_motion_over_a_face_is_that_of_differences() {
        let mut random = Random::new(8);
        let mut compared = 0;
        while compared < 50 {
            let at = corners(&mut random);
            let Some(foot) = Foot::of(&at, 1.0) else {
                continue;
            };
            compared += 1;
            let motion = foot.motion_with(&at, true);
            for column in 0..12 {
                let step = 1e-6;
                let moved = |by: f64| {
                    let mut moved = at;
                    moved[column / 3][column % 3] += by;
                    Foot::in_plane(&moved, 1.0).unwrap()
                };
                let [ahead, behind] = [step, -step].map(moved);
                let rate = |ahead: f64, behind: f64| (ahead - behind) / (2.0 * step);
                let near = |found: f64, expected: f64| {
                    assert!(
                        (found - expected).abs() < 1e-6 * (1.0 + expected.abs()) / foot.scale(&at)
                    );
                };
                near(
                    motion.gap_gradient[column],
                    rate(ahead.distance, behind.distance),
                );
                for axis in 0..3 {
                    let expected = rate(ahead.normal[axis], behind.normal[axis]);
                    near(motion.normal_jacobian[axis][column], expected);
                }
                for corner in 0..4 {
                    let [ahead, behind] = [ahead.all_weights(), behind.all_weights()];
                    let expected = rate(ahead[corner], behind[corner]);
                    near(motion.weight_rates[corner][column], expected);
                }
            }
        }
    }

    impl Foot {
        /// Squared sine of the narrowest angle of the triangle, by which differences are worse.
        fn scale(&self, [_, a, b, c]: &[Vector3; 4]) -> f64 {
            let area = (b - a).cross(&(c - a)).norm();
            let sides = [b - a, c - b, a - c].map(|side| side.norm_squared());
            (area / sides.into_iter().fold(0.0, f64::max)).powi(4)
        }
    }
}
