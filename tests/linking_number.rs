//! Linking number for tests of contact, computed by a method that differs from that of the
//! program.

use rodlab::mechanics::Vector3;
use std::f64::consts::PI;

/// Gauss's linking number of two closed polylines, from the solid angle of every pair of edges
/// (Klenin and Langowski 2000).
pub fn linking_number(first: &[Vector3], second: &[Vector3]) -> f64 {
    let mut sum = 0.0;
    for i in 0..first.len() {
        let [a, b] = [first[i], first[(i + 1) % first.len()]];
        for j in 0..second.len() {
            let [c, d] = [second[j], second[(j + 1) % second.len()]];
            let sides = [c - a, d - a, d - b, c - b];
            let normals: [Vector3; 4] =
                std::array::from_fn(|k| sides[k].cross(&sides[(k + 1) % 4]).normalize());
            let angle: f64 = (0..4)
                .map(|k| {
                    normals[k]
                        .dot(&normals[(k + 1) % 4])
                        .clamp(-1.0, 1.0)
                        .asin()
                })
                .sum();
            sum += angle * (b - a).cross(&(d - c)).dot(&sides[0]).signum();
        }
    }
    sum / (4.0 * PI)
}
