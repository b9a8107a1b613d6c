//! Analytic curves as nodes: shapes of a scenario sampled at equal arc length.

use super::catenary::Catenary;
use super::coil::Coil;
use super::slack::Slack;
use crate::scenario::{Handedness, Shape};
use rodlab_engine::mechanics::Vector3;

/// A shape sampled into nodes.
#[derive(Clone, Debug)]
pub struct SampledCurve {
    /// The nodes, m: `edges + 1`, or `edges` for a closed curve.
    pub nodes: Vec<Vector3>,
    /// Unit tangents of the smooth curve at its two ends; `None` for a polyline.
    pub end_tangents: [Option<Vector3>; 2],
}

/// Samples `shape` into `edges` edges of equal arc length.
///
/// Nodes lie on the curve itself, so that an edge is a chord. The length of slack rods and coils
/// is the sum of their chords. A polyline keeps its corners if the number of edges matches, else
/// it is resampled along its length.
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
                let (sine, cosine) = libm::sincos(s * angle);
                tangent * cosine + inward * sine
            };
            SampledCurve {
                nodes: at(&|s| {
                    let (sine, cosine) = libm::sincos(s * angle);
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
                    let (sine, cosine) = libm::sincos(s * std::f64::consts::TAU);
                    centre + (first * cosine + second * sine) * *radius
                }),
                end_tangents: [None; 2],
            }
        }
        Shape::Catenary {
            start,
            end,
            length,
            down,
        } => {
            let [start, end, down] = [start, end, down].map(|&vector| Vector3::from(vector));
            let chain = Catenary::new(start, end, *length, -down);
            SampledCurve {
                nodes: at(&|s| chain.point(s)),
                end_tangents: [Some(chain.tangent(0.0)), Some(chain.tangent(1.0))],
            }
        }
        Shape::Slack {
            start,
            end,
            length,
            towards,
        } => {
            let [start, end, towards] = [start, end, towards].map(|&vector| Vector3::from(vector));
            let arc = Slack::new(start, end, *length, towards, edges);
            SampledCurve {
                nodes: at(&|s| arc.point(s)),
                end_tangents: [Some(arc.tangent(0.0)), Some(arc.tangent(1.0))],
            }
        }
        Shape::Coil {
            centre,
            normal,
            inner_radius,
            spacing,
            length,
            phase,
        } => {
            let coil = Coil {
                centre: Vector3::from(*centre),
                plane: normal_plane(*normal),
                phase: *phase,
                inner_radius: *inner_radius,
                spacing: *spacing,
            };
            let turned = coil.turned(*length, edges);
            SampledCurve {
                nodes: turned.iter().map(|turned| coil.point(*turned)).collect(),
                end_tangents: [turned[0], turned[edges]].map(|at| Some(coil.tangent(at))),
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

/// A helix parametrised by the angle about its axis.
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
        // A left-handed helix turns in the opposite sense; its phase is still measured
        // right-handed about the axis.
        let (sine, cosine) = libm::sincos(phase);
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
        let (sine, cosine) = libm::sincos(turned);
        self.centre
            + (self.first * cosine + self.second * sine) * self.radius
            + self.axis * (self.advance * turned)
    }

    fn tangent(&self, turned: f64) -> Vector3 {
        let (sine, cosine) = libm::sincos(turned);
        ((self.second * cosine - self.first * sine) * self.radius + self.axis * self.advance)
            .normalize()
    }
}

