//! Uniform solids: their shapes, and their mass properties.
//!
//! Volume, centre and second moments of a solid with flat faces are sums over the tetrahedra
//! between its faces and the origin: for the corners a, b, c, the volume is V = a·(b × c)/6, the
//! first moment V (a + b + c)/4, and the second moment ∫ x xᵀ = V/20 (a aᵀ + b bᵀ + c cᵀ + s sᵀ)
//! with s = a + b + c.

use nalgebra::SymmetricEigen;
use rodlab_engine::mechanics::rigid_body::RigidBody;
use rodlab_engine::mechanics::{Matrix3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// Part of the size of a body by which a vertex may be in front of a face of a convex mesh.
const FLAT: f64 = 1e-6;

/// A uniform solid about its centre.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Shape of its surface.
    pub body: RigidBody,
    /// Volume, m³.
    pub volume: f64,
    /// Centre of mass, m.
    pub centre: Vector3,
    /// Principal moments of inertia for a unit mass, m².
    pub inertia: [f64; 3],
    /// Rotates x, y and z to the principal axes.
    pub axes: UnitQuaternion,
}

impl Solid {
    /// All points within a radius (m) of a segment of a length (m) along z; a sphere if that is 0.
    pub fn capsule(radius: f64, length: f64) -> Self {
        let end = Vector3::z() * (0.5 * length);
        let body = match length {
            0.0 => RigidBody::sphere(end, radius),
            _ => RigidBody::capsule([-end, end], radius),
        };
        let square = radius * radius;
        let [ends, middle] = [4.0 / 3.0 * radius, length].map(|factor| 0.5 * TAU * square * factor);
        let volume = ends + middle;
        // Hemispheres have their centres of mass ⅜ of the radius beyond the ends of the segment.
        let of_ends = 0.4 * square + length * (0.25 * length + 0.375 * radius);
        let of_middle = 0.25 * square + length * length / 12.0;
        let across = (ends * of_ends + middle * of_middle) / volume;
        let along = (0.4 * ends + 0.5 * middle) * square / volume;
        Self {
            body,
            volume,
            centre: Vector3::zeros(),
            inertia: [across, across, along],
            axes: UnitQuaternion::identity(),
        }
    }

    /// A box with the given sides, m, and edges rounded to a radius, m. The rounding does not
    /// change its mass properties.
    pub fn cuboid(size: [f64; 3], rounding: f64) -> Self {
        let squares: f64 = size.iter().map(|side| side * side).sum();
        let upright = UnitQuaternion::identity();
        Self {
            body: RigidBody::cuboid(Vector3::zeros(), Vector3::from(size), &upright, rounding),
            volume: size.iter().product(),
            centre: Vector3::zeros(),
            inertia: size.map(|side| (squares - side * side) / 12.0),
            axes: upright,
        }
    }

    /// A cylinder along z with edges rounded to a radius, m, represented by a prism. Its mass
    /// properties are those of the cylinder.
    pub fn prism(radius: f64, length: f64, rounding: f64, sides: usize) -> Self {
        let (around, half) = (radius - rounding, 0.5 * length - rounding);
        let corner = |k: usize| {
            let (sine, cosine) = libm::sincos(TAU * (k % sides) as f64 / sides as f64);
            let height = if k < sides { -half } else { half };
            Vector3::new(around * cosine, around * sine, height)
        };
        let vertices = (0..2 * sides).map(corner).collect();
        let side = |k: usize| {
            let next = (k + 1) % sides;
            let (top, next_top) = (k + sides, next + sides);
            [[k, next, next_top], [k, next_top, top]]
        };
        let mut faces: Vec<[usize; 3]> = (0..sides).flat_map(side).collect();
        faces.extend((1..sides - 1).map(|k| [0, k + 1, k]));
        faces.extend((1..sides - 1).map(|k| [sides, sides + k, sides + k + 1]));
        let body = RigidBody::of_mesh(vertices, faces, true).unwrap_or_default();
        let across = 0.25 * radius * radius + length * length / 12.0;
        Self {
            body: RigidBody {
                radius: rounding,
                ..body
            },
            volume: 0.5 * TAU * radius * radius * length,
            centre: Vector3::zeros(),
            inertia: [across, across, 0.5 * radius * radius],
            axes: UnitQuaternion::identity(),
        }
    }

    /// A convex mesh, with the surface at a distance (m) from its triangles. Its mass properties
    /// are those of the mesh.
    ///
    /// # Errors
    /// Why it is not the mesh of a convex body.
    pub fn convex(
        vertices: &[[f64; 3]],
        triangles: &[[usize; 3]],
        rounding: f64,
    ) -> Result<Self, String> {
        let vertices = vertices.iter().copied().map(Vector3::from).collect();
        let body = RigidBody::of_mesh(vertices, triangles.to_vec(), true);
        let body = body.map_err(|fault| format!("invalid mesh: {fault}"))?;
        refuse_hollows(&body)?;
        let (volume, centre, second) = moments(&body);
        let second = second / volume - centre * centre.transpose();
        let inertia = Matrix3::identity() * second.trace() - second;
        let found = SymmetricEigen::new(inertia);
        let mut axes = found.eigenvectors;
        if axes.determinant() < 0.0 {
            axes.neg_mut();
        }
        let axes = nalgebra::Rotation3::from_matrix_unchecked(axes);
        Ok(Self {
            body: RigidBody {
                radius: rounding,
                ..body
            },
            volume,
            centre,
            inertia: found.eigenvalues.into(),
            axes: UnitQuaternion::from_rotation_matrix(&axes),
        })
    }
}

