//! Bounds of a scene in motion.

use super::super::View;
use super::movie::MovieCase;
use nalgebra::Vector3;
use std::ops::Range;

/// Bounds of the objects other than nodes, and the box around the whole scene.
pub(in crate::figure) struct Outline {
    /// Corners of a box in the axes of each carried body, from its farthest points along each
    /// axis.
    boxes: Vec<Option<[Vector3<f64>; 8]>>,
    lower: Vector3<f64>,
    upper: Vector3<f64>,
}

/// The outline of a case. If a rod is followed, only that of this rod, relative to its middle.
pub(in crate::figure) fn outline(case: &MovieCase, follow: Option<&Range<usize>>) -> Outline {
    let boxes = case.obstacles.iter().map(|body| {
        let corners = body.triangles.iter().flatten();
        (body.is_carried && !body.triangles.is_empty()).then(|| {
            let (lower, upper) = corners.fold(empty(), |(lower, upper), corner| {
                (lower.inf(corner), upper.sup(corner))
            });
            std::array::from_fn(|corner| {
                Vector3::from_fn(|axis, _| {
                    if corner >> axis & 1 == 0 {
                        lower[axis]
                    } else {
                        upper[axis]
                    }
                })
            })
        })
    });
    let mut outline = Outline {
        boxes: boxes.collect(),
        lower: Vector3::zeros(),
        upper: Vector3::zeros(),
    };
    let (mut lower, mut upper) = empty();
    for frame in 0..case.frames.len() {
        outline.visit(case, frame, follow, &mut |point, reach| {
            lower = lower.inf(&point.add_scalar(-reach));
            upper = upper.sup(&point.add_scalar(reach));
        });
    }
    (outline.lower, outline.upper) = (lower, upper);
    outline
}

/// The box around the motion of a case, thickness included: lowest corner and extents, m.
pub(in crate::figure) fn room(case: &MovieCase) -> [Vector3<f64>; 2] {
    let outline = outline(case, None);
    [outline.lower, outline.upper - outline.lower]
}

impl MovieCase {
    /// A view that shows all of its motion well, strips at their width.
    pub fn fitting_view(&self) -> View {
        if self.rods.iter().all(|rod| rod.strip.is_none()) {
            return View::fitting(self.frames.iter().flat_map(|frame| &frame.positions));
        }
        let outline = outline(self, None);
        let mut points = Vec::new();
        for frame in 0..self.frames.len() {
            outline.visit(self, frame, None, &mut |point, _| points.push(point));
        }
        View::fitting(points.iter())
    }
}

fn empty() -> (Vector3<f64>, Vector3<f64>) {
    (
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    )
}

impl Outline {
    /// The middle of the box.
    pub(in crate::figure) fn middle(&self) -> Vector3<f64> {
        0.5 * (self.lower + self.upper)
    }

    /// Visits points that bound the visible scene at a frame, with the radius around each, m.
    pub(in crate::figure) fn visit(
        &self,
        case: &MovieCase,
        frame: usize,
        follow: Option<&Range<usize>>,
        take: &mut impl FnMut(Vector3<f64>, f64),
    ) {
        let positions = &case.frames[frame].positions;
        let about = follow.map(|nodes| centre(&positions[nodes.clone()]));
        let about = about.unwrap_or_else(Vector3::zeros);
        let mut first = 0;
        for rod in &case.rods {
            let nodes = first..first + rod.nodes;
            first += rod.nodes;
            if follow.is_some_and(|followed| *followed != nodes) {
                continue;
            }
            let points = &positions[nodes];
            match &rod.strip {
                None => (points.iter().enumerate())
                    .for_each(|(node, point)| take(point - about, rod.radius_at(node))),
                Some(strip) => {
                    for node in 0..points.len() {
                        let across = 0.5 * strip.width * strip.across(node, points, rod.closed);
                        take(points[node] + across - about, 0.5 * strip.thickness);
                        take(points[node] - across - about, 0.5 * strip.thickness);
                    }
                }
            }
        }
        if follow.is_some() {
            return;
        }
        for (body, corners) in case.obstacles.iter().zip(&self.boxes) {
            for corner in corners.iter().flatten() {
                let pose = body.poses.get(frame);
                take(pose.map_or(*corner, |pose| placed(pose, corner)), 0.0);
            }
        }
    }
}

/// Mean of some points.
pub(in crate::figure) fn centre(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64
}

/// A point transformed by a matrix in column-major order.
pub(in crate::figure) fn placed(pose: &[f64; 16], point: &Vector3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|row, _| {
        pose[row] * point.x + pose[4 + row] * point.y + pose[8 + row] * point.z + pose[12 + row]
    })
}
