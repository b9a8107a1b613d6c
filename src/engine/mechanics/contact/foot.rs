//! The foot of a node of a rod on a face of an obstacle.

use crate::mechanics::Vector3;

/// Positions of the nodes of rods and of the vertices of obstacles, which are numbered after the
/// nodes, and normals of smooth meshes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<'a> {
    pub nodes: &'a [Vector3],
    pub vertices: &'a [Vector3],
    pub normals: &'a [Vector3],
}

impl Points<'_> {
    /// Position of a node or vertex, m.
    pub(crate) fn at(&self, node: usize) -> Vector3 {
        match self.nodes.get(node) {
            Some(position) => *position,
            None => self.vertices[node - self.nodes.len()],
        }
    }

    /// Positions of several nodes or vertices, m.
    pub(crate) fn of<const N: usize>(&self, nodes: [usize; N]) -> [Vector3; N] {
        nodes.map(|node| self.at(node))
    }
}

/// Foot of a node on a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    /// Unit normal of the face, on the side given.
    pub normal: Vector3,
    /// Distance from the plane of the face, positive on that side, m.
    pub distance: f64,
    /// Weights of the three vertices at the foot of the perpendicular.
    pub weights: [f64; 3],
}

impl Foot {
    /// The foot of a node (first point) on the triangle of the last three points, whose normal
    /// points to the given `side`, 1 or −1; `None` if the foot is outside the triangle.
    pub(crate) fn of(points: &[Vector3; 4], side: f64) -> Option<Self> {
        let foot = Self::in_plane(points, side)?;
        foot.weights
            .iter()
            .all(|weight| *weight >= 0.0)
            .then_some(foot)
    }

    /// Like `of`, but the foot may be outside the triangle in its plane; `None` for a triangle
    /// without area.
    pub(crate) fn in_plane([node, a, b, c]: &[Vector3; 4], side: f64) -> Option<Self> {
        let [ab, ac, an] = [b - a, c - a, node - a];
        let area = ab.cross(&ac);
        let square = area.norm_squared();
        if square <= 0.0 {
            return None;
        }
        let along_b = an.cross(&ac).dot(&area) / square;
        let along_c = ab.cross(&an).dot(&area) / square;
        let normal = area * (side / square.sqrt());
        Some(Self {
            normal,
            distance: an.dot(&normal),
            weights: [1.0 - along_b - along_c, along_b, along_c],
        })
    }

    /// Weights of the node and the vertices in the separation of the node from its foot.
    pub(crate) fn all_weights(&self) -> [f64; 4] {
        let [a, b, c] = self.weights;
        [1.0, -a, -b, -c]
    }
}

/// Fraction of the straight path from `start` to `end` of a node and the corners of a triangle at
/// which the node passes through the triangle, and the weights of the corners there; `None` if it
/// does not. A node that passes beside the triangle counts if no weight is below `least`.
pub(super) fn crossing(
    start: &[Vector3; 4],
    end: &[Vector3; 4],
    least: f64,
) -> Option<(f64, [f64; 3])> {
    let (before, after) = (Foot::in_plane(start, 1.0)?, Foot::in_plane(end, 1.0)?);
    if before.distance * after.distance > 0.0 || before.distance == after.distance {
        return None;
    }
    let part = before.distance / (before.distance - after.distance);
    let there = std::array::from_fn(|k| start[k] + (end[k] - start[k]) * part);
    let foot = Foot::in_plane(&there, 1.0)?;
    let is_within = foot.weights.iter().all(|weight| *weight >= least);
    is_within.then_some((part, foot.weights))
}

#[cfg(test)]
mod tests {
    use super::super::test_support::Random;
    use super::*;

    const TRIANGLE: [Vector3; 3] = [
        Vector3::new(0.0, 0.0, 1.0),
        Vector3::new(2.0, 0.0, 1.0),
        Vector3::new(0.0, 3.0, 1.0),
    ];

    fn over(x: f64, y: f64, z: f64) -> [Vector3; 4] {
        let [a, b, c] = TRIANGLE;
        [Vector3::new(x, y, z), a, b, c]
    }

    #[test]
    fn the_foot_lies_below_the_node_and_only_within_the_triangle() {
        let foot = Foot::of(&over(0.4, 0.6, 1.7), 1.0).unwrap();
        assert!((foot.distance - 0.7).abs() < 1e-15);
        assert!((foot.normal - Vector3::z()).norm() < 1e-15);
        let expected = [1.0 - 0.2 - 0.2, 0.2, 0.2];
        for (found, expected) in foot.weights.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15);
        }
        let below = Foot::of(&over(0.4, 0.6, 0.5), -1.0).unwrap();
        assert!((below.distance - 0.5).abs() < 1e-15 && below.normal.z == -1.0);
        assert_eq!(Foot::of(&over(1.5, 1.5, 1.7), 1.0), None);
    }

    #[test]
    fn a_node_passes_through_a_triangle_that_moves() {
        let mut random = Random::new(3);
        let (mut passed, mut free) = (0, 0);
        for _ in 0..300 {
            let start = over(2.0 * random.symmetric(), 2.0 * random.symmetric(), 2.0);
            let shift = random.vector();
            let mut end = start.map(|x| x + shift);
            end[0] = start[0] + shift + Vector3::new(0.0, 0.0, -2.0);
            let inside = Foot::of(&start, 1.0).is_some();
            let found = crossing(&start, &end, 0.0);
            assert_eq!(found.is_some(), inside);
            if let Some((part, _)) = found {
                assert!((part - 0.5).abs() < 1e-12);
                passed += 1;
            } else {
                free += 1;
            }
        }
        assert!(passed > 20 && free > 20, "{passed} {free}");
    }
}
