//! Points inside a closed obstacle.

use super::foot::{Foot, Points};
use super::surface::ContactSurface;
use crate::mechanics::Vector3;

impl ContactSurface {
    /// The face of an obstacle with the plane nearest to a point inside, as a body, and the
    /// distance of that plane, m.
    pub(super) fn nearest_face(
        &self,
        obstacle: usize,
        point: &Vector3,
        points: &Points,
    ) -> Option<(usize, f64)> {
        let faces = self.faces().iter().enumerate();
        let distances = faces.filter_map(|(index, face)| {
            let [a, b, c] = points.of(face.vertices);
            let foot = Foot::of(&[*point, a, b, c], 1.0)?;
            (face.obstacle == Some(obstacle))
                .then_some((self.edges().len() + index, foot.distance.abs()))
        });
        distances.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Whether a point is within a closed obstacle, from the solid angle that its faces subtend at
    /// the point (van Oosterom and Strackee 1983): 4π inside, 0 outside.
    pub(super) fn is_inside(&self, obstacle: usize, point: &Vector3, points: &Points) -> bool {
        let faces = self
            .faces()
            .iter()
            .filter(|face| face.obstacle == Some(obstacle));
        let seen: f64 = faces
            .map(|face| {
                let [a, b, c] = points.of(face.vertices).map(|vertex| vertex - point);
                let (x, y, z) = (a.norm(), b.norm(), c.norm());
                let volume = a.dot(&b.cross(&c));
                let sum = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
                2.0 * libm::atan2(volume, sum)
            })
            .sum();
        seen.abs() > 2.0 * std::f64::consts::PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::rigid_body::RigidBody;

    #[test]
    fn points_inside_see_the_whole_sphere_of_directions() {
        let mut surface = ContactSurface::new();
        let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let tetrahedron = RigidBody {
            vertices: vertices.clone(),
            faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            closed: true,
            ..RigidBody::default()
        };
        surface.add_obstacle(tetrahedron, None);
        let points = Points {
            nodes: &[],
            vertices: &vertices,
            normals: &[],
        };
        assert!(surface.is_inside(0, &Vector3::new(0.2, 0.2, 0.2), &points));
        assert!(!surface.is_inside(0, &Vector3::new(0.4, 0.4, 0.4), &points));
        assert!(!surface.is_inside(0, &Vector3::new(-1e-3, 0.2, 0.2), &points));
    }
}