/// Places nodes at equal arc length along a polyline, or at its corners if the number of edges
/// matches.
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
            // Lengths that underflow or overflow give nodes that are not finite; the code that
            // places the rod rejects them.
            let after = lengths
                .partition_point(|&length| length <= wanted)
                .clamp(1, corners.len() - 1);
            let (from, to) = (lengths[after - 1], lengths[after]);
            let fraction = ((wanted - from) / (to - from)).clamp(0.0, 1.0);
            corners[after - 1] * (1.0 - fraction) + corners[after] * fraction
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn edge_lengths(nodes: &[Vector3]) -> Vec<f64> {
        nodes
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .collect()
    }

    fn helix(handedness: Handedness) -> Shape {
        let norm = 14f64.sqrt();
        Shape::Helix {
            centre: [1.0, 2.0, 3.0],
            axis: [1.0 / norm, 2.0 / norm, 3.0 / norm],
            radius: 0.3,
            pitch: 0.5,
            length: 1.25,
            handedness,
            phase: 0.7,
        }
    }

    #[test]
    fn points_at_the_ends_of_the_range_of_numbers_do_not_panic() {
        for size in [1e308, 1e-200] {
            let points = vec![[size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, size]];
            for closed in [false, true] {
                let nodes = sample(
                    &Shape::Points {
                        points: points.clone(),
                    },
                    7,
                    closed,
                )
                .nodes;
                assert_eq!(nodes.len(), if closed { 7 } else { 8 });
            }
        }
    }

    #[test]
    fn a_helix_has_its_curvature_and_torsion() {
        for (handedness, sense) in [(Handedness::Right, 1.0), (Handedness::Left, -1.0)] {
            let edges = 20_000;
            let curve = sample(&helix(handedness), edges, false);
            let advance = 0.5 / TAU;
            let speed_squared = 0.3 * 0.3 + advance * advance;
            // Derivatives with respect to arc length at a node in the middle, from central
            // differences.
            let step = 1.25 / advance * speed_squared.sqrt() / edges as f64;
            let node = |offset: usize| curve.nodes[edges / 2 + offset * 100];
            let step = 100.0 * step;
            let first = (node(2) - node(0)) / (2.0 * step);
            let second = (node(2) - node(1) * 2.0 + node(0)) / (step * step);
            let third = (node(3) - node(2) * 3.0 + node(1) * 3.0 - node(0)) / (step * step * step);
            let curvature = second.norm();
            let torsion = first.cross(&second).dot(&third) / (curvature * curvature);
            assert!((first.norm() - 1.0).abs() < 1e-2);
            assert!((curvature * speed_squared / 0.3 - 1.0).abs() < 1e-2);
            assert!(
                (torsion * speed_squared / advance * sense - 1.0).abs() < 2e-2,
                "{torsion}"
            );
        }
    }

    #[test]
    fn nodes_lie_at_equal_arc_lengths_and_tangents_touch_the_ends() {
        let shapes = [
            helix(Handedness::Left),
            Shape::Straight {
                start: [0.0, 1.0, 0.0],
                end: [3.0, 1.0, 4.0],
            },
            Shape::Arc {
                start: [1.0, 0.0, 0.0],
                tangent: [0.0, 1.0, 0.0],
                normal: [0.0, 0.0, 1.0],
                radius: 2.0,
                angle: FRAC_PI_2,
            },
        ];
        for shape in shapes {
            let curve = sample(&shape, 1000, false);
            let lengths = edge_lengths(&curve.nodes);
            for length in &lengths {
                assert!((length / lengths[0] - 1.0).abs() < 1e-9);
            }
            let [first, last] = curve.end_tangents.map(Option::unwrap);
            let chord = |edge: usize| (curve.nodes[edge + 1] - curve.nodes[edge]).normalize();
            assert!((first - chord(0)).norm() < 1e-2);
            assert!((last - chord(999)).norm() < 1e-2);
            assert!((first.norm() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn an_arc_turns_about_its_normal() {
        let arc = Shape::Arc {
            start: [1.0, 0.0, 0.0],
            tangent: [0.0, 1.0, 0.0],
            normal: [0.0, 0.0, 1.0],
            radius: 1.0,
            angle: FRAC_PI_2,
        };
        let curve = sample(&arc, 8, false);
        assert!((curve.nodes[8] - Vector3::y()).norm() < 1e-15);
        assert!((curve.end_tangents[1].unwrap() + Vector3::x()).norm() < 1e-15);
    }

    #[test]
    fn a_ring_is_a_regular_polygon() {
        let ring = Shape::Ring {
            centre: [0.0, 0.0, 1.0],
            normal: [0.0, 0.0, 1.0],
            radius: 2.0,
        };
        let curve = sample(&ring, 4, true);
        let corners = [[2.0, 0.0], [0.0, 2.0], [-2.0, 0.0], [0.0, -2.0]];
        assert_eq!(curve.nodes.len(), 4);
        for (node, [x, y]) in curve.nodes.iter().zip(corners) {
            assert!((node - Vector3::new(x, y, 1.0)).norm() < 1e-15);
        }
    }

    #[test]
    fn polylines_keep_their_corners_or_are_cut_evenly() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 3.0, 0.0]];
        let shape = Shape::Points {
            points: points.clone(),
        };
        let corners: Vec<Vector3> = points.into_iter().map(Vector3::from).collect();
        assert_eq!(sample(&shape, 2, false).nodes, corners);
        let evenly = sample(&shape, 4, false).nodes;
        let wanted: Vec<Vector3> = (0..5)
            .map(|node| Vector3::new(1.0, (node as f64 - 1.0).max(0.0), 0.0))
            .collect();
        assert_eq!(evenly.len(), 5);
        for (got, wanted) in evenly[1..].iter().zip(&wanted[1..]) {
            assert!((got - wanted).norm() < 1e-15);
        }
        let around = sample(&shape, 8, true).nodes;
        let side = (4.0 + 10f64.sqrt()) / 8.0;
        assert_eq!(around.len(), 8);
        assert!((around[0] - corners[0]).norm() < 1e-15);
        assert!((around[1] - Vector3::new(side, 0.0, 0.0)).norm() < 1e-15);
    }
}
