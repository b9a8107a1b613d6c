//! The target curve: a cubic spline through given points, with nodes at equal distances along it.
//!
//! The parameter of the spline is the length of the chords. The slope at each end is that of the
//! cubic polynomial through the four points nearest to it. Second derivatives are continuous, so
//! curvature and moment are, too.

use super::error::DesignError;
use crate::scenario::read_polyline;
use rodlab_engine::mechanics::Vector3;
use std::path::Path;

/// Allowed difference of the lengths of curve and rod, over the length of the rod.
const LENGTHS: f64 = 0.01;
/// Number of points per part of the spline at which arc length is computed.
const SAMPLES: usize = 32;

/// Nodes at equal distances on the curve of a file, for a rod with `edges` edges and length
/// `rod_length` (m). If `by_node`, and the file has one point for each node, the points are the
/// nodes.
///
/// # Errors
/// Faults of the file, or a curve whose length differs from that of the rod.
pub fn wanted_nodes(
    file: &Path,
    edges: usize,
    rod_length: f64,
    by_node: bool,
) -> Result<Vec<Vector3>, DesignError> {
    let curve = read_polyline(file).map_err(DesignError::Input)?;
    let points: Vec<Vector3> = curve.into_iter().map(Vector3::from).collect();
    let nodes = match by_node && points.len() == edges + 1 {
        true => points,
        false => Spline::new(&points).nodes(edges),
    };
    let length = length(&nodes);
    let longer = length / rod_length - 1.0;
    match longer.abs() > LENGTHS {
        true => Err(DesignError::Input(format!(
            "{}: the curve is {length:.6} m long and the rod {rod_length:.6} m ({:+.2} %); allowed: a difference of {:.0} % at most. Change the length of the rod or scale the curve",
            file.display(),
            100.0 * longer,
            100.0 * LENGTHS
        ))),
        false => Ok(nodes),
    }
}

/// Length of a polyline, m.
pub fn length(nodes: &[Vector3]) -> f64 {
    let edges = nodes.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    edges.sum()
}

/// A spline in space.
pub struct Spline {
    points: Vec<Vector3>,
    /// Length of the chords up to each point, m.
    chords: Vec<f64>,
    /// Derivatives over the length of the chords at each point.
    slopes: Vec<Vector3>,
    /// Arc length at each of [`SAMPLES`] points of every part, m.
    lengths: Vec<f64>,
}

impl Spline {
    /// The spline through at least two points. No neighbours may coincide.
    pub fn new(points: &[Vector3]) -> Self {
        let mut chords = vec![0.0];
        for pair in points.windows(2) {
            chords.push(chords[chords.len() - 1] + (pair[1] - pair[0]).norm());
        }
        let mut spline = Self {
            slopes: slopes(points, &chords),
            points: points.to_vec(),
            chords,
            lengths: vec![0.0],
        };
        let mut before = spline.points[0];
        let mut length = 0.0;
        for part in 0..spline.points.len() - 1 {
            for sample in 1..=SAMPLES {
                let [start, end] = [part, part + 1].map(|index| spline.chords[index]);
                let at = start + (end - start) * sample as f64 / SAMPLES as f64;
                let point = spline.at(part, at);
                length += (point - before).norm();
                before = point;
                spline.lengths.push(length);
            }
        }
        spline
    }

    /// Length of the curve, m.
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Nodes at equal arc lengths, both ends included.
    pub fn nodes(&self, edges: usize) -> Vec<Vector3> {
        let last = self.lengths.len() - 1;
        let inner = (1..edges).map(|node| {
            let wanted = self.length() * node as f64 / edges as f64;
            let after = self.lengths.partition_point(|length| *length < wanted);
            let after = after.clamp(1, last);
            let [low, high] = [after - 1, after].map(|index| self.lengths[index]);
            let sample = (after - 1) as f64 + (wanted - low) / (high - low);
            let part = ((after - 1) / SAMPLES).min(self.points.len() - 2);
            let [start, end] = [part, part + 1].map(|index| self.chords[index]);
            let share = sample / SAMPLES as f64 - part as f64;
            self.at(part, start + (end - start) * share)
        });
        let ends = [self.points[0], self.points[self.points.len() - 1]];
        std::iter::once(ends[0])
            .chain(inner)
            .chain([ends[1]])
            .collect()
    }

