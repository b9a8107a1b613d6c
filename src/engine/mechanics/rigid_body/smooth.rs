//! Meshes that stand for smooth surfaces: normals at their corners, and creases.

use super::{RigidBody, by_side, normal_of};
use crate::mechanics::Vector3;

/// No face, across a crease or a border.
pub const NO_FACE: u32 = u32::MAX;

/// Least cosine of the angle between a face and the normals at its corners, 73°. Sides of faces
/// beyond it count as creases.
const LEAST_COSINE: f64 = 0.3;

/// Normals of a mesh that stands for a smooth surface with creases.
///
/// A side of two triangles is a crease if their normals make a larger angle than the crease angle.
/// The normal at a corner of a triangle is the mean over the triangles around its vertex that are
/// joined to it across sides that are not creases, weighted by their angles there (Thürmer and
/// Wüthrich 1998). So it does not depend on how a flat polygon is cut into triangles, and is exact
/// for a right prism with corners on a circle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SmoothMesh {
    /// Unit normals.
    pub normals: Vec<Vector3>,
    /// Normals of the three corners of each triangle.
    pub corners: Vec<[u32; 3]>,
    /// The triangle across the side opposite to each corner; [`NO_FACE`] across a crease or border.
    pub across: Vec<[u32; 3]>,
    /// The first triangle of the smooth part of the surface that contains each triangle.
    pub regions: Vec<u32>,
    /// Whether each segment of the body is a crease or a border.
    pub sharp: Vec<bool>,
}

/// Sets that are joined.
struct Sets(Vec<u32>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The least member of the set of a member.
    fn first(&mut self, member: usize) -> usize {
        let mut first = member;
        while self.0[first] as usize != first {
            self.0[first] = self.0[self.0[first] as usize];
            first = self.0[first] as usize;
        }
        first
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.first(one), self.first(other));
        self.0[one.max(other)] = one.min(other) as u32;
    }
}

impl RigidBody {
    /// Lets a mesh stand for a smooth surface through its vertices, with creases where triangles
    /// meet at more than `crease_angle` (rad).
    pub fn smoothed(self, crease_angle: f64) -> Self {
        let cosine = libm::cos(crease_angle);
        let mut broken = vec![false; self.faces.len()];
        loop {
            let smooth = self.smooth_mesh(cosine, &broken);
            let is_steep = |face: &usize| {
                let own = normal_of(&self.faces[*face].map(|vertex| self.vertices[vertex]));
                let corners = smooth.corners[*face].iter();
                let mut cosines = corners.map(|corner| smooth.normals[*corner as usize].dot(&own));
                cosines.any(|cosine| cosine < LEAST_COSINE)
            };
            let steep: Vec<usize> = (0..self.faces.len()).filter(is_steep).collect();
            if steep.is_empty() {
                return Self {
                    smooth: Some(smooth),
                    ..self
                };
            }
            steep.into_iter().for_each(|face| broken[face] = true);
        }
    }

    /// Largest curvature along the side of a triangle of a smooth mesh that bends away from its
    /// normals, 1/m: (n_j − n_i)·(p_j − p_i)/‖p_j − p_i‖²; 0 for others.
    pub fn largest_curvature(&self) -> f64 {
        let Some(smooth) = &self.smooth else {
            return 0.0;
        };
        let sides = (0..self.faces.len()).flat_map(|face| self.smooth_sides(smooth, face));
        let curvatures = sides.map(|(side, [m, n])| side.dot(&(n - m)) / side.norm_squared());
        curvatures.fold(0.0, f64::max)
    }

    /// The three sides of a face of a smooth mesh, m, and the normals at their ends.
    fn smooth_sides(&self, smooth: &SmoothMesh, face: usize) -> [(Vector3, [Vector3; 2]); 3] {
        let (vertices, normals) = (self.faces[face], smooth.corners[face]);
        [[0, 1], [1, 2], [2, 0]].map(|ends| {
            let [p, q] = ends.map(|k| self.vertices[vertices[k]]);
            (q - p, ends.map(|k| smooth.normals[normals[k] as usize]))
        })
    }

    /// Estimate from above of the distance of the smooth surface from a face, m: a third of the
    /// largest (n_j − n_i)·(p_j − p_i) of two corners.
    pub(crate) fn bulge_of(&self, face: usize) -> f64 {
        let Some(smooth) = &self.smooth else {
            return 0.0;
        };
        let bends = self.smooth_sides(smooth, face);
        let bends = bends.map(|(side, [m, n])| side.dot(&(n - m)).abs() / 3.0);
        bends.into_iter().fold(0.0, f64::max)
    }

