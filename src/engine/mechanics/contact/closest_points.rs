//! Closest points of two segments, and the features (ends or interiors) that contain them.
//!
//! Minimises the convex quadratic
//!
//! ½‖x_i + β_i e_i − x_j − β_j e_j‖² + ½ c [(β_i − ½)² + (β_j − ½)²]
//!
//! over the unit square of contact ratios. With c = 0 these are the closest points (thesis Eq.
//! 2.3; Lumelsky 1985; Ericson 2005, section 5.1.9). The minimum over the lines is computed from a
//! triple product with e_i × e_j. This stays accurate for nearly parallel edges, where the usual
//! difference of dot products cancels.
//!
//! When two edges become parallel as they turn, their closest points jump between the ends of the
//! stretch along which the edges face each other. The torque of the contact force jumps with them.
//! Parallel rods in contact come to rest in between, where Newton's method finds no force that
//! balances them. With a smoothing c the points pass through the middle of that stretch within an
//! angle of about c/(2 Δ ‖e‖). The distance is then the root of twice the minimum, so its gradient
//! at fixed ratios is still the full gradient; it exceeds the distance of the edges by at most c/(4
//! Δ).

use crate::mechanics::Vector3;

/// Edges with a smaller sine of the angle between them count as parallel.
///
/// On parallel edges all points that face each other are equally near. For a smaller sine the
/// closest points are unstable, and the curvature of the distance, which grows like the inverse
/// square of the sine, is useless to Newton's method. At 1e-6 and edges of a few radii, taking the
/// middle instead of the true minimum costs 1e-12 of the radius in distance; at 1e-4 the error
/// would already be noticeable.
const PARALLEL_SINE: f64 = 1e-6;

/// Contact ratios that are free to move along their edges, [first edge, second edge].
///
/// The number of free ratios is the class of the contact: none for point–point (Eq. 2.4), one for
/// point–edge (Eq. 2.5), two for edge–edge (Eq. 2.6).
pub(super) type FreeRatios = [bool; 2];

/// The closest points c_i = x_i + β_i e_i and c_j = x_j + β_j e_j of two edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClosestPoints {
    /// Contact ratios β_i and β_j in [0, 1].
    pub ratios: [f64; 2],
    /// The ratios that are not at an end of their edge.
    pub free: FreeRatios,
    /// c_i − c_j, m.
    pub separation: Vector3,
    /// Smoothing c used for these points, m².
    pub smoothing: f64,
    /// Whether the first body is confined to a distance of the second, as in a tube around its
    /// axis. The distance then counts as negative, the normal points inwards, and all derivatives
    /// follow from that.
    pub inside: bool,
}

impl ClosestPoints {
    /// Closest points of the edges (`nodes[0]`, `nodes[1]`) and (`nodes[2]`, `nodes[3]`).
    pub(crate) fn of(nodes: &[Vector3; 4]) -> Self {
        Self::smoothed(nodes, 0.0)
    }

    /// Closest points that pass smoothly through parallel edges, with a smoothing c (m²); 0 for the true ones.
    pub(crate) fn smoothed(nodes: &[Vector3; 4], smoothing: f64) -> Self {
        let edge_i = nodes[1] - nodes[0];
        let edge_j = nodes[3] - nodes[2];
        let (square_i, square_j) = (
            edge_i.norm_squared() + smoothing,
            edge_j.norm_squared() + smoothing,
        );
        let cross = edge_i.cross(&edge_j);
        let determinant = cross.norm_squared() + smoothing * (square_i + square_j - smoothing);
        // An edge without length is treated as a point at its first node, which is never parallel
        // to an edge.
        let is_point = square_i == smoothing || square_j == smoothing;
        if is_point || determinant <= PARALLEL_SINE * PARALLEL_SINE * square_i * square_j {
            return Self::of_parallel_edges(nodes);
        }
        let offset = 0.5 * ((nodes[2] - nodes[0]) + (nodes[3] - nodes[1]));
        let mixed = edge_i.dot(&edge_j);
        let (along_i, along_j) = (offset.dot(&edge_i), offset.dot(&edge_j));
        let (inverse_i, inverse_j) = (1.0 / square_i, 1.0 / square_j);

        // Minimum over the lines, clamped to the first edge; then the nearest point of the second
        // edge; then, in case this was clamped too, the nearest point of the first edge to it.
        // Without clamping the last two steps have no effect; computing them without branches is
        // faster. Ratios are measured from the middles.
        let over_lines = offset.cross(&edge_j).dot(&cross) + smoothing * along_i;
        let start = (over_lines / determinant).clamp(-0.5, 0.5);
        let ratio_j = ((start * mixed - along_j) * inverse_j).clamp(-0.5, 0.5);
        let ratio_i = ((ratio_j * mixed + along_i) * inverse_i).clamp(-0.5, 0.5);
        let ratios = [0.5 + ratio_i, 0.5 + ratio_j];
        Self {
            smoothing,
            ..Self::at(nodes, ratios, ratios.map(is_inside))
        }
    }

