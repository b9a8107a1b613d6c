//! Rigid bodies of a film: their triangles with a normal at each corner, smooth where faces meet at a small angle.

use super::super::motion::{MovieObstacle, placed};
use super::camera::Camera;
use super::samples::Corner;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Cosine of the largest angle between faces that look like one smooth surface.
const CREASE: f64 = 0.8;

/// A body of a film.
pub(super) struct Body<'a> {
    triangles: &'a [[Vector3<f64>; 3]],
    normals: Vec<[Vector3<f64>; 3]>,
    poses: &'a [[f64; 16]],
    pub hollow: bool,
}

impl<'a> Body<'a> {
    pub fn of(body: &'a MovieObstacle) -> Self {
        Self {
            triangles: &body.triangles,
            normals: normals(&body.triangles),
            poses: &body.poses,
            hollow: body.hollow,
        }
    }

    /// The corners of the triangles in the picture, between two outputs.
    pub fn corners(
        &self,
        [from, to]: [usize; 2],
        blend: f64,
        camera: &Camera,
    ) -> impl Iterator<Item = [Corner; 3]> {
        let still = [
            1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.,
        ];
        let pose = |frame: usize| self.poses.get(frame).unwrap_or(&still);
        let (a, b) = (pose(from), pose(to));
        let pose: [f64; 16] = std::array::from_fn(|k| a[k] + blend * (b[k] - a[k]));
        let direction = pose_of_directions(&pose);
        let camera = *camera;
        let both = self.triangles.iter().zip(&self.normals);
        both.map(move |(corners, normals)| {
            std::array::from_fn(|k| Corner {
                at: camera.place(&placed(&pose, &corners[k])),
                normal: camera.turn(&placed(&direction, &normals[k])),
            })
        })
    }
}

/// A pose without its translation.
fn pose_of_directions(pose: &[f64; 16]) -> [f64; 16] {
    let mut directions = *pose;
    directions[12..15].fill(0.0);
    directions
}

/// The mean normal at each corner of the adjacent faces, weighted by their areas, without those
/// beyond a crease.
pub(in crate::figure) fn normals(triangles: &[[Vector3<f64>; 3]]) -> Vec<[Vector3<f64>; 3]> {
    let key =
        |corner: &Vector3<f64>| [corner.x, corner.y, corner.z].map(|x| (x as f32 + 0.0).to_bits());
    let areas: Vec<Vector3<f64>> = triangles
        .iter()
        .map(|[a, b, c]| (b - a).cross(&(c - a)))
        .collect();
    let mut faces: BTreeMap<[u32; 3], Vec<usize>> = BTreeMap::new();
    for (face, corners) in triangles.iter().enumerate() {
        for corner in corners {
            faces.entry(key(corner)).or_default().push(face);
        }
    }
    let unit = |vector: &Vector3<f64>| vector.try_normalize(0.0).unwrap_or_else(Vector3::z);
    let at = |face: usize, corner: &Vector3<f64>| {
        let own = unit(&areas[face]);
        let around = faces[&key(corner)].iter().map(|other| areas[*other]);
        let smooth = around.filter(|area| unit(area).dot(&own) > CREASE);
        unit(&smooth.sum::<Vector3<f64>>())
    };
    let each = triangles.iter().enumerate();
    each.map(|(face, corners)| corners.each_ref().map(|corner| at(face, corner)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_bodies_are_smooth_and_edges_stay_sharp() {
        let corner = |k: usize, z: f64| {
            let (sine, cosine) = (std::f64::consts::TAU * k as f64 / 24.0).sin_cos();
            Vector3::new(cosine, sine, z)
        };
        let mut triangles = Vec::new();
        for k in 0..24 {
            let [a, b, c, d] = [
                corner(k, 0.0),
                corner((k + 1) % 24, 0.0),
                corner(k, 1.0),
                corner((k + 1) % 24, 1.0),
            ];
            triangles.extend([[a, b, d], [a, d, c], [Vector3::z(), c, d]]);
        }
        for (corners, normals) in triangles.iter().zip(normals(&triangles)) {
            let is_lid = corners[0] == Vector3::z();
            for (corner, normal) in corners.iter().zip(normals) {
                let round = Vector3::new(corner.x, corner.y, 0.0);
                let expected = if is_lid { Vector3::z() } else { round };
                assert!((normal - expected).norm() < 0.05, "{normal}");
            }
        }
    }
}
