//! The surface of a rigid body as triangles, for pictures.

use super::RigidBody;
use crate::mechanics::Vector3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Strips around a cylinder, and from the equator of a sphere to its pole.
const AROUND: usize = 48;
const TO_POLE: usize = 12;

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
}