    /// Normals with creases of this cosine and around the `broken` faces.
    fn smooth_mesh(&self, cosine: f64, broken: &[bool]) -> SmoothMesh {
        let at = |face: usize| self.faces[face].map(|vertex| self.vertices[vertex]);
        let normals: Vec<Vector3> = (0..self.faces.len()).map(|f| normal_of(&at(f))).collect();
        let sides = by_side(&self.faces);
        let mut across = vec![[NO_FACE; 3]; self.faces.len()];
        let mut corners = Sets::new(3 * self.faces.len());
        let mut regions = Sets::new(self.faces.len());
        let is_smooth = |one: usize, other: usize| {
            !broken[one] && !broken[other] && normals[one].dot(&normals[other]) > cosine
        };
        let corner_of = |face: usize, vertex: usize| {
            let of_face = self.faces[face].iter();
            of_face.enumerate().find(|(_, own)| **own == vertex)
        };
        for (ends, around) in &sides {
            let [(one, _), (other, _)] = around[..] else {
                continue;
            };
            if !is_smooth(one, other) {
                continue;
            }
            regions.join(one, other);
            for &end in ends {
                if let (Some((k, _)), Some((l, _))) = (corner_of(one, end), corner_of(other, end)) {
                    corners.join(3 * one + k, 3 * other + l);
                }
            }
            for (face, next) in [(one, other), (other, one)] {
                let opposite = self.faces[face].iter();
                let opposite = opposite.enumerate().find(|(_, own)| !ends.contains(own));
                if let Some((k, _)) = opposite {
                    across[face][k] = next as u32;
                }
            }
        }
        let mut sums = vec![Vector3::zeros(); 3 * self.faces.len()];
        for (face, normal) in normals.iter().enumerate() {
            let points = at(face);
            for k in 0..3 {
                let [one, other] = [1, 2].map(|l| points[(k + l) % 3] - points[k]);
                let angle = libm::atan2(one.cross(&other).norm(), one.dot(&other));
                sums[corners.first(3 * face + k)] += normal * angle;
            }
        }
        let mut numbers = vec![NO_FACE; sums.len()];
        let mut smooth = SmoothMesh {
            across,
            ..SmoothMesh::default()
        };
        for face in 0..self.faces.len() {
            smooth.corners.push([0, 1, 2].map(|k| {
                let first = corners.first(3 * face + k);
                if numbers[first] == NO_FACE {
                    numbers[first] = smooth.normals.len() as u32;
                    let mean = sums[first].try_normalize(0.0);
                    smooth.normals.push(mean.unwrap_or(normals[face]));
                }
                numbers[first]
            }));
            smooth.regions.push(regions.first(face) as u32);
        }
        let is_sharp = |ends: &[usize; 2]| match sides.get(ends).map(Vec::as_slice) {
            Some([(one, _), (other, _)]) => !is_smooth(*one, *other),
            _ => true,
        };
        smooth.sharp = self.segments.iter().map(is_sharp).collect();
        smooth
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A prism with corners on a circle, its sides cut into triangles, with ends or without.
    fn prism(sides: usize, ends: bool) -> RigidBody {
        let corner = |k: usize| {
            let (sine, cosine) = libm::sincos(TAU * (k % sides) as f64 / sides as f64);
            Vector3::new(cosine, sine, if k < sides { 0.0 } else { 3.0 })
        };
        let mut faces = Vec::new();
        for k in 0..sides {
            let next = (k + 1) % sides;
            faces.extend([[k, next, sides + next], [k, sides + next, sides + k]]);
            if ends && k > 0 && k + 1 < sides {
                faces.extend([[0, k + 1, k], [sides, sides + k, sides + k + 1]]);
            }
        }
        RigidBody::of_mesh((0..2 * sides).map(corner).collect(), faces, ends).unwrap()
    }

    #[test]
    fn normals_of_a_prism_are_radial_and_its_ends_are_creases() {
        for ends in [false, true] {
            let body = prism(12, ends).smoothed(1.0);
            let smooth = body.smooth.as_ref().unwrap();
            for (face, corners) in body.faces.iter().zip(&smooth.corners) {
                let is_end = face.iter().all(|v| (*v < 12) == (face[0] < 12));
                for (vertex, normal) in face.iter().zip(corners) {
                    let at = body.vertices[*vertex];
                    let radial = Vector3::new(at.x, at.y, 0.0);
                    let axial = Vector3::z() * if at.z > 0.0 { 1.0 } else { -1.0 };
                    let expected = if is_end { axial } else { radial };
                    let normal = smooth.normals[*normal as usize];
                    assert!((normal - expected).norm() < 1e-14, "{normal} {expected}");
                }
            }
            // The 24 sides of the ends are sharp, those along the axis are not.
            let sharp = smooth.sharp.iter().filter(|sharp| **sharp).count();
            assert_eq!(sharp, 24);
            let mut regions = smooth.regions.clone();
            regions.sort_unstable();
            regions.dedup();
            assert_eq!(regions.len(), if ends { 3 } else { 1 });
        }
    }

    #[test]
    fn neighbours_across_sides_see_each_other() {
        let body = prism(12, true).smoothed(1.0);
        let smooth = body.smooth.as_ref().unwrap();
        for (face, across) in smooth.across.iter().enumerate() {
            for (k, &next) in across.iter().enumerate().filter(|(_, f)| **f != NO_FACE) {
                let next = next as usize;
                assert!(smooth.across[next].contains(&(face as u32)));
                let opposite = body.faces[face][k];
                assert!(!body.faces[next].contains(&opposite));
            }
        }
    }

    #[test]
    fn below_the_crease_angle_all_is_smooth_and_steep_faces_are_not() {
        let smooth = |angle: f64| prism(12, true).smoothed(angle).smooth.unwrap();
        assert!(smooth(0.1).sharp.iter().all(|sharp| *sharp));
        assert!(smooth(1.7).sharp.iter().all(|sharp| !*sharp));
        // Two faces of a sheet folded back on itself.
        let vertices = [[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.5, 0.0], [1.0, 0.5, 0.05]];
        let faces = vec![[0, 2, 1], [0, 1, 3]];
        let fold = RigidBody::of_mesh(vertices.map(Vector3::from).to_vec(), faces, false).unwrap();
        assert!(fold.smoothed(3.1).smooth.unwrap().sharp.iter().all(|s| *s));
    }
}
