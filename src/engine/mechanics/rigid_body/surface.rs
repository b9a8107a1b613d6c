//! The surface of a rigid body as triangles, for pictures.

use super::RigidBody;
use crate::mechanics::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Strips around a cylinder, and from the equator of a sphere to its pole.
const AROUND: usize = 48;
const TO_POLE: usize = 12;
/// Difference of cosines below which two normals count as one.
const SAME: f64 = 1e-9;

/// The centre of points and the distance of the farthest one from it, m: the range in which
/// endless surfaces are shown.
pub fn neighbourhood<'a>(points: impl Iterator<Item = &'a Vector3> + Clone) -> (Vector3, f64) {
    let count = points.clone().count().max(1) as f64;
    let centre = points.clone().sum::<Vector3>() / count;
    let reach = points.fold(0.0, |most, x| f64::max(most, (x - centre).norm()));
    (centre, reach)
}

impl RigidBody {
    /// The triangles of its surface, as three corners each (m). An endless cylinder is shown only
    /// within `reach` (m) of a point.
    pub fn surface(&self, point: &Vector3, reach: f64) -> Vec<[Vector3; 3]> {
        let mut triangles = Vec::new();
        for face in &self.faces {
            let corners = face.map(|vertex| self.vertices[vertex]);
            let [a, b, c] = corners;
            let outwards = (b - a).cross(&(c - a)).normalize() * self.radius;
            triangles.push(corners.map(|corner| corner + outwards));
        }
        if self.radius > 0.0 {
            for segment in &self.segments {
                let ends = segment.map(|vertex| self.vertices[vertex]);
                self.add_capsule(clipped(ends, point, reach), &mut triangles);
            }
        }
        triangles
    }

    /// The triangles of the faces moved outwards by the radius, with sharp edges instead of round
    /// ones: each vertex moves to where the faces around it meet.
    pub fn sharp_surface(&self) -> Vec<[Vector3; 3]> {
        let mut around = vec![Matrix3::zeros(); self.vertices.len()];
        let mut normals: Vec<Vec<Vector3>> = vec![Vec::new(); self.vertices.len()];
        for face in &self.faces {
            let [a, b, c] = face.map(|vertex| self.vertices[vertex]);
            let normal = (b - a).cross(&(c - a)).normalize();
            for &vertex in face {
                // Triangles of one flat side count once.
                if normals[vertex]
                    .iter()
                    .all(|own| own.dot(&normal) < 1.0 - SAME)
                {
                    normals[vertex].push(normal);
                    around[vertex] += normal * normal.transpose();
                }
            }
        }
        let moved = around.iter().zip(&normals).zip(&self.vertices);
        let moved: Vec<Vector3> = moved
            .map(|((around, normals), vertex)| {
                let sum: Vector3 = normals.iter().sum();
                let inverse = around.pseudo_inverse(SAME).unwrap_or_default();
                vertex + inverse * sum * self.radius
            })
            .collect();
        let corners = self
            .faces
            .iter()
            .map(|face| face.map(|vertex| moved[vertex]));
        corners.collect()
    }

    /// Adds the surface around a segment: a tube without ends, or a capsule with round ones.
    fn add_capsule(&self, [start, end]: [Vector3; 2], triangles: &mut Vec<[Vector3; 3]>) {
        let axis = (end - start).try_normalize(0.0).unwrap_or_else(Vector3::z);
        let first = if axis.x.abs() < 0.9 {
            Vector3::x()
        } else {
            Vector3::y()
        };
        let across = axis.cross(&first).normalize();
        let other = axis.cross(&across);
        let ring = |centre: Vector3, radius: f64| -> Vec<Vector3> {
            let corner = |k: usize| {
                let (sine, cosine) = libm::sincos(TAU * k as f64 / AROUND as f64);
                centre + (across * cosine + other * sine) * radius
            };
            (0..AROUND).map(corner).collect()
        };
        let latitude = |k: usize| libm::sincos(FRAC_PI_2 * k as f64 / TO_POLE as f64);
        let mut rings = Vec::new();
        let round = if self.hollow { 0 } else { TO_POLE };
        for k in (0..=round).rev() {
            let (sine, cosine) = latitude(k);
            rings.push(ring(
                start - axis * (self.radius * sine),
                self.radius * cosine,
            ));
        }
        for k in 0..=round {
            let (sine, cosine) = latitude(k);
            rings.push(ring(
                end + axis * (self.radius * sine),
                self.radius * cosine,
            ));
        }
        for pair in rings.windows(2) {
            for k in 0..AROUND {
                let next = (k + 1) % AROUND;
                let [a, b, c, d] = [pair[0][k], pair[0][next], pair[1][next], pair[1][k]];
                for triangle in [[a, b, c], [a, c, d]] {
                    let [a, b, c] = triangle;
                    // Triangles at the poles have no area.
                    if (b - a).cross(&(c - a)).norm() > 1e-9 * self.radius * self.radius {
                        triangles.push(triangle);
                    }
                }
            }
        }
    }
}

/// The part of a segment within a distance of a point, or the whole segment if that is shorter.
fn clipped([start, end]: [Vector3; 2], point: &Vector3, reach: f64) -> [Vector3; 2] {
    let along = end - start;
    let length = along.norm();
    if length <= 2.0 * reach {
        return [start, end];
    }
    let axis = along / length;
    let foot = (point - start).dot(&axis);
    [foot - reach, foot + reach].map(|place| start + axis * place.clamp(0.0, length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::UnitQuaternion;
    use crate::mechanics::test_support::assert_close;

    fn area(triangles: &[[Vector3; 3]]) -> f64 {
        let of_one = |[a, b, c]: &[Vector3; 3]| 0.5 * (b - a).cross(&(c - a)).norm();
        triangles.iter().map(of_one).sum()
    }

    #[test]
    fn surfaces_have_their_areas() {
        let near = |found: f64, expected: f64| {
            assert_close(found, expected, 1e-2);
        };
        let sphere = RigidBody::sphere(Vector3::x(), 0.5);
        near(area(&sphere.surface(&Vector3::zeros(), 9.0)), TAU * 0.5);
        let ends = [Vector3::zeros(), Vector3::z() * 2.0];
        let tube = RigidBody::tube(ends, 0.5);
        near(area(&tube.surface(&Vector3::zeros(), 9.0)), TAU);
        let sides = Vector3::new(1.0, 2.0, 3.0);
        let sharp = RigidBody::cuboid(Vector3::zeros(), sides, &UnitQuaternion::identity(), 0.0);
        near(area(&sharp.surface(&Vector3::zeros(), 9.0)), 22.0);
        let endless = RigidBody::cylinder(Vector3::zeros(), Vector3::y(), 0.5, 1e3);
        let shown = endless.surface(&Vector3::new(0.0, 7.0, 0.0), 3.0);
        assert!(
            shown
                .iter()
                .flatten()
                .all(|corner| (3.4..10.6).contains(&corner.y))
        );
    }

    #[test]
    fn a_rounded_box_is_drawn_with_its_outer_sides() {
        let sides = Vector3::new(0.3, 0.2, 0.1);
        let body = RigidBody::cuboid(Vector3::x(), sides, &UnitQuaternion::identity(), 0.02);
        let triangles = body.sharp_surface();
        assert_eq!(triangles.len(), 12);
        for corner in triangles.iter().flatten() {
            let from_centre = (corner - Vector3::x()).abs();
            assert!((from_centre - sides * 0.5).norm() < 1e-15, "{corner}");
        }
    }
}
