//! Shapes of links for collision checks.

use super::pose::Pose;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use parry3d_f64::math::Vec3;
use parry3d_f64::shape::ConvexPolyhedron;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A shape that moves with a link.
#[derive(Clone, Debug)]
pub struct Body {
    /// Index of the chain's segment that carries it; `None` for the base.
    pub link: Option<usize>,
    /// Pose in the frame of that link.
    pub pose: Pose,
    /// Shape of the body.
    pub shape: Shape,
}

/// A convex shape; its origin is at its middle.
#[derive(Clone, Debug)]
pub enum Shape {
    /// All points within `radius` of a line along z, m; a ball if the line has zero length.
    Capsule {
        /// Half the length of the line.
        half_length: f64,
        /// Radius.
        radius: f64,
    },
    /// A box, m.
    Box {
        /// Half its sides along x, y and z.
        half: [f64; 3],
    },
    /// The convex hull of a mesh.
    Hull(Arc<Hull>),
}

/// The convex hull of points, relative to the middle of their bounding box.
#[derive(Debug)]
pub struct Hull {
    pub(super) polyhedron: ConvexPolyhedron,
}

impl Hull {
    /// Number of directions per outline of the hull.
    const AROUND: usize = 16;

    /// Distance of its farthest corner from its origin, m.
    pub(super) fn radius(&self) -> f64 {
        let corners = self.polyhedron.points().iter();
        corners.map(|corner| corner.length()).fold(0.0, f64::max)
    }

    /// Outlines as seen along x, y and z: corners of the hull on closed lines.
    pub fn outlines(&self) -> [Vec<[f64; 3]>; 3] {
        [0, 1, 2].map(|axis| {
            let mut line: Vec<[f64; 3]> = Vec::new();
            for k in 0..=Self::AROUND {
                let (sine, cosine) = libm::sincos(TAU * k as f64 / Self::AROUND as f64);
                let mut direction = [0.0; 3];
                (direction[(axis + 1) % 3], direction[(axis + 2) % 3]) = (cosine, sine);
                let direction = Vec3::from_array(direction);
                let farthest = self
                    .polyhedron
                    .points()
                    .iter()
                    .max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)));
                let corner = farthest.map_or([0.0; 3], |corner| corner.to_array());
                if line.last() != Some(&corner) {
                    line.push(corner);
                }
            }
            line
        })
    }
}

impl Body {
    /// A capsule between two points of a link's frame, m.
    pub fn capsule(link: Option<usize>, from: [f64; 3], to: [f64; 3], radius: f64) -> Self {
        let (from, to) = (Vector3::from(from), Vector3::from(to));
        let along = to - from;
        let rotation =
            UnitQuaternion::rotation_between(&Vector3::z(), &along).unwrap_or_else(|| {
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
            });
        Self {
            link,
            pose: Pose::from_parts(Translation3::from(0.5 * (from + to)), rotation),
            shape: Shape::Capsule {
                half_length: 0.5 * along.norm(),
                radius,
            },
        }
    }

    /// The convex hull of points of a link's frame, m; `None` if they lie on a line.
    pub fn hull(link: Option<usize>, frame: &Pose, points: &[[f64; 3]]) -> Option<Self> {
        let ends = |fold: fn(f64, f64) -> f64, start: f64| {
            [0, 1, 2].map(|k| points.iter().map(|point| point[k]).fold(start, fold))
        };
        let (low, high) = (
            ends(f64::min, f64::INFINITY),
            ends(f64::max, f64::NEG_INFINITY),
        );
        let middle = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
        let mut local: Vec<[f64; 3]> = points
            .iter()
            .map(|point| [0, 1, 2].map(|k| point[k] - middle[k]))
            .collect();
        // Several triangles share each corner.
        local.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        local.dedup();
        let points: Vec<Vec3> = local.into_iter().map(Vec3::from_array).collect();
        let polyhedron = ConvexPolyhedron::from_convex_hull(&points)?;
        Some(Self {
            link,
            pose: frame * Translation3::from(middle),
            shape: Shape::Hull(Arc::new(Hull { polyhedron })),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_reaches_from_one_point_to_the_other() {
        for [from, to] in [
            [[0.1, 0.2, 0.3], [0.4, -0.2, 0.3]],
            [[0.0, 0.0, 0.5], [0.0, 0.0, -0.1]],
            [[0.0, 0.0, 0.0], [0.0, 0.0, 0.7]],
        ] {
            let body = Body::capsule(None, from, to, 0.05);
            let Shape::Capsule {
                half_length,
                radius,
            } = body.shape
            else {
                panic!("{body:?}");
            };
            assert_eq!(radius, 0.05);
            for (end, side) in [(from, -1.0), (to, 1.0)] {
                let tip = nalgebra::Point3::new(0.0, 0.0, side * half_length);
                let off = (body.pose * tip).coords - Vector3::from(end);
                assert!(off.norm() < 1e-15, "{from:?} {to:?}: {off}");
            }
        }
    }
}