    /// Point of the spline at a length of the chords within a part.
    fn at(&self, part: usize, chord: f64) -> Vector3 {
        let width = self.chords[part + 1] - self.chords[part];
        let u = (chord - self.chords[part]) / width;
        let v = 1.0 - u;
        self.points[part] * (v * v * (1.0 + 2.0 * u))
            + self.points[part + 1] * (u * u * (1.0 + 2.0 * v))
            + (self.slopes[part] * v - self.slopes[part + 1] * u) * (u * v * width)
    }
}

/// Slopes for which second derivatives are continuous.
fn slopes(points: &[Vector3], chords: &[f64]) -> Vec<Vector3> {
    let count = points.len();
    let near = count.min(4);
    let first = end_slope(&points[..near], &chords[..near], 0);
    let last = end_slope(&points[count - near..], &chords[count - near..], near - 1);
    let mut slopes = vec![first; count];
    slopes[count - 1] = last;
    // Solves the tridiagonal system by elimination from the first point on.
    let mut factors = vec![0.0; count];
    for k in 1..count - 1 {
        let [before, after] = [k, k + 1].map(|end| chords[end] - chords[end - 1]);
        let rise = |end: usize| (points[end] - points[end - 1]) / (chords[end] - chords[end - 1]);
        let right = (rise(k) * after + rise(k + 1) * before) * 3.0;
        let pivot = 2.0 * (before + after) - after * factors[k - 1];
        factors[k] = before / pivot;
        slopes[k] = (right - slopes[k - 1] * after) / pivot;
    }
    for k in (1..count - 1).rev() {
        let next = slopes[k + 1];
        slopes[k] -= next * factors[k];
    }
    slopes
}

/// Derivative of the polynomial through up to four points, at one of them.
fn end_slope(points: &[Vector3], chords: &[f64], at: usize) -> Vector3 {
    let mut slope = Vector3::zeros();
    for (k, point) in points.iter().enumerate() {
        let others = |skipped: usize| {
            (0..points.len()).filter(move |other| *other != k && *other != skipped)
        };
        let mut weight = 0.0;
        for dropped in others(k) {
            let product = others(dropped)
                .map(|other| (chords[at] - chords[other]) / (chords[k] - chords[other]));
            weight += product.product::<f64>() / (chords[k] - chords[dropped]);
        }
        slope += point * weight;
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_through_points_of_a_circle_is_near_it_and_its_nodes_are_equally_spaced() {
        let points: Vec<Vector3> = (0..=20)
            .map(|k| {
                let angle = 0.002 * f64::from(k * k) + 0.1 * f64::from(k);
                Vector3::new(angle.cos(), angle.sin(), 0.0)
            })
            .collect();
        let spline = Spline::new(&points);
        let angle = 0.002 * 400.0 + 2.0;
        assert!(
            (spline.length() / angle - 1.0).abs() < 1e-4,
            "{}",
            spline.length()
        );
        let nodes = spline.nodes(50);
        let chord = 2.0 * (0.5_f64 * angle / 50.0).sin();
        for pair in nodes.windows(2) {
            assert!((pair[0].norm() - 1.0).abs() < 1e-4, "{}", pair[0].norm());
            assert!(((pair[1] - pair[0]).norm() / chord - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn two_points_are_a_line_and_three_a_parabola() {
        let line = Spline::new(&[Vector3::zeros(), Vector3::x()]).nodes(4);
        assert!((line[1] - Vector3::x() * 0.25).norm() < 1e-14);
        let corners = [(0.0, 0.0), (1.0, 0.5), (2.0, 0.0)];
        let bent = Spline::new(&corners.map(|(x, y)| Vector3::new(x, y, 0.0)));
        assert!((bent.nodes(2)[1] - Vector3::new(1.0, 0.5, 0.0)).norm() < 1e-12);
        assert!((bent.slopes[0] - bent.slopes[1] * (1.0 / bent.slopes[1].x)).y > 0.5);
    }
}
