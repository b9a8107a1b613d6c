//! A slack rod between two points: a circular arc, which has constant curvature.
//!
//! Nodes that divide an arc with the angle 2ψ and the radius R into n equal parts have the
//! distance 2R sin(ψ/n); the ends have the distance 2R sin ψ. A polyline of n edges with the
//! length L between points at the distance d is such an arc with
//!
//! ```text
//! sin ψ/(n sin(ψ/n)) = d/L,     0 < ψ < π
//! ```
//!
//! The chord from the start to the fraction s of the arc has the length d sin(ψs)/sin ψ and makes
//! the angle ψ(1 − s) with the line between the ends.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::numerics::bisect;

/// Half the angle of an arc, rad, so small that its cosine is 1.
const STRAIGHT: f64 = 1e-9;

/// An arc whose polyline has a given length.
#[derive(Clone, Copy, Debug)]
pub struct Slack {
    start: Vector3,
    along: Vector3,
    towards: Vector3,
    distance: f64,
    /// ψ, rad.
    half_angle: f64,
}

impl Slack {
    /// A polyline of `length` in at least two `edges` between two points at a smaller distance.
    /// The middle of the polyline is displaced from the line of the ends in the direction of the
    /// unit vector `towards`, which is normal to that line.
    pub fn new(start: Vector3, end: Vector3, length: f64, towards: Vector3, edges: usize) -> Self {
        let distance = (end - start).norm();
        let parts = edges as f64;
        let missing = |angle: f64| {
            let ratio = libm::sin(angle) / (parts * libm::sin(angle / parts));
            // Positive if rounding leaves no slack.
            if angle == STRAIGHT {
                1.0
            } else {
                ratio - distance / length
            }
        };
        Self {
            start,
            along: (end - start) / distance,
            towards,
            distance,
            half_angle: bisect(STRAIGHT, std::f64::consts::PI, missing),
        }
    }

    /// The point at a fraction of the length, from 0 to 1.
    pub fn point(&self, share: f64) -> Vector3 {
        let chord = libm::sin(self.half_angle * share) / libm::sin(self.half_angle);
        self.start + self.direction(self.half_angle * (1.0 - share)) * (self.distance * chord)
    }

    /// Unit tangent there.
    pub fn tangent(&self, share: f64) -> Vector3 {
        self.direction(self.half_angle * (1.0 - 2.0 * share))
    }

    /// The unit vector at an angle to the line between the ends.
    fn direction(&self, angle: f64) -> Vector3 {
        let (sine, cosine) = libm::sincos(angle);
        self.along * cosine + self.towards * sine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_its_length_its_ends_and_one_curvature() {
        let start = Vector3::new(0.1, -0.2, 0.3);
        let along = Vector3::new(2.0, 1.0, 2.0) / 3.0;
        let towards = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        for edges in [2, 3, 7, 60, 1000] {
            for slack in [1.0 + 1e-6, 1.01, 1.5, 4.0, 900.0] {
                let end = start + along * 0.6;
                let length = 0.6 * slack;
                let arc = Slack::new(start, end, length, towards, edges);
                let nodes: Vec<Vector3> = (0..=edges)
                    .map(|k| arc.point(k as f64 / edges as f64))
                    .collect();
                assert_eq!(nodes[0], start);
                assert!((nodes[edges] - end).norm() < 1e-12 * length);
                for pair in nodes.windows(2) {
                    let missed = (pair[1] - pair[0]).norm() * edges as f64 / length - 1.0;
                    assert!(missed.abs() < 1e-9, "{edges} {slack}: {missed}");
                }
                assert!((nodes[edges / 2] - start).dot(&towards) > 0.0);
                // With equal turning angles at every node, tangents are half a turning angle ahead
                // of their edges.
                let ahead = arc.tangent(0.0).angle(&(nodes[1] - nodes[0]));
                let behind = arc.tangent(1.0).angle(&(nodes[edges] - nodes[edges - 1]));
                let half = arc.half_angle / edges as f64;
                assert!((ahead - half).abs() < 1e-7 && (behind - half).abs() < 1e-7);
            }
        }
    }
}