    /// Closest points of parallel edges: the middle of the stretch along which they face each other,
    /// held on the first edge and projected on the second; the nearest ends if there is no such stretch.
    fn of_parallel_edges(nodes: &[Vector3; 4]) -> Self {
        let edge_i = nodes[1] - nodes[0];
        let edge_j = nodes[3] - nodes[2];
        let (length_i, length_j) = (edge_i.norm_squared(), edge_j.norm_squared());
        if length_j == 0.0 {
            // A point is never parallel to an edge.
            let ratio_i = project(&nodes[2], &nodes[0], &edge_i, length_i).clamp(0.0, 1.0);
            return Self::at(nodes, [ratio_i, 0.0], [is_inside(ratio_i), false]);
        }
        let ends = [
            project(&nodes[2], &nodes[0], &edge_i, length_i),
            project(&nodes[3], &nodes[0], &edge_i, length_i),
        ];
        let overlap = [
            ends[0].min(ends[1]).clamp(0.0, 1.0),
            ends[0].max(ends[1]).clamp(0.0, 1.0),
        ];
        let ratio_i = 0.5 * (overlap[0] + overlap[1]);
        let point = nodes[0] + edge_i * ratio_i;
        let ratio_j = project(&point, &nodes[2], &edge_j, length_j).clamp(0.0, 1.0);
        Self::at(nodes, [ratio_i, ratio_j], [false, is_inside(ratio_j)])
    }

    fn at(nodes: &[Vector3; 4], ratios: [f64; 2], free: FreeRatios) -> Self {
        let point_i = nodes[0] + (nodes[1] - nodes[0]) * ratios[0];
        let point_j = nodes[2] + (nodes[3] - nodes[2]) * ratios[1];
        Self {
            ratios,
            free,
            separation: point_i - point_j,
            smoothing: 0.0,
            inside: false,
        }
    }

    /// Nearest point of the axis (`nodes[2]`, `nodes[3]`) of a tube to a point in the tube, which
    /// is given twice (`nodes[0]`, `nodes[1]`). `None` beyond the ends of the tube, and on the
    /// axis, where the direction to the wall is undefined.
    pub(crate) fn in_tube(nodes: &[Vector3; 4]) -> Option<Self> {
        let closest = Self::within_tube(nodes);
        closest.filter(|closest| closest.separation != Vector3::zeros())
    }

    /// Like `in_tube`, but also for points on the axis, where there is a distance but no normal.
    pub(crate) fn within_tube(nodes: &[Vector3; 4]) -> Option<Self> {
        let closest = Self::of_parallel_edges(nodes);
        closest.free[1].then_some(Self {
            inside: true,
            ..closest
        })
    }

    /// Weights of the four nodes in the separation: (1−β_i, β_i, −(1−β_j), −β_j).
    pub(crate) fn weights(&self) -> [f64; 4] {
        let [i, j] = self.ratios;
        [1.0 - i, i, j - 1.0, -j]
    }

    /// Centreline distance Δ, m.
    pub(crate) fn distance(&self) -> f64 {
        let [i, j] = self.ratios.map(|ratio| ratio - 0.5);
        let distance = (self.separation.norm_squared() + self.smoothing * (i * i + j * j)).sqrt();
        if self.inside { -distance } else { distance }
    }

    /// Normal from the second edge to the first, of length 1 without smoothing.
    pub(crate) fn normal(&self) -> Vector3 {
        self.separation / self.distance()
    }
}

/// Centreline distance Δ of two edges, m.
pub(crate) fn edge_distance(nodes: &[Vector3; 4]) -> f64 {
    ClosestPoints::of(nodes).distance()
}

