//! Distances of a laid rod from its pattern (thesis Eq. 5.11).

use nalgebra::Vector2;
use rodlab_engine::mechanics::Vector3;
use serde::{Deserialize, Serialize};

/// Number of compared points of the pattern, as in the thesis.
pub const POINTS: usize = 50;

/// A point of the pattern: arc length from its start including the lead-in, and position, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatternMark {
    /// Arc length, m.
    pub s: f64,
    /// Place, m.
    pub position: [f64; 2],
}

/// Distances of corresponding points, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaidError {
    /// Mean distance e_mean.
    pub mean: f64,
    /// Standard deviation σ. Eq. 5.11 as printed lacks a square, without which σ would be zero.
    pub deviation: f64,
    /// Largest distance.
    pub largest: f64,
}

/// Position of a rod at an arc length from its first node, seen from above, m. `length` is the
/// length of the rod, whose edges are equal.
pub fn rod_at(nodes: &[Vector3], length: f64, s: f64) -> Vector2<f64> {
    let edges = nodes.len() - 1;
    let along = (s / length * edges as f64).clamp(0.0, edges as f64);
    let edge = (along.floor() as usize).min(edges - 1);
    let part = along - edge as f64;
    (nodes[edge] * (1.0 - part) + nodes[edge + 1] * part).xy()
}

/// Distances at the marks within the laid length `laid` (m) of the rod, m.
pub fn distances(marks: &[PatternMark], nodes: &[Vector3], length: f64, laid: f64) -> Vec<f64> {
    let marks = marks.iter().filter(|mark| mark.s <= laid * (1.0 + 1e-9));
    marks
        .map(|mark| (rod_at(nodes, length, mark.s) - Vector2::from(mark.position)).norm())
        .collect()
}

impl LaidError {
    /// Summary of distances; `None` if there are none.
    pub fn of(distances: &[f64]) -> Option<Self> {
        if distances.is_empty() {
            return None;
        }
        let count = distances.len() as f64;
        let mean = distances.iter().sum::<f64>() / count;
        let square: f64 = distances.iter().map(|d| (d - mean).powi(2)).sum();
        Some(Self {
            mean,
            deviation: (square / count).sqrt(),
            largest: distances.iter().copied().fold(0.0, f64::max),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corresponding_points_lie_at_equal_arc_lengths() {
        let nodes: Vec<Vector3> = (0..=4)
            .map(|node| Vector3::new(0.25 * f64::from(node), 0.0, 0.1))
            .collect();
        let mark = |s: f64, y: f64| PatternMark {
            s,
            position: [s, y],
        };
        let marks = [mark(0.1, 0.01), mark(0.3, 0.03), mark(0.9, 5.0)];
        let error = LaidError::of(&distances(&marks, &nodes, 1.0, 0.5)).unwrap();
        assert!((error.mean - 0.02).abs() < 1e-15);
        assert!((error.deviation - 0.01).abs() < 1e-15);
        assert!((error.largest - 0.03).abs() < 1e-15);
        let none = distances(&marks, &nodes, 1.0, 0.05);
        assert_eq!(LaidError::of(&none), None);
        // A rod with twice the length has half the marks.
        assert!((rod_at(&nodes, 2.0, 1.0) - Vector2::new(0.5, 0.0)).norm() < 1e-15);
        assert_eq!(rod_at(&nodes, 1.0, 7.0), Vector2::new(1.0, 0.0));
    }
}
