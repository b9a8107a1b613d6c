//! View of a rod in a photograph.
//!
//! A photograph shows the rod foreshortened, and nearer parts of it larger. Both effects follow
//! from the fitted rod, and the fit is repeated with them. A traced point q is the point at which
//! the line of sight meets the plane of the clamp. With the eye at a height h over the point c of
//! this plane, a point of the rod at the depth z towards the eye is at
//!
//! ```text
//! p = c + (q − c)(1 − z/h)
//! ```
//!
//! and each fraction of the length of the curve p is matched with the same fraction of the rod as
//! seen along the normal of the plane.

use super::hanging::{POINTS, arc_lengths};
use rodlab_engine::mechanics::Vector3;
use std::path::Path;

/// Iterations that remove the perspective; each leaves about a tenth of the error.
const APPROACHES: usize = 8;

/// A traced photograph.
#[derive(Clone, Debug)]
pub struct Photograph<'a> {
    /// The picture, for messages.
    pub picture: &'a Path,
    /// Centreline from the clamp to the free end, m, as it appears in the plane of the clamp.
    pub points: &'a [[f64; 2]],
    /// Direction of gravity in the coordinates of the points.
    pub down: [f64; 2],
    /// Turn of the rod about its axis at the clamp, rad; at 0 its plane of curvature is that of the photograph.
    pub roll: f64,
    /// Place of the eye, m: coordinates in the plane and its distance from it; `None` for an eye
    /// at infinity.
    pub eye: Option<[f64; 3]>,
}

/// Fitted rod, as a photograph shows it.
pub struct View {
    /// Fraction of the length of the rod at fractions of the length of the visible curve.
    pub places: Vec<f64>,
    /// Depth towards the eye there, m.
    pub depths: Vec<f64>,
    /// Visible length over the length of the rod.
    pub seen: f64,
    /// Direction at the clamp, and turn about this direction, rad.
    pub angle: f64,
    pub roll: f64,
}

impl View {
    /// The view of a rod in the plane of the clamp, with its direction there and its turn, rad.
    pub fn of_the_plane([angle, roll]: [f64; 2]) -> Self {
        Self {
            places: parts().collect(),
            depths: vec![0.0; POINTS + 1],
            seen: 1.0,
            angle,
            roll,
        }
    }

    /// Computes the view of a rod of a length, m, from its nodes; the plane of the clamp is z = 0.
    pub fn of(nodes: &[Vector3], length: f64, [angle, roll]: [f64; 2]) -> Self {
        let flat: Vec<[f64; 2]> = nodes.iter().map(|node| [node.x, node.y]).collect();
        let lengths = arc_lengths(&flat);
        let (last, whole) = (nodes.len() - 1, lengths[lengths.len() - 1]);
        let along: Vec<f64> = lengths.iter().map(|length| length / whole).collect();
        let place: Vec<f64> = (0..=last).map(|node| node as f64 / last as f64).collect();
        let depth: Vec<f64> = nodes.iter().map(|node| node.z).collect();
        let at_parts = |values: &[f64]| {
            parts()
                .map(|part| interpolated(&along, values, part))
                .collect()
        };
        Self {
            places: at_parts(&place),
            depths: at_parts(&depth),
            seen: whole / length,
            angle,
            roll,
        }
    }

    /// Returns the curve of a photograph as it appears along the normal of the plane of the clamp.
    pub fn without_perspective(&self, photograph: &Photograph<'_>) -> Vec<[f64; 2]> {
        let Some([x, y, height]) = photograph.eye else {
            return photograph.points.to_vec();
        };
        let at: Vec<f64> = parts().collect();
        let mut curve = photograph.points.to_vec();
        // Depths are given at fractions of the length of the unknown curve.
        for _ in 0..APPROACHES {
            let lengths = arc_lengths(&curve);
            let whole = lengths[lengths.len() - 1];
            for ((point, seen), length) in curve.iter_mut().zip(photograph.points).zip(&lengths) {
                let nearer = 1.0 - interpolated(&at, &self.depths, length / whole) / height;
                *point = [x + (seen[0] - x) * nearer, y + (seen[1] - y) * nearer];
            }
        }
        curve
    }
}

fn parts() -> impl Iterator<Item = f64> {
    (0..=POINTS).map(|number| number as f64 / POINTS as f64)
}

/// Evaluates a piecewise linear function at `x`.
fn interpolated(at: &[f64], values: &[f64], x: f64) -> f64 {
    let after = at.partition_point(|one| *one < x).clamp(1, at.len() - 1);
    let width = at[after] - at[after - 1];
    let weight = if width > 0.0 {
        (x - at[after - 1]) / width
    } else {
        0.0
    };
    let weight = weight.clamp(0.0, 1.0);
    (1.0 - weight) * values[after - 1] + weight * values[after]
}