/// Ratio along the line `start + ratio · edge` at which it is nearest to `point`; 0 for an edge without length.
fn project(point: &Vector3, start: &Vector3, edge: &Vector3, length_squared: f64) -> f64 {
    if length_squared > 0.0 {
        (point - start).dot(edge) / length_squared
    } else {
        0.0
    }
}

fn is_inside(ratio: f64) -> bool {
    0.0 < ratio && ratio < 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points() -> impl Strategy<Value = [Vector3; 4]> {
        let coordinate = -1.0..1.0f64;
        prop::array::uniform4(prop::array::uniform3(coordinate).prop_map(Vector3::from))
    }

    /// The smallest distance by its optimality conditions: the unconstrained minimum inside the
    /// square of ratios, or one of the four ends against the other edge.
    fn distance_by_enumeration(nodes: &[Vector3; 4]) -> f64 {
        let point_to_segment = |p: &Vector3, a: &Vector3, b: &Vector3| {
            let edge = b - a;
            let ratio = project(p, a, &edge, edge.norm_squared()).clamp(0.0, 1.0);
            (p - a - edge * ratio).norm()
        };
        let [a, b, c, d] = nodes;
        let mut smallest = point_to_segment(a, c, d)
            .min(point_to_segment(b, c, d))
            .min(point_to_segment(c, a, b))
            .min(point_to_segment(d, a, b));
        let (e, f) = (b - a, d - c);
        let normal_matrix = nalgebra::Matrix2::new(e.dot(&e), -e.dot(&f), -e.dot(&f), f.dot(&f));
        let right_side = nalgebra::Vector2::new((c - a).dot(&e), -(c - a).dot(&f));
        if let Some(ratios) = normal_matrix
            .try_inverse()
            .map(|inverse| inverse * right_side)
            && is_inside(ratios[0])
            && is_inside(ratios[1])
        {
            smallest = smallest.min((a + e * ratios[0] - c - f * ratios[1]).norm());
        }
        smallest
    }

    proptest! {
        #[test]
        fn the_distance_is_the_least_of_all_features(nodes in points()) {
            prop_assert!((edge_distance(&nodes) - distance_by_enumeration(&nodes)).abs() < 1e-12);
        }

        #[test]
        fn order_of_edges_and_nodes_does_not_matter(nodes in points()) {
            let [a, b, c, d] = nodes;
            let distance = edge_distance(&nodes);
            prop_assert!((distance - edge_distance(&[c, d, a, b])).abs() < 1e-13);
            prop_assert!((distance - edge_distance(&[b, a, c, d])).abs() < 1e-13);
        }

        #[test]
        fn parallel_edges_meet_in_the_middle_of_their_overlap(
            start in -2.0..2.0f64, length in 0.1..2.0f64, gap in 0.01..1.0f64, reversed in any::<bool>(),
        ) {
            let mut ends = [start, start + length];
            if reversed {
                ends.swap(0, 1);
            }
            let nodes = [
                Vector3::zeros(),
                Vector3::x(),
                Vector3::new(ends[0], gap, 0.0),
                Vector3::new(ends[1], gap, 0.0),
            ];
            let found = ClosestPoints::of(&nodes);
            prop_assert!((found.distance() - distance_by_enumeration(&nodes)).abs() < 1e-14);
            let overlap = [start.max(0.0), (start + length).min(1.0)];
            if overlap[0] < overlap[1] {
                prop_assert!((found.ratios[0] - 0.5 * (overlap[0] + overlap[1])).abs() < 1e-14);
                prop_assert!((found.separation - Vector3::new(0.0, -gap, 0.0)).norm() < 1e-14);
            } else {
                prop_assert_eq!(found.free, [false, false]);
            }
        }
    }

    #[test]
    fn a_point_has_a_nearest_point_that_moves_along_the_edge() {
        let point = Vector3::new(0.3, 0.5, 0.0);
        let found = ClosestPoints::of(&[Vector3::zeros(), Vector3::x(), point, point]);
        assert_eq!(found.free, [true, false]);
        assert!((found.distance() - 0.5).abs() < 1e-15 && (found.ratios[0] - 0.3).abs() < 1e-15);
    }

    #[test]
    fn within_a_tube_distances_count_from_the_wall_inwards() {
        let (start, end) = (Vector3::zeros(), Vector3::z() * 2.0);
        let at = |x: f64, z: f64| {
            let point = Vector3::new(x, 0.0, z);
            ClosestPoints::in_tube(&[point, point, start, end])
        };
        let found = at(0.2, 0.5).unwrap();
        assert!((found.distance() + 0.2).abs() < 1e-15);
        assert!(
            (found.normal() + Vector3::x()).norm() < 1e-15,
            "towards the axis"
        );
        assert_eq!(found.weights(), [1.0, 0.0, -0.75, -0.25]);
        assert_eq!(at(0.2, 2.5), None, "beyond its end");
        assert_eq!(at(0.0, 0.5), None, "on its axis");
        let on_axis = Vector3::z() * 0.5;
        let found = ClosestPoints::within_tube(&[on_axis, on_axis, start, end]).unwrap();
        assert_eq!(found.distance(), 0.0);
    }

    #[test]
    fn nearly_parallel_edges_keep_accurate_ratios() {
        // Two lines that cross at ratios 0.3 and 0.6 under an angle of 1e-5, one unit apart.
        let angle = 1e-5_f64;
        let direction = Vector3::new(angle.cos(), angle.sin(), 0.0);
        let crossing = Vector3::new(0.3, 0.0, 1.0);
        let nodes = [
            Vector3::zeros(),
            Vector3::x(),
            crossing - direction * 0.6,
            crossing + direction * 0.4,
        ];
        let found = ClosestPoints::of(&nodes);
        assert!((found.ratios[0] - 0.3).abs() < 1e-10, "{found:?}");
        assert!((found.ratios[1] - 0.6).abs() < 1e-10, "{found:?}");
        assert_eq!(found.free, [true, true]);
    }

    proptest! {
        #[test]
        fn no_other_ratios_have_a_smaller_smoothed_distance(
            nodes in points(), c in 0.0..1.0f64, others in prop::array::uniform2(0.0..=1.0f64),
        ) {
            let found = ClosestPoints::smoothed(&nodes, c);
            let other = ClosestPoints {
                smoothing: c,
                ..ClosestPoints::at(&nodes, others, [true; 2])
            };
            prop_assert!(found.distance() <= other.distance() + 1e-14);
        }
    }

    #[test]
    fn smoothed_points_pass_through_the_middle_of_the_overlap_as_edges_turn_through_parallel() {
        // The second edge, a quarter of its length ahead of the first, is turned about the middle of their overlap.
        let (gap, smoothing) = (0.5, 1e-3);
        let turned = |angle: f64| {
            let direction = Vector3::new(angle.cos(), 0.0, angle.sin());
            let middle = Vector3::new(0.625, 0.0, gap);
            let nodes = [
                Vector3::zeros(),
                Vector3::x(),
                middle - direction * 0.375,
                middle + direction * 0.625,
            ];
            ClosestPoints::smoothed(&nodes, smoothing)
        };
        assert!((turned(0.0).ratios[0] - 0.625).abs() < smoothing);
        let mut before = turned(-5e-3);
        assert!(before.ratios[0] > 0.99 && turned(5e-3).ratios[0] < 0.26);
        for k in -499..=500 {
            let now = turned(1e-5 * f64::from(k));
            let moved = before.ratios[0] - now.ratios[0];
            assert!((-1e-6..0.01).contains(&moved), "{k}: {moved}");
            let apart = now.separation.norm();
            assert!(now.distance() - apart <= smoothing / (4.0 * apart));
            before = now;
        }
    }

    #[test]
    fn edges_without_length_are_points() {
        let point = Vector3::new(0.25, 2.0, 0.0);
        let nodes = [Vector3::zeros(), Vector3::x(), point, point];
        assert_eq!(edge_distance(&nodes), 2.0);
        assert_eq!(edge_distance(&[point; 4]), 0.0);
        // The other edge has a unique nearest point, smoothed or not.
        for smoothing in [0.0, 1e-3] {
            let found = ClosestPoints::smoothed(&[point, point, nodes[0], nodes[1]], smoothing);
            assert_eq!(found.weights(), [1.0, 0.0, -0.75, -0.25]);
            assert_eq!((found.free, found.distance()), ([false, true], 2.0));
            let found = ClosestPoints::smoothed(&[nodes[0], nodes[1], point, point], smoothing);
            assert_eq!(found.weights(), [0.75, 0.25, -1.0, 0.0]);
            assert_eq!((found.free, found.distance()), ([true, false], 2.0));
        }
    }
}