/// Checks that no vertex is in front of a face.
fn refuse_hollows(body: &RigidBody) -> Result<(), String> {
    let size = body.vertices.iter().map(|x| x.norm()).fold(0.0, f64::max);
    for (triangle, face) in body.faces.iter().enumerate() {
        let [a, b, c] = face.map(|corner| body.vertices[corner]);
        let normal = (b - a).cross(&(c - a)).normalize();
        let in_front = |x: &Vector3| (x - a).dot(&normal) > FLAT * size;
        if let Some(vertex) = body.vertices.iter().position(in_front) {
            return Err(format!(
                "the mesh is not convex: vertex {vertex} is in front of triangle {triangle}"
            ));
        }
    }
    Ok(())
}

/// Volume, centre and second moments about the origin.
fn moments(body: &RigidBody) -> (f64, Vector3, Matrix3) {
    let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for face in &body.faces {
        let corners = face.map(|corner| body.vertices[corner]);
        let [a, b, c] = corners;
        let (own, sum) = (a.dot(&b.cross(&c)) / 6.0, a + b + c);
        volume += own;
        first += sum * (own / 4.0);
        let squares: Matrix3 = corners.iter().map(|x| x * x.transpose()).sum();
        second += (squares + sum * sum.transpose()) * (own / 20.0);
    }
    (volume, first / volume, second)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_as_a_mesh_has_the_moments_of_a_box() {
        let size = [0.4, 0.3, 0.2];
        let shift = Vector3::new(0.1, -0.2, 0.5);
        let mesh = RigidBody::cuboid(shift, Vector3::from(size), &UnitQuaternion::identity(), 0.0);
        let vertices: Vec<[f64; 3]> = mesh.vertices.iter().map(|x| (*x).into()).collect();
        let found = Solid::convex(&vertices, &mesh.faces, 0.01).unwrap();
        let expected = Solid::cuboid(size, 0.01);
        assert!((found.volume - expected.volume).abs() < 1e-15);
        assert!((found.centre - shift).norm() < 1e-15);
        // The same tensor, whatever the order of the axes.
        let tensor = |solid: &Solid| {
            let axes = solid.axes.to_rotation_matrix();
            let moments = Matrix3::from_diagonal(&Vector3::from(solid.inertia));
            axes.matrix() * moments * axes.matrix().transpose()
        };
        assert!((tensor(&found) - tensor(&expected)).norm() < 1e-15);
    }

    #[test]
    fn a_prism_is_closed_and_convex_and_nearly_a_cylinder() {
        let prism = Solid::prism(0.1, 0.3, 1e-3, 48);
        let vertices: Vec<[f64; 3]> = prism.body.vertices.iter().map(|x| (*x).into()).collect();
        let mesh = Solid::convex(&vertices, &prism.body.faces, 1e-3).unwrap();
        assert!((mesh.volume / prism.volume - 1.0).abs() < 0.04);
        let mut expected = prism.inertia;
        let mut found = mesh.inertia;
        expected.sort_by(f64::total_cmp);
        found.sort_by(f64::total_cmp);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 0.03, "{found} {expected}");
        }
    }

    #[test]
    fn capsules_have_the_moments_of_slices() {
        let (radius, length) = (0.3, 0.8);
        for length in [0.0, length] {
            let found = Solid::capsule(radius, length);
            let (slices, reach) = (20_000, 0.5 * length + radius);
            let (mut volume, mut across, mut along) = (0.0, 0.0, 0.0);
            for slice in 0..slices {
                let z = reach * (2.0 * (f64::from(slice) + 0.5) / f64::from(slices) - 1.0);
                let beyond = (z.abs() - 0.5 * length).max(0.0);
                let square = radius * radius - beyond * beyond;
                let own = 0.5 * TAU * square * 2.0 * reach / f64::from(slices);
                volume += own;
                across += own * (0.25 * square + z * z);
                along += own * 0.5 * square;
            }
            assert!((found.volume / volume - 1.0).abs() < 1e-6);
            assert!((found.inertia[0] / (across / volume) - 1.0).abs() < 1e-6);
            assert!((found.inertia[2] / (along / volume) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_mesh_with_a_hollow_is_refused() {
        let mesh = RigidBody::cuboid(
            Vector3::zeros(),
            Vector3::repeat(1.0),
            &UnitQuaternion::identity(),
            0.0,
        );
        let mut vertices: Vec<[f64; 3]> = mesh.vertices.iter().map(|x| (*x).into()).collect();
        vertices[7] = [0.1; 3];
        let error = Solid::convex(&vertices, &mesh.faces, 0.01).unwrap_err();
        assert!(error.contains("not convex"), "{error}");
    }
}
