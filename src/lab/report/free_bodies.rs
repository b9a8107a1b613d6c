//! Free bodies of a results directory, for pictures: their surfaces at the positions of their
//! vertices.

use nalgebra::{Matrix3, Rotation3};
use rodlab_engine::mechanics::rigid_body::RigidBody;
use rodlab_engine::mechanics::rotation::Pose;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use rodlab_files::figure::{Body, MovieObstacle};
use rodlab_files::results::RodRecord;
use std::ops::Range;

/// A body and its surface at the first output.
#[derive(Clone, Debug)]
pub struct ShownBody {
    /// Its nodes among all nodes.
    nodes: Range<usize>,
    /// Positions of its nodes at the first output, m.
    start: Vec<Vector3>,
    triangles: Vec<[Vector3; 3]>,
}

/// Number of the nodes of rods, which precede those of free bodies.
pub fn rod_nodes(records: &[RodRecord]) -> usize {
    let rods = records.iter().filter(|record| !record.rigid);
    rods.map(|rod| rod.nodes).sum()
}

/// The free bodies among the records. `start`: the positions of all nodes at the first output.
pub fn free_bodies(records: &[RodRecord], start: &[Vector3]) -> Vec<ShownBody> {
    let mut first = 0;
    let mut shown = Vec::new();
    for record in records {
        let nodes = first..first + record.nodes;
        first = nodes.end;
        let Some(placed) = start.get(nodes.clone()).filter(|_| record.rigid) else {
            continue;
        };
        shown.push(ShownBody {
            triangles: surface(record, placed),
            start: placed.to_vec(),
            nodes,
        });
    }
    shown
}

/// The surface of a body with its nodes at these positions, m.
fn surface(record: &RodRecord, placed: &[Vector3]) -> Vec<[Vector3; 3]> {
    let round = |body: RigidBody| body.surface(&placed[0], f64::INFINITY);
    match placed {
        [_, centre] => round(RigidBody::sphere(*centre, record.radius)),
        [_, start, end] => round(RigidBody::capsule([*start, *end], record.radius)),
        _ => {
            let body = RigidBody::of_mesh(placed.to_vec(), record.faces.clone(), true);
            let body = RigidBody {
                radius: record.radius,
                ..body.unwrap_or_default()
            };
            body.sharp_surface()
        }
    }
}

impl ShownBody {
    /// Motion since the first output, with the nodes at these positions: the rotation that fits
    /// them best (W. Kabsch 1976).
    fn pose(&self, positions: &[Vector3]) -> Pose {
        let now = &positions[self.nodes.clone()];
        let mut moment = Matrix3::zeros();
        for (now_at, start_at) in now.iter().zip(&self.start) {
            moment += (now_at - now[0]) * (start_at - self.start[0]).transpose();
        }
        let found = moment.svd(true, true);
        let (left, right) = (found.u, found.v_t);
        let mut turn = left
            .zip(right)
            .map_or_else(Matrix3::identity, |(u, v)| u * v);
        if turn.determinant() < 0.0 {
            let flip = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
            turn = left.zip(right).map_or(turn, |(u, v)| u * flip * v);
        }
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
        Pose {
            rotation,
            translation: now[0] - rotation * self.start[0],
        }
    }

    /// The body as figures show it, with the nodes at these positions.
    pub fn at(&self, positions: &[Vector3]) -> Body {
        let pose = self.pose(positions);
        let placed = |corners: &[Vector3; 3]| corners.map(|corner| pose.of(&corner));
        Body {
            triangles: self.triangles.iter().map(placed).collect(),
            hollow: false,
            convex: true,
        }
    }

    /// The body for the 3-D page, with the nodes at the positions of each output.
    pub fn in_motion<'a>(&self, outputs: impl Iterator<Item = &'a [Vector3]>) -> MovieObstacle {
        MovieObstacle {
            triangles: self.triangles.clone(),
            poses: outputs
                .map(|positions| self.pose(positions).matrix())
                .collect(),
            hollow: false,
            is_carried: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::rotation;

    #[test]
    fn the_surface_follows_the_vertices() {
        let upright = UnitQuaternion::identity();
        let body = RigidBody::cuboid(Vector3::x(), Vector3::new(0.3, 0.2, 0.1), &upright, 0.01);
        let mut start = vec![Vector3::z(); 2];
        start.push(Vector3::x());
        start.extend(&body.vertices);
        let rod = RodRecord {
            nodes: 2,
            ..RodRecord::default()
        };
        let of_body = RodRecord {
            nodes: 9,
            rigid: true,
            radius: 0.01,
            faces: (body.faces.iter())
                .map(|face| face.map(|vertex| vertex + 1))
                .collect(),
            ..RodRecord::default()
        };
        let records = [rod, of_body];
        assert_eq!(rod_nodes(&records), 2);
        let shown = free_bodies(&records, &start);
        assert_eq!(shown.len(), 1);
        let turn = rotation::from_vector(Vector3::new(2.0, -1.0, 0.5));
        let moved: Vec<Vector3> = start.iter().map(|x| turn * x + Vector3::y()).collect();
        let found = shown[0].at(&moved).triangles;
        for (found, placed) in found.iter().zip(&shown[0].triangles) {
            for (found, placed) in found.iter().zip(placed) {
                assert!((found - (turn * placed + Vector3::y())).norm() < 1e-12);
            }
        }
    }
}
