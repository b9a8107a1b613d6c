//! Analytic curves as nodes: shapes of a scenario sampled at equal arc length.

use crate::mechanics::Vector3;
use crate::scenario::{Handedness, Shape};

/// A shape sampled into nodes.
#[derive(Clone, Debug)]
pub struct SampledCurve {
    /// The nodes, m: `edges + 1`, or `edges` for a closed curve.
    pub nodes: Vec<Vector3>,
    /// Unit tangents of the smooth curve at its two ends; `None` for a polyline, which has none.
    pub end_tangents: [Option<Vector3>; 2],
}

/// Samples `shape` into `edges` edges of equal arc length.
///
/// Nodes lie on the curve itself, so that an edge is a chord. A polyline keeps its corners where the
/// number of edges fits, else it is resampled along its length.
pub fn sample(shape: &Shape, edges: usize, closed: bool) -> SampledCurve {
    let nodes = if closed { edges } else { edges + 1 };
    let at = |curve: &dyn Fn(f64) -> Vector3| {
        (0..nodes)
            .map(|node| curve(node as f64 / edges as f64))
            .collect()
    };
    match shape {
        Shape::Straight { start, end } => {
            let (start, end) = (Vector3::from(*start), Vector3::from(*end));
            let tangent = (end - start).normalize();
            SampledCurve {
                nodes: at(&|s| start * (1.0 - s) + end * s),
                end_tangents: [Some(tangent); 2],
            }
        }
        Shape::Helix {
            centre,
            axis,
            radius,
            pitch,
            length,
            handedness,
            phase,
        } => {
            let helix = Helix::new(*centre, *axis, *radius, *pitch, *handedness, *phase);
            let turn = std::f64::consts::TAU * length / pitch;
            SampledCurve {
                nodes: at(&|s| helix.point(s * turn)),
                end_tangents: [Some(helix.tangent(0.0)), Some(helix.tangent(turn))],
            }
        }
        Shape::Arc {
            start,
            tangent,
            normal,
            radius,
            angle,
        } => {
            let tangent = Vector3::from(*tangent);
            let inward = Vector3::from(*normal).cross(&tangent);
            let centre = Vector3::from(*start) + inward * *radius;
            let direction = |s: f64| {
                let (sine, cosine) = (s * angle).sin_cos();
                tangent * cosine + inward * sine
            };
            SampledCurve {
                nodes: at(&|s| {
                    let (sine, cosine) = (s * angle).sin_cos();
                    centre + (tangent * sine - inward * cosine) * *radius
                }),
                end_tangents: [Some(direction(0.0)), Some(direction(1.0))],
            }
        }
        Shape::Ring {
            centre,
            normal,
            radius,
        } => {
            let [first, second] = normal_plane(*normal);
            let centre = Vector3::from(*centre);
            SampledCurve {
                nodes: at(&|s| {
                    let (sine, cosine) = (s * std::f64::consts::TAU).sin_cos();
                    centre + (first * cosine + second * sine) * *radius
                }),
                end_tangents: [None; 2],
            }
        }
        Shape::Points { points } => SampledCurve {
            nodes: resample(points, edges, closed),
            end_tangents: [None; 2],
        },
    }
}

/// [`Shape::normal_plane`] as vectors.
fn normal_plane(axis: [f64; 3]) -> [Vector3; 2] {
    Shape::normal_plane(axis).map(Vector3::from)
}

/// A helix parametrised by the angle turned about its axis.
struct Helix {
    centre: Vector3,
    axis: Vector3,
    first: Vector3,
    second: Vector3,
    radius: f64,
    advance: f64,
}

impl Helix {
    fn new(
        centre: [f64; 3],
        axis: [f64; 3],
        radius: f64,
        pitch: f64,
        handedness: Handedness,
        phase: f64,
    ) -> Self {
        let [first, second] = normal_plane(axis);
        let sense = match handedness {
            Handedness::Right => 1.0,
            Handedness::Left => -1.0,
        };
        // A left-handed helix turns the other way; its phase still counts right-handed about the axis.
        let (sine, cosine) = f64::sin_cos(phase);
        Self {
            centre: Vector3::from(centre),
            axis: Vector3::from(axis),
            first: first * cosine + second * sine,
            second: (second * cosine - first * sine) * sense,
            radius,
            advance: pitch / std::f64::consts::TAU,
        }
    }

    fn point(&self, turned: f64) -> Vector3 {
        let (sine, cosine) = turned.sin_cos();
        self.centre
            + (self.first * cosine + self.second * sine) * self.radius
            + self.axis * (self.advance * turned)
    }

    fn tangent(&self, turned: f64) -> Vector3 {
        let (sine, cosine) = turned.sin_cos();
        ((self.second * cosine - self.first * sine) * self.radius + self.axis * self.advance)
            .normalize()
    }
}

/// Places nodes at equal arc length along a polyline; its own corners where the number of edges fits.
fn resample(points: &[[f64; 3]], edges: usize, closed: bool) -> Vec<Vector3> {
    let mut corners: Vec<Vector3> = points.iter().map(|&point| Vector3::from(point)).collect();
    let corner_edges = if closed {
        corners.len()
    } else {
        corners.len() - 1
    };
    if corner_edges == edges {
        return corners;
    }
    if closed {
        corners.push(corners[0]);
    }
    let mut lengths = vec![0.0];
    for pair in corners.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let total = lengths[lengths.len() - 1];
    let nodes = if closed { edges } else { edges + 1 };
    (0..nodes)
        .map(|node| {
            let wanted = total * node as f64 / edges as f64;
            let after = lengths
                .partition_point(|&length| length <= wanted)
                .min(corners.len() - 1);
            let (from, to) = (lengths[after - 1], lengths[after]);
            let fraction = ((wanted - from) / (to - from)).clamp(0.0, 1.0);
            corners[after - 1] * (1.0 - fraction) + corners[after] * fraction
        })
        .collect()
}
