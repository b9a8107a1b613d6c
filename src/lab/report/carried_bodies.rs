//! Bodies carried by rods, for pictures: at their nodes, and turned with the rods
//! ([`super::rod_frame`]). Spheres and disks do not show that the rotation about the rod is unknown.

use super::rod_frame::RodFrame;
use super::rod_places::{node_at, nodes_of};
use crate::scenario::{BodyShape, Scenario};
use rodlab_engine::mechanics::rigid_body::RigidBody;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use rodlab_files::figure::{Body, MovieObstacle};
use rodlab_files::results::RodRecord;
use std::f64::consts::TAU;

/// Corners of a disk.
const AROUND: usize = 48;

/// Radius of the ball that represents a point mass, over the radius of its rod.
const POINT: f64 = 2.0;

/// A body with a shape, or a point mass.
#[derive(Clone, Debug)]
pub struct CarriedBody {
    frame: RodFrame,
    /// Surface of the body in the frame of directors and tangent, m.
    triangles: Vec<[Vector3; 3]>,
}

/// Bodies that the rods of a scenario carry. `start`: the initial positions of its nodes.
pub fn carried_bodies(
    scenario: Option<&Scenario>,
    rods: &[RodRecord],
    start: &[Vector3],
) -> Vec<CarriedBody> {
    let bodies = scenario.iter().flat_map(|scenario| &scenario.bodies);
    let carried = bodies.filter_map(|body| {
        let nodes = nodes_of(rods, &body.rod)?;
        let described = scenario?.rods.iter().find(|one| one.name == body.rod);
        let record = rods.iter().find(|one| one.name == body.rod)?;
        let shape = body.shape.unwrap_or(BodyShape::Sphere {
            radius: POINT * record.radius,
        });
        let director = described.and_then(|rod| rod.director).map(Vector3::from);
        Some(CarriedBody {
            frame: RodFrame::new(node_at(&nodes, body.at), &nodes, director, start)?,
            triangles: surface(&shape, body.offset),
        })
    });
    carried.collect()
}

impl CarriedBody {
    /// The body as figures show it, with the nodes at these positions.
    pub fn at(&self, positions: &[Vector3]) -> Body {
        let pose = self.frame.pose(positions);
        let placed = |corners: &[Vector3; 3]| corners.map(|corner| pose.of(&corner));
        Body {
            triangles: self.triangles.iter().map(placed).collect(),
            hollow: false,
            convex: false,
        }
    }

    /// The body for the 3-D page, with the nodes at the positions of each output.
    pub fn in_motion<'a>(&self, outputs: impl Iterator<Item = &'a [Vector3]>) -> MovieObstacle {
        MovieObstacle {
            triangles: self.triangles.clone(),
            poses: outputs
                .map(|positions| self.frame.pose(positions).matrix())
                .collect(),
            hollow: false,
            is_carried: true,
        }
    }
}

/// The surface of a shape around a centre, m. The tangent is z.
fn surface(shape: &BodyShape, centre: Option<[f64; 3]>) -> Vec<[Vector3; 3]> {
    let mut triangles = surface_about_origin(shape);
    if let Some(centre) = centre.map(Vector3::from) {
        let corners = triangles.iter_mut().flatten();
        corners.for_each(|corner| *corner += centre);
    }
    triangles
}

fn surface_about_origin(shape: &BodyShape) -> Vec<[Vector3; 3]> {
    let (origin, all) = (Vector3::zeros(), f64::INFINITY);
    match *shape {
        BodyShape::Sphere { radius } => RigidBody::sphere(origin, radius).surface(&origin, all),
        BodyShape::Box { size } => {
            let upright = UnitQuaternion::identity();
            let sides = Vector3::from(size);
            RigidBody::cuboid(origin, sides, &upright, 0.0).surface(&origin, all)
        }
        BodyShape::Disk { radius, thickness } => {
            let corner = |k: usize, side: f64| {
                let (sine, cosine) = libm::sincos(TAU * (k % AROUND) as f64 / AROUND as f64);
                Vector3::new(radius * cosine, radius * sine, 0.5 * side * thickness)
            };
            let mut triangles = Vec::with_capacity(4 * AROUND);
            for k in 0..AROUND {
                for side in [-1.0, 1.0] {
                    let centre = Vector3::z() * (0.5 * side * thickness);
                    triangles.push([centre, corner(k, side), corner(k + 1, side)]);
                }
                let [a, b] = [k, k + 1].map(|k| corner(k, -1.0));
                let [c, d] = [k, k + 1].map(|k| corner(k, 1.0));
                triangles.extend([[a, b, d], [a, d, c]]);
            }
            triangles
        }
    }
}
